// A choice of a few: radio buttons in a row.
import { freshId, h } from "./dom";

export function choice<T extends string>(name: string, options: readonly (readonly [T, string])[], first: T, onset: (value: T) => void): HTMLElement {
  const group = freshId("choice");
  return h("div", { class: "row choice", role: "radiogroup", "aria-label": name }, ...options.map(([value, text]) =>
    h("label", { class: "check" }, h("input", { type: "radio", name: group, value, checked: value === first, onchange: () => onset(value) }), text)));
}
