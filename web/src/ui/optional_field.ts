// A number with a check box: unticked, there is no value.
import type { Limits } from "../state/rules";
import { freshId, h } from "./dom";
import { numberField, type NumberField, type NumberFieldOptions } from "./field";

export interface OptionalField {
  element: HTMLElement;
  show(value: number | null): void;
  enable(hindrance: string | null): void;
  limit(limits: Limits): void;
}

/** usual: the initial value when ticked. Further fields that belong to the number are shown and hidden with it. */
export function optionalField(label: string, title: string, usual: number, field: Omit<NumberFieldOptions, "onset">, onset: (value: number | null) => void,
  more: readonly HTMLElement[] = []): OptionalField {
  const id = freshId("has");
  const reveal = (on: boolean): void => {
    for (const element of [number.element, ...more]) element.hidden = !on;
  };
  const box = h("input", { type: "checkbox", id, onchange: () => {
    const first = number.allowed(usual);
    reveal(box.checked);
    if (box.checked) number.show(first);
    onset(box.checked ? first : null);
  } });
  const number: NumberField = numberField({ ...field, onset: (v) => onset(v) });
  const name = h("label", { class: "check", for: id, title }, box, label);
  const why = h("p", { class: "hint" });
  why.hidden = true;
  let refused: string | null = null;
  let hindered: string | null = null;
  const whole: OptionalField = {
    element: h("div", { class: "optional" }, name, why, number.element, ...more),
    show(value) {
      box.checked = value !== null;
      reveal(value !== null);
      if (value !== null) number.show(value);
    },
    enable(hindrance) {
      hindered = hindrance;
      box.disabled = hindrance !== null || refused !== null;
      name.title = refused ?? title;
      number.enable(hindrance);
    },
    limit(limits) {
      refused = limits.hindrance;
      // Next to the check box, the only visible part of a value that cannot be given.
      why.textContent = refused ?? "";
      why.hidden = refused === null;
      number.limit(limits);
      whole.enable(hindered);
    },
  };
  return whole;
}
