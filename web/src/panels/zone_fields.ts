// Fields of zones only: resistances that differ from elsewhere, each with a check box, and the stems of a forest.
import { fields as described } from "../protocol/schema";
import { usualZone, type ZoneSet } from "../state/ground";
import { limitsOf, type Given } from "../state/rules";
import { choice } from "../ui/choice";
import { h } from "../ui/dom";
import { valueField, type ValueField } from "../ui/value_field";

export interface ZoneFields {
  element: HTMLElement;
  show(zone: ZoneSet): void;
  enable(hindrance: string | null): void;
}

type Key = keyof typeof described.zone;

/** `onset` receives the change for the server; null: as elsewhere. */
export function zoneFields(scene: Given, onset: (change: ZoneSet) => void): ZoneFields {
  const made = new Map<Key, ValueField>();
  const make = (key: Key, more: HTMLElement[] = []): HTMLElement => {
    const field = valueField(described.zone[key], null, (v) => onset({ [key]: v }), key === "stem_density_pm2" ? 0 : null, more);
    field.limit(limitsOf("zone", key, scene, {}));
    made.set(key, field);
    return field.element;
  };
  const stem = [make("stem_diameter_m"), make("stem_drag_coefficient")];
  const element = h("div", { class: "options" }, make("friction_coefficient"), make("turbulent_friction_mps2"), make("laminar_viscosity_m2ps"), make("cohesion_Pa"), make("stem_density_pm2", stem));
  return {
    element,
    show: (zone) => made.forEach((field, key) => field.show(zone[key])),
    enable: (hindrance) => made.forEach((field) => field.enable(hindrance)),
  };
}

/** While a zone is drawn: the one value in which it differs; more can be selected once it exists. */
export function newZoneFields(onset: (zone: ZoneSet) => void): HTMLElement {
  const kinds = { friction: { ...usualZone.friction } as ZoneSet, forest: { ...usualZone.forest } as ZoneSet };
  let chosen: keyof typeof kinds = "friction";
  const field = (kind: keyof typeof kinds, key: Key): { kind: typeof kind; field: ValueField } => ({
    kind,
    field: valueField({ ...described.zone[key], tick: null }, kinds[kind][key] ?? null, (v) => {
      Object.assign(kinds[kind], { [key]: v });
      onset({ ...kinds[chosen] });
    }),
  });
  const all = [field("friction", "friction_coefficient"), field("forest", "stem_density_pm2"), field("forest", "stem_diameter_m")];
  const choose = (kind: keyof typeof kinds): void => {
    chosen = kind;
    for (const f of all) f.field.element.hidden = f.kind !== kind;
    onset({ ...kinds[kind] });
  };
  choose(chosen);
  return h("div", {}, choice("Properties of the zone", [["friction", "Friction"], ["forest", "Forest"]], chosen, choose), ...all.map((f) => f.field.element));
}
