// What two scenarios have come to, side by side: figures, houses, barriers, gauges, points.
import type { Figure, GaugeReading, Impact, BarrierImpact, Impacts, ObservedRow, Parameter, Setup } from "../protocol/messages";
import { changedKeys } from "./differences";
import { decimals, fixed } from "./format";
import { pairedRows } from "./observed";

export interface Row { group: string; name: string; unit: string; a: number | string | null; b: number | string | null }
export interface Side { setup: Setup | null; figures: readonly Figure[]; impacts: Impacts | null; gauges: readonly GaugeReading[]; observed?: readonly ObservedRow[]; points: readonly PointPeaks[] }
/** Peaks at a probe. */
export interface PointPeaks { name: string; depth_m: number | null; speed_mps: number | null; pressure_kPa: number | null }

/** As the table shows it. */
const rounded = (value: number): number => Number(value.toFixed(decimals(value)));
/** b − a of the values as they are shown, so that the row adds up, with no more decimals than the one that has the fewest; a zero has none to count. */
export function differenceText({ a, b }: Row): string {
  if (typeof a !== "number" || typeof b !== "number") return "–";
  const counted = [a, b].filter((v) => v !== 0).map((v) => decimals(v));
  const by = rounded(b) - rounded(a);
  const text = fixed(by, counted.length > 0 ? Math.min(...counted) : 0).replace(/(\.\d*?)0+$/, "$1").replace(/\.$/, "");
  return /[1-9]/.test(text) ? `${by > 0 ? "+" : ""}${text}` : "0";
}

type Measure<T> = readonly [string, string, (of: T) => number | null];
const atHouses: readonly Measure<Impact>[] = [["impact pressure", "kPa", (i) => i.peak_impact_pressure_kPa], ["force", "kN", (i) => i.peak_force_kN],
  ["depth", "m", (i) => i.peak_depth_m], ["hit at", "s", (i) => i.first_hit_s]];
const atBarriers: readonly Measure<BarrierImpact>[] = [["force", "kN", (i) => i.peak_force_kN], ["retained", "m3", (i) => i.retained_m3], ["over", "m3", (i) => i.overtopped_m3],
  ["through", "m3", (i) => i.passed_m3], ["failed at", "s", (i) => i.failed_s]];
const atGauges: readonly Measure<GaugeReading>[] = [["arrival", "s", (g) => g.arrival_s], ["peak depth", "m", (g) => g.peak_depth_m], ["peak speed", "m/s", (g) => g.peak_speed_mps]];
const atPoints: readonly Measure<PointPeaks>[] = [["peak depth", "m", (p) => p.depth_m], ["peak speed", "m/s", (p) => p.speed_mps], ["peak dynamic pressure", "kPa", (p) => p.pressure_kPa]];

/** Rows of what is in either list; values that neither has are left out. */
function paired<T extends { name: string }>(group: string, key: (of: T) => string, a: readonly T[], b: readonly T[], measures: readonly Measure<T>[]): Row[] {
  const all = [...a, ...b.filter((other) => !a.some((one) => key(one) === key(other)))];
  return all.flatMap((item) => {
    const [one, other] = [a, b].map((list) => list.find((i) => key(i) === key(item)));
    return measures.map(([name, unit, of]) => ({ group, name: `${item.name}, ${name}`, unit, a: one ? of(one) : null, b: other ? of(other) : null }))
      .filter((row) => row.a !== null || row.b !== null);
  });
}

/** What both runs have for what was observed in the field. */
function observedRows(a: readonly ObservedRow[], b: readonly ObservedRow[]): Row[] {
  return pairedRows([a, b]).flatMap(([one, other]): Row[] => {
    const row = one ?? other;
    const limit = row?.is === "at_least" ? "at least " : row?.is === "below" ? "below " : "";
    return row === null ? [] : [{ group: "Field observations", name: `${row.name} (observed: ${limit}${fixed(row.observed, decimals(row.observed))})`, unit: row.unit, a: one?.computed ?? null, b: other?.computed ?? null }];
  }).filter((row) => row.a !== null || row.b !== null);
}

/** until_s: time of the recording that houses, barriers and gauges are of; null: they are of the runs so far, as figures and points always are. */
export function comparisonRows(a: Side, b: Side, parameters: readonly Parameter[], until_s: number | null = null): Row[] {
  const until = until_s === null ? "" : `, until ${fixed(until_s, 1)} s`;
  const keys = a.setup && b.setup ? changedKeys([a.setup, b.setup]) : [];
  const given = parameters.filter((p) => keys.includes(p.key))
    .map((p): Row => ({ group: "Parameters", name: p.label, unit: p.unit, a: a.setup?.parameters[p.key] ?? null, b: b.setup?.parameters[p.key] ?? null }));
  const figures = a.figures.flatMap((one): Row[] => {
    const other = b.figures.find((f) => f.key === one.key);
    // "At least" belongs to a figure: said if it holds for either.
    const name = [one.name, other?.name ?? ""].sort((p, q) => q.length - p.length)[0];
    return [{ group: "Key figures", name, unit: one.unit || other?.unit || "", a: one.value, b: other?.value ?? null }];
  });
  const hit = (side: Side): Impact[] => (side.impacts?.buildings ?? []);
  const reached = new Set([...hit(a), ...hit(b)].filter((i) => i.hit).map((i) => i.id));
  const houses = (side: Side): Impact[] => hit(side).filter((i) => reached.has(i.id));
  const wet = new Set([...a.gauges, ...b.gauges].filter((g) => g.peak_depth_m > 0).map((g) => g.name));
  const gauges = (side: Side): GaugeReading[] => side.gauges.filter((g) => wet.has(g.name));
  return [...given, ...figures, ...paired(`Houses${until}`, (i: Impact) => i.id, houses(a), houses(b), atHouses),
    ...paired(`Barriers${until}`, (i: BarrierImpact) => i.id, a.impacts?.barriers ?? [], b.impacts?.barriers ?? [], atBarriers),
    ...paired(`Gauges${until}`, (g: GaugeReading) => g.name, gauges(a), gauges(b), atGauges),
    ...observedRows(a.observed ?? [], b.observed ?? []),
    ...paired("Points", (p: PointPeaks) => p.name, a.points, b.points, atPoints)];
}

/** Houses that neither has hit. */
export function untouched(a: Side, b: Side): number {
  const hit = new Set([...(a.impacts?.buildings ?? []), ...(b.impacts?.buildings ?? [])].filter((i) => i.hit).map((i) => i.id));
  return (a.impacts?.buildings ?? []).filter((i) => !hit.has(i.id)).length;
}
