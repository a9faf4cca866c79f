// Contours of a terrain by marching squares between the centres of its cells.
import type { Grid } from "../protocol/grid";
import type { Point } from "../protocol/messages";
import { roundBelow } from "./map_view";

export interface Contour {
  level_m: number;
  /** Every fifth, drawn bolder and labelled. */
  index: boolean;
  /** Higher ground is on the left. A closed contour ends where it begins. */
  points: Point[];
}

/** About so many lines over the relief; steep parts have them closer. */
const lines_over_relief = 24;
const least_interval_m = 0.1;

/** Vertical distance of contours, m: 1, 2 or 5 times a power of ten. `zoom`: how many times larger than the whole terrain the map is. */
export function contourInterval(relief_m: number, zoom: number): number {
  return relief_m > 0 ? roundBelow(Math.max(least_interval_m, (2 * relief_m) / (lines_over_relief * Math.max(1, zoom)))) : 1;
}

/** The part of a grid around a rectangle, every so many cells, so that those shown are at least `spacing_m` apart. */
export function partOf(grid: Grid, west: number, south: number, east: number, north: number, spacing_m: number): Grid {
  const step = Math.max(1, Math.ceil(spacing_m / grid.cell));
  const span = (from: number, to: number, edge: number, count: number): number[] => {
    // On the same cells wherever the rectangle begins, so that lines stay in place while the map is moved.
    const first = Math.max(0, Math.floor((from - edge) / grid.cell / step) - 1) * step;
    const last = Math.min(count - 1, Math.ceil((to - edge) / grid.cell) + step);
    return Array.from({ length: Math.max(0, Math.floor((last - first) / step) + 1) }, (_, i) => first + i * step);
  };
  const columns = span(west, east, grid.west, grid.columns);
  const rows = span(south, north, grid.south, grid.rows);
  const cell = step * grid.cell;
  const values = new Float32Array(columns.length * rows.length);
  let k = 0;
  for (const row of rows) for (const column of columns) values[k++] = grid.values[row * grid.columns + column];
  const edge = (from: number, first: number | undefined): number => from + ((first ?? 0) + 0.5) * grid.cell - cell / 2;
  return { west: edge(grid.west, columns[0]), south: edge(grid.south, rows[0]), cell, columns: columns.length, rows: rows.length, values };
}

/** Contour lines of a grid; they end at cells without data. */
export function contours(grid: Grid, interval_m: number): Contour[] {
  const { columns, rows, values } = grid;
  // By level: from the edge on which a piece begins to the one on which it ends. An edge is 2k to the east of cell k, 2k + 1 to its north.
  const pieces = new Map<number, Map<number, number>>();
  for (let row = 0; row + 1 < rows; ++row) {
    for (let column = 0; column + 1 < columns; ++column) {
      const k = row * columns + column;
      // Corners anticlockwise from the south-west, and the edges after each.
      const z = [values[k], values[k + 1], values[k + columns + 1], values[k + columns]] as const;
      const low = Math.min(...z);
      if (Number.isNaN(low)) continue;
      const edges = [2 * k, 2 * (k + 1) + 1, 2 * (k + columns), 2 * k + 1] as const;
      const middle = (z[0] + z[1] + z[2] + z[3]) / 4;
      for (let level = Math.floor(low / interval_m) + 1; level * interval_m <= Math.max(...z); ++level) {
        const height = level * interval_m;
        let of = pieces.get(level);
        if (!of) pieces.set(level, (of = new Map()));
        const above = z.map((corner) => corner >= height);
        for (let i = 0; i < 4; ++i) {
          if (!above[i] || above[(i + 1) % 4]) continue;
          // From where the ground falls below the level to where it rises again: of a saddle, on the side that its middle is not on.
          const way = middle >= height ? 1 : 3;
          let end = (i + way) % 4;
          while (above[end] || !above[(end + 1) % 4]) end = (end + way) % 4;
          of.set(edges[i] as number, edges[end] as number);
        }
      }
    }
  }
  return [...pieces].flatMap(([level, of]) => joined(of).map((edges) => ({ level_m: level * interval_m, index: level % 5 === 0, points: edges.map((edge) => crossing(grid, edge, level * interval_m)) })));
}

/** Pieces into lines, the open ones first. */
function joined(pieces: Map<number, number>): number[][] {
  const ends = new Set(pieces.values());
  const left = new Map(pieces);
  const follow = (first: number): number[] => {
    const line = [first];
    for (let edge = first; ; ) {
      const next = left.get(edge);
      if (next === undefined) return line;
      left.delete(edge);
      line.push(next);
      edge = next;
    }
  };
  const open = [...pieces.keys()].filter((edge) => !ends.has(edge)).map(follow);
  const closed: number[][] = [];
  for (const edge of pieces.keys()) if (left.has(edge)) closed.push(follow(edge));
  return [...open, ...closed];
}
function crossing({ west, south, cell, columns, values }: Grid, edge: number, height: number): Point {
  const k = edge >> 1;
  const north = edge % 2 === 1;
  const [a, b] = [values[k], values[north ? k + columns : k + 1]];
  const share = (height - a) / (b - a);
  return [west + ((k % columns) + 0.5 + (north ? 0 : share)) * cell, south + (Math.floor(k / columns) + 0.5 + (north ? share : 0)) * cell];
}
