// What zones and beds have beside their outline: as the form shows it, as the server is told, and as a list says it.
import type { Bed, Zone } from "../protocol/messages";
import { quantity, tick } from "./format";

/** null: as elsewhere. */
export type ZoneSet = Partial<Pick<Zone, "friction_coefficient" | "turbulent_friction_mps2" | "cohesion_Pa" | "stem_density_pm2" | "stem_diameter_m" | "stem_drag_coefficient">>;
export type BedSet = Partial<Pick<Bed, "depth_m" | "law" | "growth_rate_per_m" | "critical_shear_stress_Pa" | "erosion_rate_mps" | "erosion_depth_mpPa">>;

const hectare_m2 = 10_000;
/** Units change by factors of ten: without rounding, 0.3 would become 0.30000000000000004. */
const tidy = (value: number): number => Number(value.toPrecision(6));

/** A new zone differs by one of these. */
export const usualZone = {
  friction: { friction_coefficient: 0.4 },
  forest: { stem_density_pm2: 0.04, stem_diameter_m: 0.3 },
} as const satisfies Record<string, ZoneSet>;
export const usualBed = { depth_m: 1, law: "growth", growth_rate_per_m: 0.005 } satisfies BedSet;

export const stems = {
  perHectare: (zone: ZoneSet): number | null => (zone.stem_density_pm2 ? tidy(zone.stem_density_pm2 * hectare_m2) : null),
  /** null: no forest. */
  change: (perHectare: number | null): ZoneSet => ({ stem_density_pm2: perHectare === null ? 0 : tidy(perHectare / hectare_m2) }),
};
/** Between Pa of the protocol and kPa of the form; also of m/kPa to m/Pa, the other way round. */
export const kilo = {
  from: (value: number): number => tidy(value / 1000),
  to: (value: number): number => tidy(value * 1000),
};

/** What a change of law needs with it. */
export const lawChange = (bed: BedSet, law: Bed["law"]): BedSet =>
  law === "shear" ? { law } : { law, growth_rate_per_m: bed.growth_rate_per_m ?? usualBed.growth_rate_per_m };

/** In a list: "friction 0.4, forest 400/ha". */
export function zoneNote(zone: ZoneSet): string {
  const said: string[] = [];
  const perHectare = stems.perHectare(zone);
  if (perHectare !== null) said.push(`forest ${tick(perHectare)}/ha`);
  if (typeof zone.friction_coefficient === "number") said.push(`friction ${tick(zone.friction_coefficient)}`);
  if (typeof zone.turbulent_friction_mps2 === "number") said.push(`ξ ${tick(zone.turbulent_friction_mps2)}`);
  if (typeof zone.cohesion_Pa === "number") said.push(`cohesion ${tick(zone.cohesion_Pa / 1000)}\u202fkPa`);
  if (said.length > 2) return `${said[0]}, …`;
  return said.join(", ") || "as elsewhere";
}
export const bedNote = (bed: Pick<Bed, "depth_m" | "volume_m3" | "in_force">): string =>
  bed.in_force ? `${bed.depth_m === null ? "" : `${tick(bed.depth_m)}\u202fm, `}${quantity(bed.volume_m3, "m3")}` : `${quantity(bed.volume_m3, "m3")}, next restart`;
