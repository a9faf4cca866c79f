// Fields of beds only: their depth, and the law of erosion.
import type { Bed } from "../protocol/messages";
import { fields as described } from "../protocol/schema";
import { lawChange, type BedSet } from "../state/ground";
import { freshId, h } from "../ui/dom";
import { valueField } from "../ui/value_field";

export interface BedFields {
  element: HTMLElement;
  show(bed: Bed): void;
  enable(hindrance: string | null): void;
}

const laws: [Bed["law"], string][] = [["growth", "Growth per metre of travel"], ["shear", "Shear above a critical stress"]];

/** `onset` receives the change for the server. */
export function bedFields(bed: Bed, onset: (change: BedSet) => void): BedFields {
  let now: BedSet = bed;
  const id = freshId("law");
  const law = h("select", { id, onchange: () => onset(lawChange(now, law.value === "shear" ? "shear" : "growth")) },
    ...laws.map(([value, text]) => h("option", { value }, text)));
  const depth = valueField(described.bed.depth_m, bed.depth_m, (depth_m) => onset({ depth_m }));
  const varies = h("p", { class: "hint" });
  const byLaw = { growth: ["growth_rate_per_m"], shear: ["critical_shear_stress_Pa", "erosion_rate_mps", "erosion_depth_mpPa"] } as const;
  const values = laws.flatMap(([of]) => byLaw[of].map((key) => ({ key, of, field: valueField(described.bed[key], null, (v) => onset({ [key]: v })) })));
  return {
    element: h("div", {}, depth.element, varies, h("div", { class: "field law" }, h("label", { for: id, title: "How debris picks it up" }, "Law"), law),
      ...values.map(({ field }) => field.element)),
    show(fresh) {
      now = fresh;
      depth.show(fresh.depth_m);
      // Depths of a raster are kept; those of polygons can be replaced by a single one.
      const fromRaster = fresh.depth_m === null && fresh.polygons.length === 0;
      depth.element.hidden = fromRaster;
      varies.textContent = `Its depth differs from place to place${fromRaster ? "" : "; one value makes it the same everywhere"}.`;
      varies.hidden = fresh.depth_m !== null;
      law.value = fresh.law;
      for (const { key, of, field } of values) {
        field.show(fresh[key]);
        field.element.hidden = fresh.law !== of;
      }
    },
    enable(hindrance) {
      law.disabled = hindrance !== null;
      for (const field of [depth, ...values.map((v) => v.field)]) field.enable(hindrance);
    },
  };
}
