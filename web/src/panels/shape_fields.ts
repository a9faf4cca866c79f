// The fields of an existing shape, by kind, in addition to its outline.
import { fields as described } from "../protocol/schema";
import { area, lineOf, middle, pointsOf, type Item } from "../state/shapes";
import type { Change } from "../state/edits";
import { downhill_deg } from "../state/inflows";
import type { Twin } from "../state/twin";
import { valueField, type ValueField } from "../ui/value_field";
import { CrestProfile } from "../charts/crest";
import { h } from "../ui/dom";
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

const one = (field: ValueField, of: (item: Item) => number | null): ShapeFields =>
  ({ element: field.element, show: (item) => field.show(of(item)), enable: field.enable });

/** `onset` receives the change for the server; `now` returns the current shape. */
export function shapeFields(twin: Twin, item: Item, now: () => Item, onset: (what: Change) => void): ShapeFields {
  switch (item.shape) {
    case "release":
      return one(valueField(described.release.thickness_m, item.thickness_m, (thickness_m) => onset({ thickness_m })), (fresh) => (fresh.shape === "release" ? fresh.thickness_m : null));
    case "building":
      return one(valueField(described.buildings.height_m, item.height_m, (height_m) => onset({ height_m })), (fresh) => (fresh.shape === "building" ? fresh.height_m : null));
    case "barrier": {
      const fields = barrierFields(item, twin.scene, onset);
      const profile = new CrestProfile();
      return { ...fields, element: h("div", {}, fields.element, profile.element), end: () => profile.end(), show: (fresh) => {
        if (fresh.shape !== "barrier") return;
        fields.show(fresh, fresh.crest_length_m);
        profile.show(fresh, fresh.line, twin.relief);
      } };
    }
    case "zone": {
      const fields = zoneFields(twin.scene, onset);
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
