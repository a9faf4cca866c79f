// Barriers: every key of the field table that has a form, and openings.
import { isTyped } from "../ui/typed";
import type { BarrierOpening } from "../protocol/messages";
import { fields as described } from "../protocol/schema";
import { openingsWith, type BarrierSet } from "../state/barriers";
import { leastOf, limitsOf, type Given } from "../state/rules";
import { button, h } from "../ui/dom";
import { valueField } from "../ui/value_field";

export interface BarrierFields {
  element: HTMLElement;
  show(value: BarrierSet, length_m: number): void;
  enable(hindrance: string | null): void;
}

/** `onset` receives the change for the server; null removes a value. */
export function barrierFields(value: BarrierSet, scene: Given, onset: (change: Partial<BarrierSet>) => void): BarrierFields {
  let openings: readonly BarrierOpening[] = value.openings ?? [];
  let length = 0;
  let hindered: string | null = null;
  const keys = Object.keys(described.barrier) as (keyof typeof described.barrier)[];
  const values = keys.map((key) => ({ key, field: valueField(described.barrier[key], null, (v) => onset({ [key]: v })) }));
  const narrowest_m = leastOf("barrier_opening", "width_m", scene);
  const list = h("div", { class: "corners" });
  const add = button("Add an opening", { class: "small", onclick: () => {
    openings = [...openings, { position_m: Number((length / 2).toFixed(2)), width_m: Math.max(2, narrowest_m), sill_height_m: 0 }];
    onset({ openings: [...openings] });
  } });
  const refill = (): void => {
    const inputs = (): HTMLInputElement[] => [...list.querySelectorAll("input")];
    if (inputs().some(isTyped)) return;
    const focused = inputs().findIndex((input) => input === document.activeElement);
    if (focused >= 0) queueMicrotask(() => inputs()[focused]?.focus());
    list.replaceChildren(...openings.map((opening, k) => {
      const input = (key: keyof BarrierOpening, name: string): HTMLInputElement => {
        const field = h("input", { type: "number", step: "0.1", min: key === "width_m" ? narrowest_m : 0, value: String(opening[key]), disabled: hindered !== null, title: `${name}, m`,
          "aria-label": `Opening ${k + 1}: ${name}, m`, onchange: () => onset({ openings: openingsWith(openings, k, key, Math.max(field.valueAsNumber, Number(field.min))) }) });
        return field;
      };
      return h("div", { class: "row coordinates" }, h("span", { class: "muted" }, String(k + 1)),
        input("position_m", "middle along the line"), input("width_m", "width"), input("sill_height_m", "sill height"),
        button("", { icon: "remove", class: "small", title: `Close opening ${k + 1}`, disabled: hindered !== null,
          onclick: () => onset({ openings: openings.filter((_, i) => i !== k) }) }));
    }));
  };
  const fields: BarrierFields = {
    element: h("div", {}, ...values.map(({ field }) => field.element),
      h("details", {}, h("summary", {}, "Openings"), h("p", { class: "hint" }, `Position of the middle along the line, width (at least ${narrowest_m} m), sill height, in metres.`), list, add)),
    show(fresh, length_m) {
      for (const { key, field } of values) {
        field.limit(limitsOf("barrier", key, scene, fresh));
        field.show(fresh[key]);
      }
      openings = fresh.openings ?? [];
      length = length_m;
      refill();
    },
    enable(hindrance) {
      hindered = hindrance;
      for (const { field } of values) field.enable(hindrance);
      add.disabled = hindrance !== null;
      refill();
    },
  };
  fields.show(value, 0);
  return fields;
}
