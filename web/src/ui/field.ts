// A number with its unit: a slider and a number field that hold the same value.
import { unitText } from "../state/format";
import type { Limits } from "../state/rules";
import { freshId, h } from "./dom";
import { isTyped, put } from "./typed";

export interface NumberField {
  element: HTMLElement;
  input: HTMLInputElement;
  /** Shows a value from elsewhere, also in a field with the focus; beside text that is typed and not sent yet it is told. */
  show(value: number | null): void;
  enable(hindrance: string | null): void;
  /** Narrows the allowed range; a hindrance disables the field. */
  limit(limits: Limits): void;
  /** The nearest value that is allowed. */
  allowed(value: number): number;
  complain(sentence: string | null): void;
}

export interface NumberFieldOptions {
  label: string;
  unit: string;
  low: number;
  high: number;
  /** Ends of the slider, if the range is too wide for one. */
  sliderLow?: number;
  sliderHigh?: number;
  /** Value that is marked on the slider. */
  usual?: number | null;
  help?: string;
  value: number | null;
  slider?: boolean;
  onset(value: number): void;
}

export function numberField(options: NumberFieldOptions): NumberField {
  const id = freshId("field");
  const low = options.sliderLow ?? options.low;
  const high = options.sliderHigh ?? options.high;
  const step = 10 ** Math.floor(Math.log10((high - low) / 100));
  const digits = Math.max(0, -Math.floor(Math.log10(step)));
  const input = h("input", { type: "number", id, step: "any", "aria-describedby": `${id}-note` });
  const slider = options.slider === false ? null
    : h("input", { type: "range", min: low, max: high, step, "aria-label": `${options.label}, slider`, tabindex: "0" });
  const note = h("div", { class: "field-note", id: `${id}-note`, role: "alert" });
  const hint = h("p", { class: "hint" });
  hint.hidden = true;
  let shown: number | null = null;
  /** The value has changed elsewhere since the text was typed. */
  let overtaken = false;
  let entering = false;
  let limits: Limits = { low: options.low, high: options.high, hindrance: null, hint: null };
  let hindered: string | null = null;

  const text = (value: number): string => String(Number(value.toPrecision(6)));
  const complain = (sentence: string | null): void => {
    note.textContent = sentence ?? "";
    input.setAttribute("aria-invalid", String(sentence !== null));
  };
  const set = (value: number): void => {
    if (!Number.isFinite(value) || value < limits.low || value > limits.high) {
      complain(`${options.label} is ${Number.isFinite(value) ? text(value) : "no number"}; allowed is ${limits.high === Infinity ? `at least ${text(limits.low)}` : `${text(limits.low)} to ${text(limits.high)}`} ${unitText(options.unit)}`.trim());
      return;
    }
    complain(null);
    if (value === shown) return;
    shown = value;
    options.onset(value);
  };
  const back = (): void => {
    put(input, shown === null ? "" : text(shown));
    overtaken = false;
  };
  input.addEventListener("change", () => {
    // Text typed beside a value that has changed meanwhile is sent by Enter alone, not by leaving the field.
    if (overtaken && !entering) {
      const typed = input.value;
      back();
      complain(`${typed} was not sent: ${options.label} had changed meanwhile`);
      return;
    }
    overtaken = entering = false;
    set(input.valueAsNumber);
    if (slider && shown !== null) slider.value = String(shown);
  });
  input.addEventListener("keydown", (event) => {
    entering = event.key === "Enter";
    if (event.key === "Escape") {
      back();
      complain(null);
    }
    if (event.key === "ArrowUp" || event.key === "ArrowDown") {
      event.preventDefault();
      const next = (input.valueAsNumber || 0) + (event.key === "ArrowUp" ? step : -step);
      input.value = next.toFixed(digits);
      input.dispatchEvent(new Event("change"));
    }
  });
  slider?.addEventListener("input", () => (input.value = Number(slider.value).toFixed(digits)));
  slider?.addEventListener("change", () => set(Number(slider.value)));

  const element = h("div", { class: "field" },
    h("label", { for: id, title: options.help ?? null }, options.label.slice(0, 1).toUpperCase() + options.label.slice(1)),
    h("div", { class: "field-value" }, input, h("span", { class: "unit" }, unitText(options.unit))),
    slider ? h("div", { class: "field-slider" }, slider) : null,
    note, hint);
  if (slider && options.usual !== undefined && options.usual !== null && options.usual >= low && options.usual <= high) {
    const mark = h("i", { class: "usual", title: `Default ${text(options.usual)} ${unitText(options.unit)}` });
    mark.style.left = `calc(7px + (100% - 14px) * ${(options.usual - low) / (high - low)})`;
    slider.parentElement?.append(mark);
  }
  const field: NumberField = {
    element,
    input,
    show(value) {
      if (shown !== null && slider?.matches(":active")) return;
      const changed = value !== shown;
      shown = value;
      if (slider && value !== null) slider.value = String(value);
      if (isTyped(input)) {
        if (!changed) return;
        overtaken = true;
        complain(`Now ${value === null ? "none" : `${text(value)} ${unitText(options.unit)}`.trim()}; Enter sets ${input.value}`);
        return;
      }
      back();
      if (changed) complain(null);
    },
    enable(hindrance) {
      hindered = hindrance;
      const why = hindrance ?? limits.hindrance;
      input.disabled = why !== null;
      if (slider) slider.disabled = why !== null;
      element.title = why ?? "";
    },
    limit(fresh) {
      limits = fresh;
      hint.textContent = fresh.hint ?? "";
      hint.hidden = fresh.hint === null;
      field.enable(hindered);
    },
    allowed: (value) => Math.min(limits.high, Math.max(limits.low, value)),
    complain,
  };
  field.show(options.value);
  return field;
}
