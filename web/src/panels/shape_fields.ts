// The fields of a shape that is there: what each kind has beside its outline.
import { area, lineOf, middle, pointsOf, type Item } from "../state/shapes";
import type { Change } from "../state/edits";
import { downhill_deg } from "../state/inflows";
import type { Twin } from "../state/twin";
import { h } from "../ui/dom";
import { numberField, type NumberField } from "../ui/field";
import { barrierFields } from "./barrier_fields";
import { bedFields } from "./bed_fields";
import { inflowFields } from "./inflow_fields";
import { zoneFields } from "./zone_fields";

export interface ShapeFields {
  element: HTMLElement;
  show(item: Item): void;
  enable(hindrance: string | null): void;
  end?(): void;
}

export function heightField(shape: "barrier" | "building", value: number | null, onset: (height_m: number) => void): NumberField {
  return numberField({ label: "Height", unit: "m", low: 0.01, high: 1000, sliderLow: 0.5, sliderHigh: shape === "barrier" ? 15 : 40, value, help: "Above the ground", onset });
}
export function thicknessField(shape: "release" | "barrier", value: number | null, onset: (thickness_m: number) => void): NumberField {
  return numberField({ label: "Thickness", unit: "m", low: 0.01, high: 1000, sliderLow: 0.1, sliderHigh: shape === "barrier" ? 5 : 10, value,
    help: shape === "release" ? "Normal to the slope" : "Across the line", onset });
}

/** Several in a column; each shows its part of the item. */
function column(parts: readonly ShapeFields[]): ShapeFields {
  return {
    element: h("div", {}, ...parts.map((part) => part.element)),
    show: (item) => parts.forEach((part) => part.show(item)),
    enable: (hindrance) => parts.forEach((part) => part.enable(hindrance)),
  };
}
const one = (field: NumberField, of: (item: Item) => number | null): ShapeFields =>
  ({ element: field.element, show: (item) => field.show(of(item)), enable: (hindrance) => field.enable(hindrance) });
const height = (item: Item): number | null => ("height_m" in item ? item.height_m : null);
const thickness = (item: Item): number | null => ("thickness_m" in item ? item.thickness_m : null);

/** `onset` gets what the server is to be told; `now` answers the shape as it is. */
export function shapeFields(twin: Twin, item: Item, now: () => Item, onset: (what: Change) => void): ShapeFields {
  switch (item.shape) {
    case "release":
      return one(thicknessField("release", item.thickness_m, (thickness_m) => onset({ thickness_m })), thickness);
    case "building":
      return one(heightField("building", item.height_m, (height_m) => onset({ height_m })), height);
    case "barrier": {
      const more = barrierFields(item, 2 * twin.scene.particle_spacing_m, onset);
      return column([
        one(heightField("barrier", item.height_m, (height_m) => onset({ height_m })), height),
        one(thicknessField("barrier", item.thickness_m, (thickness_m) => onset({ thickness_m })), thickness),
        { ...more, show: (fresh) => fresh.shape === "barrier" && more.show(fresh, fresh.crest_length_m) },
      ]);
    }
    case "zone": {
      const fields = zoneFields(onset);
      return { ...fields, show: (fresh) => fresh.shape === "zone" && fields.show(fresh) };
    }
    case "bed": {
      const fields = bedFields(item, onset);
      return { ...fields, show: (fresh) => fresh.shape === "bed" && fields.show(fresh) };
    }
    case "inflow": {
      const points = pointsOf(item);
      const down = lineOf(item) || area(points) === 0 ? 0 : downhill_deg(twin.relief, middle(points));
      const density = twin.now.setup.value?.parameters["material.rest_density_kgpm3"] ?? 2000;
      const fields = inflowFields(item, down, density, ({ turn, ...what }) => onset(turn ? { points: pointsOf(now()).reverse() } : what));
      return { ...fields, show: (fresh) => fresh.shape === "inflow" && fields.show(fresh) };
    }
  }
}
