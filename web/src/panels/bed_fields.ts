// What only beds have: how deep they are, and the law by which debris picks them up.
import type { Bed } from "../protocol/messages";
import { kilo, lawChange, usualBed, type BedSet } from "../state/ground";
import { freshId, h } from "../ui/dom";
import { numberField, type NumberField } from "../ui/field";

export interface BedFields {
  element: HTMLElement;
  show(bed: Bed): void;
  enable(hindrance: string | null): void;
}

const laws: [Bed["law"], string][] = [["growth", "Growth per metre of travel"], ["shear", "Shear above a critical stress"]];

export function depthField(value: number | null, onset: (depth_m: number) => void): NumberField {
  return numberField({ label: "Depth", unit: "m", low: 0.001, high: 100, sliderLow: 0.1, sliderHigh: 5.1, value, help: "Of the loose material, vertical: debris picks up no more", onset });
}
export function growthField(value: number | null, onset: (growth_rate_per_m: number) => void): NumberField {
  return numberField({ label: "Growth rate", unit: "1/m", low: 1e-9, high: 1, sliderLow: 0.0005, sliderHigh: 0.0505, value,
    help: "Share of its volume that debris picks up per metre that it moves: ln(volume after / volume before) over the length of the bed", onset });
}

/** `onset` gets what the server is to be told. */
export function bedFields(bed: Bed, onset: (change: BedSet) => void): BedFields {
  let now: BedSet = bed;
  const id = freshId("law");
  const law = h("select", { id, onchange: () => onset(lawChange(now, law.value === "shear" ? "shear" : "growth")) },
    ...laws.map(([value, text]) => h("option", { value }, text)));
  const depth = depthField(bed.depth_m, (v) => onset({ depth_m: v }));
  const varies = h("p", { class: "hint" });
  const growth = growthField(usualBed.growth_rate_per_m, (v) => onset({ growth_rate_per_m: v }));
  const shear = [
    { field: numberField({ label: "Critical shear stress", unit: "kPa", low: 0, high: 1e6, sliderLow: 0, sliderHigh: 5, value: null,
      help: "Less shear stress (rest density × gravity × depth × sine of the slope) picks up nothing", onset: (v) => onset({ critical_shear_stress_Pa: kilo.to(v) }) }),
      of: (b: Bed) => kilo.from(b.critical_shear_stress_Pa) },
    { field: numberField({ label: "Erosion rate", unit: "m/s", low: 1e-9, high: 10, sliderLow: 0.001, sliderHigh: 0.101, value: null,
      help: "How fast the bed is lowered", onset: (v) => onset({ erosion_rate_mps: v }) }), of: (b: Bed) => b.erosion_rate_mps },
    { field: numberField({ label: "Erosion depth", unit: "m/kPa", low: 1e-9, high: 1000, sliderLow: 0.01, sliderHigh: 1.01, value: null,
      help: "How deep at most, per shear stress above the critical one", onset: (v) => onset({ erosion_depth_mpPa: kilo.from(v) }) }), of: (b: Bed) => kilo.to(b.erosion_depth_mpPa) },
  ];
  return {
    element: h("div", {}, depth.element, varies, h("div", { class: "field law" }, h("label", { for: id, title: "How debris picks it up" }, "Law"), law), growth.element,
      ...shear.map((s) => s.field.element)),
    show(fresh) {
      now = fresh;
      depth.show(fresh.depth_m);
      // Depths of a raster stay; those of polygons can be given up for one.
      const fromRaster = fresh.depth_m === null && fresh.polygons.length === 0;
      depth.element.hidden = fromRaster;
      varies.textContent = `Its depth differs from place to place${fromRaster ? "" : "; one value makes it the same everywhere"}.`;
      varies.hidden = fresh.depth_m !== null;
      law.value = fresh.law;
      growth.show(fresh.growth_rate_per_m);
      growth.element.hidden = fresh.law !== "growth";
      for (const { field, of } of shear) {
        field.show(of(fresh));
        field.element.hidden = fresh.law !== "shear";
      }
    },
    enable(hindrance) {
      law.disabled = hindrance !== null;
      for (const field of [depth, growth, ...shear.map((s) => s.field)]) field.enable(hindrance);
    },
  };
}
