// Plane geometry of shapes: areas, lengths, volumes.
import type { Barrier, Bed, Building, Inflow, Point, Release, Setup, Zone } from "../protocol/messages";
import type { Relief } from "../scene/relief";
import type { Selection, Shape } from "./twin";

export function area(ring: readonly Point[]): number {
  let twice = 0;
  ring.forEach(([x, y], i) => {
    const [u, v] = ring[(i + 1) % ring.length];
    // Relative to the first corner: products of national coordinates would lose digits.
    twice += (x - ring[0][0]) * (v - ring[0][1]) - (u - ring[0][0]) * (y - ring[0][1]);
  });
  return Math.abs(twice) / 2;
}
/** Of polygons, each with its outer ring first: courtyards do not count. */
export function footprintArea(polygons: readonly (readonly (readonly Point[])[])[]): number {
  return polygons.reduce((sum, [outer, ...holes]) => sum + area(outer) - holes.reduce((all, hole) => all + area(hole), 0), 0);
}
export function length(line: readonly Point[]): number {
  let sum = 0;
  for (let i = 1; i < line.length; ++i) sum += Math.hypot(line[i][0] - line[i - 1][0], line[i][1] - line[i - 1][1]);
  return sum;
}
export function middle(ring: readonly Point[]): Point {
  return [ring.reduce((s, p) => s + p[0], 0) / ring.length, ring.reduce((s, p) => s + p[1], 0) / ring.length];
}
export function inside(ring: readonly Point[], x: number, y: number): boolean {
  let odd = false;
  for (let i = 0, j = ring.length - 1; i < ring.length; j = i++) {
    const [xi, yi] = ring[i];
    const [xj, yj] = ring[j];
    if (yi > y !== yj > y && x < ((xj - xi) * (y - yi)) / (yj - yi) + xi) odd = !odd;
  }
  return odd;
}
export function distanceToLine([x, y]: Point, line: readonly Point[]): number {
  let least = Infinity;
  for (let k = 1; k < line.length; ++k) {
    const [[x0, y0], [x1, y1]] = [line[k - 1], line[k]];
    const squared = (x1 - x0) ** 2 + (y1 - y0) ** 2;
    const t = squared > 0 ? Math.min(1, Math.max(0, ((x - x0) * (x1 - x0) + (y - y0) * (y1 - y0)) / squared)) : 0;
    least = Math.min(least, Math.hypot(x - x0 - t * (x1 - x0), y - y0 - t * (y1 - y0)));
  }
  return least;
}
/** Whether the ring crosses itself. */
export function crossesItself(ring: readonly Point[]): boolean {
  const n = ring.length;
  const side = (a: Point, b: Point, c: Point): number => (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  for (let i = 0; i < n; ++i) {
    for (let j = i + 2; j < n; ++j) {
      if (i === 0 && j === n - 1) continue;
      const [a, b, c, d] = [ring[i], ring[(i + 1) % n], ring[j], ring[(j + 1) % n]];
      if (side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0) return true;
    }
  }
  return false;
}
/** Thickness is normal to the slope, so a plan area holds 1 / cos(slope) more; sampled over the area. */
export function releaseVolume(ring: readonly Point[], thickness_m: number, relief: Relief): number {
  if (ring.length < 3) return 0;
  const xs = ring.map((p) => p[0]);
  const ys = ring.map((p) => p[1]);
  const [west, east, south, north] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  const cell = relief.grid.cell;
  let sum = 0;
  let count = 0;
  for (let j = 0; j < 20; ++j) {
    for (let i = 0; i < 20; ++i) {
      const x = west + ((i + 0.5) / 20) * (east - west);
      const y = south + ((j + 0.5) / 20) * (north - south);
      if (!inside(ring, x, y)) continue;
      const dx = (relief.at(x + cell, y) - relief.at(x - cell, y)) / (2 * cell);
      const dy = (relief.at(x, y + cell) - relief.at(x, y - cell)) / (2 * cell);
      sum += Math.hypot(1, dx, dy);
      ++count;
    }
  }
  return area(ring) * thickness_m * (count > 0 ? sum / count : 1);
}

/** byLine: an inflow across a line, in place of one over an area. */
export const drawnAsLine = (shape: Shape, byLine: boolean): boolean => shape === "barrier" || (shape === "inflow" && byLine);
export const fewestPoints = (shape: Shape, byLine: boolean): number => (drawnAsLine(shape, byLine) ? 2 : 3);
/** An inflow's line is straight: it has no third point. */
export const mostPoints = (shape: Shape, byLine: boolean): number => (shape === "inflow" && byLine ? 2 : Infinity);

export type Item = ({ shape: "release" } & Release) | ({ shape: "barrier" } & Barrier) | ({ shape: "building" } & Building)
  | ({ shape: "zone" } & Zone) | ({ shape: "bed" } & Bed) | ({ shape: "inflow" } & Inflow);

export function itemsOf(setup: Setup | null, shape: Shape): Item[] {
  if (!setup) return [];
  switch (shape) {
    case "release": return setup.releases.map((r) => ({ shape, ...r }));
    case "barrier": return setup.barriers.map((b) => ({ shape, ...b }));
    case "building": return setup.buildings.map((b) => ({ shape, ...b }));
    case "zone": return setup.zones.map((z) => ({ shape, ...z }));
    case "bed": return setup.beds.map((b) => ({ shape, ...b }));
    case "inflow": return setup.inflows.map((i) => ({ shape, ...i }));
  }
}
export function itemOf(setup: Setup | null, selection: Selection | null): Item | null {
  return selection === null ? null : (itemsOf(setup, selection.shape).find((item) => item.id === selection.id) ?? null);
}
/** The line of a linear shape, null for areas. */
export const lineOf = (item: Item): Point[] | null => (item.shape === "barrier" || item.shape === "inflow" ? item.line : null);
/** Polygons of an area, each with its outer ring first. */
export const partsOf = (item: Item): Point[][][] => (item.shape === "barrier" ? [] : item.polygons);
/** Corners that can be moved; a ring's repeated last corner is left out. */
export function pointsOf(item: Item): Point[] {
  const line = lineOf(item);
  const points = line ?? partsOf(item)[0]?.[0] ?? [];
  const [first] = points;
  const last = points[points.length - 1];
  const closed = line === null && points.length > 1 && first[0] === last[0] && first[1] === last[1];
  return closed ? points.slice(0, -1) : points;
}
/** A shape with several parts or holes cannot be sent back as one outline. */
export function canReshape(item: Item): boolean {
  const parts = partsOf(item);
  return lineOf(item) !== null || (parts.length === 1 && parts[0].length === 1);
}
/** A shape from a raster, or one that covers everything, has no outline to move. */
export const hasOutline = (item: Item): boolean => lineOf(item) !== null || partsOf(item).length > 0;
