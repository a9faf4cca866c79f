// Values of zones and beds other than their outline: in the form, for the server, and in a list.
import type { Bed } from "../protocol/messages";
import { fields, type BedValues, type ZoneValues } from "../protocol/schema";
import { quantity, shownAs, tick, toldAs } from "./format";

/** null: as elsewhere. */
export type ZoneSet = Partial<ZoneValues>;
export type BedSet = Partial<BedValues>;

const { friction_coefficient, stem_density_pm2, stem_diameter_m, cohesion_Pa } = fields.zone;
/** A new zone differs by one of these. */
export const usualZone = {
  friction: { friction_coefficient: friction_coefficient.first },
  forest: { stem_density_pm2: toldAs(stem_density_pm2, stem_density_pm2.first), stem_diameter_m: stem_diameter_m.first },
} as const satisfies Record<string, ZoneSet>;
export const usualBed = { depth_m: fields.bed.depth_m.first as number, law: "growth" as Bed["law"], growth_rate_per_m: fields.bed.growth_rate_per_m.first as number };

/** Values required by a change of law. */
export const lawChange = (bed: BedSet, law: Bed["law"]): BedSet =>
  law === "shear" ? { law } : { law, growth_rate_per_m: bed.growth_rate_per_m ?? usualBed.growth_rate_per_m };

/** In a list: "friction 0.4, forest 400/ha". */
export function zoneNote(zone: ZoneSet): string {
  const said: string[] = [];
  const perHectare = shownAs(stem_density_pm2, zone.stem_density_pm2 ?? 0);
  if (perHectare > 0) said.push(`forest ${tick(perHectare)}/ha`);
  if (typeof zone.friction_coefficient === "number") said.push(`friction ${tick(zone.friction_coefficient)}`);
  if (typeof zone.laminar_viscosity_m2ps === "number") said.push(`ν ${tick(zone.laminar_viscosity_m2ps)}`);
  if (typeof zone.turbulent_friction_mps2 === "number") said.push(`ξ ${tick(zone.turbulent_friction_mps2)}`);
  if (typeof zone.cohesion_Pa === "number") said.push(`cohesion ${tick(shownAs(cohesion_Pa, zone.cohesion_Pa))}\u202fkPa`);
  if (said.length > 2) return `${said[0]}, …`;
  return said.join(", ") || "as elsewhere";
}
export const bedNote = (bed: Pick<Bed, "depth_m" | "volume_m3" | "in_force">): string =>
  bed.in_force ? `${bed.depth_m === null ? "" : `${tick(bed.depth_m)}\u202fm, `}${quantity(bed.volume_m3, "m3")}` : `${quantity(bed.volume_m3, "m3")}, next restart`;
