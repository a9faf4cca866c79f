// The unit of a terrain's heights: what its user says, else what the file suggests.
import { fixed, number } from "./format";

const foot_m = 0.3048;
const surveyFoot_m = 1200 / 3937;

/** The two feet differ by two parts in a million. */
const same = (a: number, b: number): boolean => Math.abs(a - b) < 1e-7;

/** Metres per unit that a conversion would take, null: they are metres. `stated`: of the file; null: its user has chosen. */
export function heightUnit(chosen: number | null, stated: number | null): number | null {
  if (chosen !== null || stated === null || same(stated, 1)) return chosen;
  return [foot_m, surveyFoot_m].find((known) => same(known, stated)) ?? stated;
}
/** What can be chosen, with its name. */
export function heightUnits(proposed: number | null): [number | null, string][] {
  const known: [number | null, string][] = [[null, "metres"], [foot_m, "feet"], [surveyFoot_m, "US survey feet"]];
  return proposed === null || known.some(([value]) => value === proposed) ? known : [...known, [proposed, `units of ${number(proposed, 6)} m`]];
}
/** "heights 12.0 to 340.5 m": a person sees in it whether feet were taken for metres. */
export const heightsText = (range: readonly [number, number] | null | undefined): string => (range ? `heights ${fixed(range[0], 1)} to ${fixed(range[1], 1)} m` : "");
