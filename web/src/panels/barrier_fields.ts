// What only barriers have: meshes that make a net of one, the load that it bears, openings.
import type { BarrierOpening } from "../protocol/messages";
import { barrierChange, openingsWith, type BarrierSet } from "../state/barriers";
import { button, h } from "../ui/dom";
import { optionalField } from "../ui/optional_field";

export interface BarrierFields {
  element: HTMLElement;
  show(value: BarrierSet, length_m: number): void;
  enable(hindrance: string | null): void;
}

/** `onset` gets what the server is to be told; null takes a value away. */
export function barrierFields(value: BarrierSet, narrowest_m: number, onset: (change: Partial<BarrierSet>) => void): BarrierFields {
  let openings: readonly BarrierOpening[] = value.openings ?? [];
  let length = 0;
  let hindered: string | null = null;
  const net = optionalField("Net", "Lets the finer share of the debris through its meshes and holds the rest", 50,
    { label: "Passes the meshes", unit: "%", low: 0, high: 99.9, sliderLow: 0, sliderHigh: 95, value: null, help: "Share of the debris, by volume, in grains smaller than the meshes" },
    (v) => onset(barrierChange.passing(v)));
  const load = optionalField("Fails under load", "Beyond this mean force on its line it is gone", 200,
    { label: "Resistance", unit: "kN/m", low: 0.001, high: 1e6, sliderLow: 10, sliderHigh: 1000, value: null, help: "Filtered force per metre of the line" },
    (v) => onset(barrierChange.resistance(v)));
  const list = h("div", { class: "corners" });
  const add = button("Add an opening", { class: "small", onclick: () => {
    openings = [...openings, { position_m: Number((length / 2).toFixed(2)), width_m: Math.max(2, narrowest_m), sill_height_m: 0 }];
    onset({ openings: [...openings] });
  } });
  const refill = (): void => {
    if (list.contains(document.activeElement) && document.activeElement instanceof HTMLInputElement) return;
    list.replaceChildren(...openings.map((opening, k) => {
      const input = (key: keyof BarrierOpening, name: string): HTMLInputElement => {
        const field = h("input", { type: "number", step: "0.1", min: "0", value: String(opening[key]), disabled: hindered !== null, title: `${name}, m`,
          "aria-label": `Opening ${k + 1}: ${name}, m`, onchange: () => onset({ openings: openingsWith(openings, k, key, field.valueAsNumber) }) });
        return field;
      };
      return h("div", { class: "row coordinates" }, h("span", { class: "muted" }, String(k + 1)),
        input("position_m", "middle along the line"), input("width_m", "width"), input("sill_height_m", "sill height"),
        button("", { icon: "remove", class: "small", title: `Close opening ${k + 1}`, disabled: hindered !== null,
          onclick: () => onset({ openings: openings.filter((_, i) => i !== k) }) }));
    }));
  };
  const fields: BarrierFields = {
    element: h("div", {}, net.element, load.element,
      h("details", {}, h("summary", {}, "Openings"), h("p", { class: "hint" }, "Middle along the line, width, height of the sill, in metres."), list, add)),
    show(fresh, length_m) {
      net.show(fresh.passing_share === null || fresh.passing_share === undefined ? null : 100 * fresh.passing_share);
      load.show(fresh.resistance_Npm === null || fresh.resistance_Npm === undefined ? null : fresh.resistance_Npm / 1000);
      openings = fresh.openings ?? [];
      length = length_m;
      refill();
    },
    enable(hindrance) {
      hindered = hindrance;
      net.enable(hindrance);
      load.enable(hindrance);
      add.disabled = hindrance !== null;
      refill();
    },
  };
  fields.show(value, 0);
  return fields;
}
