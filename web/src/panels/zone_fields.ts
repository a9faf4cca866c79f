// What only zones have: resistances that differ from elsewhere, each behind a tick, and the stems of a forest.
import { kilo, stems, usualZone, type ZoneSet } from "../state/ground";
import { choice } from "../ui/choice";
import { h } from "../ui/dom";
import { numberField, type NumberField, type NumberFieldOptions } from "../ui/field";
import { optionalField } from "../ui/optional_field";

export interface ZoneFields {
  element: HTMLElement;
  show(zone: ZoneSet): void;
  enable(hindrance: string | null): void;
}

const friction: Omit<NumberFieldOptions, "onset"> = { label: "Coefficient", unit: "", low: 0.001, high: 9.999, sliderLow: 0.05, sliderHigh: 1.05, value: null,
  help: "Coulomb friction on this ground: shear stress over normal stress" };
const density: Omit<NumberFieldOptions, "onset"> = { label: "Stems", unit: "1/ha", low: 0.01, high: 1e6, sliderLow: 50, sliderHigh: 1550, value: null,
  help: "Stems per hectare that stand the flow; each drags on it as a cylinder" };
const diameter: Omit<NumberFieldOptions, "onset"> = { label: "Stem diameter", unit: "m", low: 0.01, high: 100, sliderLow: 0.05, sliderHigh: 1.05, value: null,
  help: "Diameter of a stem" };

/** `onset` gets what the server is to be told; null: as elsewhere. */
export function zoneFields(onset: (change: ZoneSet) => void): ZoneFields {
  const coulomb = optionalField("Friction", "Coulomb friction of its own; unticked: as elsewhere", usualZone.friction.friction_coefficient, friction,
    (v) => onset({ friction_coefficient: v }));
  const turbulent = optionalField("Turbulent friction", "Voellmy's turbulent friction of its own; unticked: as elsewhere", 500,
    { label: "Voellmy's ξ", unit: "m/s2", low: 0.001, high: 1e6, sliderLow: 100, sliderHigh: 2100, value: null, help: "Lower is rougher" },
    (v) => onset({ turbulent_friction_mps2: v }));
  const cohesion = optionalField("Cohesion", "Cohesion of its own; unticked: as elsewhere", 1,
    { label: "Shear strength", unit: "kPa", low: 0, high: 1e6, sliderLow: 0, sliderHigh: 10, value: null, help: "Without pressure between debris and this ground" },
    (v) => onset({ cohesion_Pa: v === null ? null : kilo.to(v) }));
  const wide = numberField({ ...diameter, onset: (v) => onset({ stem_diameter_m: v }) });
  const drag = numberField({ label: "Drag coefficient", unit: "", low: 0, high: 1000, sliderLow: 0, sliderHigh: 3, value: null, help: "Of a stem across the flow",
    onset: (v) => onset({ stem_drag_coefficient: v }) });
  const forest = optionalField("Forest", "Stems that drag on the flow", stems.perHectare(usualZone.forest) ?? 0, density, (v) => onset(stems.change(v)),
    [wide.element, drag.element]);
  const all = [coulomb, turbulent, cohesion, forest];
  return {
    element: h("div", { class: "options" }, ...all.map((field) => field.element)),
    show(zone) {
      coulomb.show(zone.friction_coefficient ?? null);
      turbulent.show(zone.turbulent_friction_mps2 ?? null);
      cohesion.show(typeof zone.cohesion_Pa === "number" ? kilo.from(zone.cohesion_Pa) : null);
      forest.show(stems.perHectare(zone));
      wide.show(zone.stem_diameter_m ?? null);
      drag.show(zone.stem_drag_coefficient ?? null);
    },
    enable(hindrance) {
      for (const field of [...all, wide, drag]) field.enable(hindrance);
    },
  };
}

/** While a zone is drawn: the one thing in which it differs; more can be ticked once it is there. */
export function newZoneFields(onset: (zone: ZoneSet) => void): HTMLElement {
  const kinds = { friction: { ...usualZone.friction } as ZoneSet, forest: { ...usualZone.forest } as ZoneSet };
  let chosen: keyof typeof kinds = "friction";
  const field = (kind: keyof typeof kinds, options: Omit<NumberFieldOptions, "onset">, value: number | null, change: (v: number) => ZoneSet): { kind: typeof kind; field: NumberField } => ({
    kind,
    field: numberField({ ...options, value, onset: (v) => {
      Object.assign(kinds[kind], change(v));
      onset({ ...kinds[chosen] });
    } }),
  });
  const fields = [
    field("friction", friction, usualZone.friction.friction_coefficient, (v) => ({ friction_coefficient: v })),
    field("forest", density, stems.perHectare(usualZone.forest), (v) => stems.change(v)),
    field("forest", diameter, usualZone.forest.stem_diameter_m, (v) => ({ stem_diameter_m: v })),
  ];
  const choose = (kind: keyof typeof kinds): void => {
    chosen = kind;
    for (const f of fields) f.field.element.hidden = f.kind !== kind;
    onset({ ...kinds[kind] });
  };
  choose(chosen);
  return h("div", {}, choice("What is different in the zone", [["friction", "Friction"], ["forest", "Forest"]], chosen, choose), ...fields.map((f) => f.field.element));
}
