// A tick before a number: without it there is none.
import { freshId, h } from "./dom";
import { numberField, type NumberField, type NumberFieldOptions } from "./field";

export interface OptionalField {
  element: HTMLElement;
  show(value: number | null): void;
  enable(hindrance: string | null): void;
}

/** usual: what the tick begins with. More fields that go with the number come and go with it. */
export function optionalField(label: string, title: string, usual: number, field: Omit<NumberFieldOptions, "onset">, onset: (value: number | null) => void,
  more: readonly HTMLElement[] = []): OptionalField {
  const id = freshId("has");
  const reveal = (on: boolean): void => {
    for (const element of [number.element, ...more]) element.hidden = !on;
  };
  const box = h("input", { type: "checkbox", id, onchange: () => {
    reveal(box.checked);
    if (box.checked) number.show(usual);
    onset(box.checked ? usual : null);
  } });
  const number: NumberField = numberField({ ...field, onset: (v) => onset(v) });
  return {
    element: h("div", { class: "optional" }, h("label", { class: "check", for: id, title }, box, label), number.element, ...more),
    show(value) {
      box.checked = value !== null;
      reveal(value !== null);
      if (value !== null) number.show(value);
    },
    enable(hindrance) {
      box.disabled = hindrance !== null;
      number.enable(hindrance);
    },
  };
}
