// From which side debris comes to a house or barrier, so that a view of it shows the walls that are hit.
import type { Grid } from "../protocol/grid";
import type { Point } from "../protocol/messages";
import { inside } from "../state/shapes";
import type { Relief } from "./relief";

/** Debris in front of a wall, not farther away than this, m. */
const reach_m = 4;
/** Below this share of the debris on one side more than on the other, both are hit alike. */
const clear = 0.1;

/**
 * Unit vector from an outline (a ring) or a line to where the debris in front of it was deepest; without debris uphill.
 * `depth`: peak depth, m; NaN: none.
 */
export function hitSide(outline: readonly Point[], closed: boolean, depth: Grid | null, relief: Relief): Point {
  const ring = closed && outline.length > 0 ? [...outline, outline[0]] : outline;
  let [u, v, all] = [0, 0, 0];
  if (depth) {
    const { west, south, cell, columns, rows } = depth;
    const among = (places: readonly number[], edge: number, count: number): [number, number] =>
      [Math.max(0, Math.floor((Math.min(...places) - reach_m - edge) / cell)), Math.min(count - 1, Math.floor((Math.max(...places) + reach_m - edge) / cell))];
    const [left, right] = among(ring.map((p) => p[0]), west, columns);
    const [bottom, top] = among(ring.map((p) => p[1]), south, rows);
    for (let j = bottom; j <= top; ++j) {
      for (let i = left; i <= right; ++i) {
        const d = depth.values[j * columns + i];
        if (!(d > 0)) continue;
        const [x, y] = [west + (i + 0.5) * cell, south + (j + 0.5) * cell];
        const [nx, ny] = nearest(ring, x, y);
        const away = Math.hypot(x - nx, y - ny);
        if (away < 1e-6 || away > reach_m || (closed && inside(outline, x, y))) continue;
        u += (d * (x - nx)) / away;
        v += (d * (y - ny)) / away;
        all += d;
      }
    }
  }
  if (Math.hypot(u, v) <= clear * all || all === 0) [u, v] = uphill(ring, relief);
  const length = Math.hypot(u, v);
  return length > 0 ? [u / length, v / length] : [0, 1];
}

function nearest(line: readonly Point[], x: number, y: number): Point {
  let best: Point = line[0];
  let least = Infinity;
  for (let k = 1; k < line.length; ++k) {
    const [[x0, y0], [x1, y1]] = [line[k - 1], line[k]];
    const [dx, dy] = [x1 - x0, y1 - y0];
    const t = Math.min(1, Math.max(0, ((x - x0) * dx + (y - y0) * dy) / (dx * dx + dy * dy || 1)));
    const at: Point = [x0 + t * dx, y0 + t * dy];
    const away = Math.hypot(x - at[0], y - at[1]);
    if (away < least) [best, least] = [at, away];
  }
  return best;
}

function uphill(line: readonly Point[], relief: Relief): Point {
  const x = line.reduce((sum, p) => sum + p[0], 0) / line.length;
  const y = line.reduce((sum, p) => sum + p[1], 0) / line.length;
  const step = Math.max(10, 2 * relief.grid.cell);
  return [relief.at(x + step, y) - relief.at(x - step, y), relief.at(x, y + step) - relief.at(x, y - step)];
}
