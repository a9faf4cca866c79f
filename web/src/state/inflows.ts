// Hydrographs and the direction of inflows.
import type { HydrographRow, Inflow, Point } from "../protocol/messages";
import { fields } from "../protocol/schema";
import type { Relief } from "../scene/relief";
import { quantity, tick } from "./format";

export type HydrographKey = keyof HydrographRow;
export const hydrographKeys = Object.keys(fields.hydrograph) as HydrographKey[];

/** A surge that rises, stays and falls: 200 m3. */
export const usualHydrograph: readonly HydrographRow[] = [[0, 0], [5, 10], [20, 10], [25, 0]].map(([time_s, discharge_m3ps]) => ({ time_s, discharge_m3ps, velocity_mps: 5 }));

/** With one number of one row changed, in the order of time; null if that is not a valid number. */
export function rowsWith(rows: readonly HydrographRow[], index: number, key: HydrographKey, value: number): HydrographRow[] | null {
  const { low, high } = fields.hydrograph[key];
  if (!(value >= low && value <= high)) return null;
  return rows.map((row, k) => (k === index ? { ...row, [key]: value } : row)).sort((a, b) => a.time_s - b.time_s);
}
/** With one more row at the end, as far after the last as that is after the one before. */
export function rowsAndOne(rows: readonly HydrographRow[]): HydrographRow[] {
  const [before, last] = rows.slice(-2);
  return [...rows, { ...last, time_s: Number((2 * last.time_s - before.time_s).toPrecision(9)) }];
}
export const rowsWithout = (rows: readonly HydrographRow[], index: number): HydrographRow[] => rows.filter((_, k) => k !== index);

export const hasDensity = (rows: readonly HydrographRow[]): boolean => rows.some((row) => typeof row.density_kgpm3 === "number");
/** All rows with this density; null: with none of their own. */
export const rowsOfDensity = (rows: readonly HydrographRow[], density: number | null): HydrographRow[] => rows.map((row) => ({ ...row, density_kgpm3: density }));

/** In the form for the server: an absent density is omitted. */
export const rowsForServer = (rows: readonly HydrographRow[]): HydrographRow[] => rows.map(({ density_kgpm3, ...row }) => (typeof density_kgpm3 === "number" ? { ...row, density_kgpm3 } : row));

/** Discharge is linear between rows. */
export function volumeOf(rows: readonly HydrographRow[]): number {
  return rows.slice(1).reduce((sum, row, k) => sum + (row.time_s - rows[k].time_s) * (row.discharge_m3ps + rows[k].discharge_m3ps) / 2, 0);
}
export const peakOf = (rows: readonly HydrographRow[]): number => Math.max(0, ...rows.map((row) => row.discharge_m3ps));

/** An arrow as one stroke: shaft, then both sides of its head. */
function arrow([x, y]: Point, [u, v]: Point, length: number): Point[] {
  const tip: Point = [x + u * length, y + v * length];
  const side = (s: number): Point => [tip[0] - 0.35 * length * u + s * 0.22 * length * v, tip[1] - 0.35 * length * v - s * 0.22 * length * u];
  return [[x, y], tip, side(1), tip, side(-1)];
}
/**
 * Direction of the debris: arrows to the right of a line, seen from its first end, or one in an area's middle along
 * its direction.
 */
export function arrowsOf(line: readonly Point[]): Point[][] {
  const [[x0, y0], [x1, y1]] = line;
  const length = Math.hypot(x1 - x0, y1 - y0);
  if (length === 0) return [];
  const right: Point = [(y1 - y0) / length, -(x1 - x0) / length];
  const count = Math.max(1, Math.min(4, Math.round(length / 15)));
  const long = Math.min(30, Math.max(4, (0.8 * length) / count));
  return Array.from({ length: count }, (_, k) => {
    const t = (k + 0.5) / count;
    return arrow([x0 + t * (x1 - x0), y0 + t * (y1 - y0)], right, long);
  });
}
export function arrowAlong(at: Point, direction_deg: number, area_m2: number): Point[] {
  const angle = (direction_deg * Math.PI) / 180;
  const way: Point = [Math.sin(angle), Math.cos(angle)];
  const long = Math.min(40, Math.max(3, 0.4 * Math.sqrt(area_m2)));
  return arrow([at[0] - 0.5 * long * way[0], at[1] - 0.5 * long * way[1]], way, long);
}
/** Down the fall line at a place, in whole degrees clockwise from north. */
export function downhill_deg(relief: Relief, [x, y]: Point): number {
  const reach = 2 * relief.grid.cell;
  const east = relief.at(x - reach, y) - relief.at(x + reach, y);
  const north = relief.at(x, y - reach) - relief.at(x, y + reach);
  return Math.round(((Math.atan2(east, north) * 180) / Math.PI + 360) % 360) % 360;
}

/** In a list: "200 m³, 10 m³/s". */
export function inflowNote(inflow: Pick<Inflow, "hydrograph" | "volume_m3" | "in_force">): string {
  const more = !inflow.in_force ? ", next restart" : inflow.hydrograph ? `, ${tick(peakOf(inflow.hydrograph))}\u202fm³/s` : "";
  return quantity(inflow.volume_m3, "m3") + more;
}
