// What a line or an outline on the ground comes to: length, heights, slope, and where it is along the flow path.
import type { FlowPath, Point } from "../protocol/messages";
import type { Relief } from "../scene/relief";
import { fixed, quantity } from "./format";
import { area, crossesItself, inside, length, releaseVolume } from "./shapes";

/** Chainage of the nearest place on the path, and how far away that is, m. */
export function chainageAt(path: FlowPath, [x, y]: Point): { chainage_m: number; off_m: number } {
  let best = { chainage_m: 0, off_m: Infinity };
  for (let k = 1; k < path.points.length; ++k) {
    const [[x0, y0], [x1, y1]] = [path.points[k - 1], path.points[k]];
    const [dx, dy] = [x1 - x0, y1 - y0];
    const t = Math.min(1, Math.max(0, ((x - x0) * dx + (y - y0) * dy) / (dx * dx + dy * dy || 1)));
    const off_m = Math.hypot(x - x0 - t * dx, y - y0 - t * dy);
    if (off_m < best.off_m) best = { chainage_m: path.chainage_m[k - 1] + t * (path.chainage_m[k] - path.chainage_m[k - 1]), off_m };
  }
  return best;
}

/** Chainages at which a line crosses the path. */
export function crossings(path: FlowPath, line: readonly Point[]): number[] {
  const found: number[] = [];
  for (let i = 1; i < line.length; ++i) {
    const [[ax, ay], [bx, by]] = [line[i - 1], line[i]];
    for (let k = 1; k < path.points.length; ++k) {
      const [[cx, cy], [dx, dy]] = [path.points[k - 1], path.points[k]];
      const across = (bx - ax) * (dy - cy) - (by - ay) * (dx - cx);
      if (across === 0) continue;
      const t = ((cx - ax) * (dy - cy) - (cy - ay) * (dx - cx)) / across;
      const u = ((cx - ax) * (by - ay) - (cy - ay) * (bx - ax)) / across;
      if (t >= 0 && t <= 1 && u >= 0 && u < 1) found.push(path.chainage_m[k - 1] + u * (path.chainage_m[k] - path.chainage_m[k - 1]));
    }
  }
  return found.sort((a, b) => a - b);
}

const slope_deg = (relief: Relief, [x, y]: Point): number => {
  const step = relief.grid.cell;
  return (Math.atan(Math.hypot(relief.at(x + step, y) - relief.at(x - step, y), relief.at(x, y + step) - relief.at(x, y - step)) / (2 * step)) * 180) / Math.PI;
};

export interface LineMeasures {
  /** In plan, and over the ground, m. */
  plan_m: number;
  ground_m: number;
  /** From the first to the last point; negative: downhill. Lowest and highest ground on the way, m. */
  rise_m: number;
  lowest_m: number;
  highest_m: number;
  /** From end to end, and of the steepest part between two places a cell apart, both along the line. */
  slope_deg: number;
  steepest_deg: number;
}
/** Of a line of two points or more on the ground. */
export function lineMeasures(line: readonly Point[], relief: Relief): LineMeasures {
  const places = along(line, relief.grid.cell);
  const heights = places.map(([x, y]) => relief.at(x, y));
  const degrees = (rise: number, run: number): number => (Math.atan2(Math.abs(rise), run) * 180) / Math.PI;
  let ground_m = 0;
  let steepest_deg = 0;
  for (let k = 1; k < places.length; ++k) {
    const run = Math.hypot(places[k][0] - places[k - 1][0], places[k][1] - places[k - 1][1]);
    const rise = heights[k] - heights[k - 1];
    if (run === 0) continue;
    ground_m += Math.hypot(run, rise);
    steepest_deg = Math.max(steepest_deg, degrees(rise, run));
  }
  const plan_m = length(line);
  const rise_m = heights[heights.length - 1] - heights[0];
  return { plan_m, ground_m, rise_m, lowest_m: Math.min(...heights), highest_m: Math.max(...heights), slope_deg: plan_m > 0 ? degrees(rise_m, plan_m) : 0, steepest_deg };
}
/** Area inside an outline, in plan and over the ground, m2; null: no outline, or it crosses itself. */
export function areaMeasures(outline: readonly Point[], relief: Relief): { plan_m2: number; ground_m2: number } | null {
  if (outline.length < 3 || crossesItself(outline)) return null;
  // A release of 1 m thickness normal to the slope has the volume of the area over the ground.
  return { plan_m2: area(outline), ground_m2: releaseVolume(outline, 1, relief) };
}

/** Places along a line, at most a cell apart. */
function along(line: readonly Point[], step: number): Point[] {
  return line.flatMap((point, k): Point[] => {
    if (k === 0) return [point];
    const [x0, y0] = line[k - 1];
    const parts = Math.min(200, Math.max(1, Math.ceil(Math.hypot(point[0] - x0, point[1] - y0) / step)));
    return Array.from({ length: parts }, (_, s): Point => [x0 + ((point[0] - x0) * (s + 1)) / parts, y0 + ((point[1] - y0) * (s + 1)) / parts]);
  });
}
/** Places spread over the inside of an outline, and its corners. */
export function within(ring: readonly Point[]): Point[] {
  const [xs, ys] = [ring.map((p) => p[0]), ring.map((p) => p[1])];
  const [west, east, south, north] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  const places = Array.from({ length: 400 }, (_, k): Point => [west + (((k % 20) + 0.5) / 20) * (east - west), south + ((Math.floor(k / 20) + 0.5) / 20) * (north - south)]);
  return [...ring, ...places.filter(([x, y]) => inside(ring, x, y))];
}

/** "ground 171.2 to 175.0 m, slope 24°, crosses the flow path at 152 m"; of a line also its length. */
export function groundMeasures(points: readonly Point[], closed: boolean, relief: Relief, path: FlowPath | null): string {
  const ring = closed && points.length > 2;
  const places = ring ? within(points) : along(points, relief.grid.cell);
  const heights = places.map(([x, y]) => relief.at(x, y));
  const slope = places.reduce((sum, p) => sum + slope_deg(relief, p), 0) / places.length;
  const said = points.length === 1 || ring ? [] : [`${quantity(length(points), "m")} long`];
  const [low, high] = [fixed(Math.min(...heights), 1), fixed(Math.max(...heights), 1)];
  said.push(`ground ${low === high ? low : `${low} to ${high}`}\u202fm`, `slope ${fixed(slope, 0)}°`);
  if (path && path.points.length > 1) said.push(chainageText(points, ring, path));
  return said.join(", ");
}
function chainageText(points: readonly Point[], ring: boolean, path: FlowPath): string {
  const met = crossings(path, ring ? [...points, points[0]] : points);
  if (!ring && met.length > 0) return `crosses the flow path at ${met.map((c) => fixed(c, 0)).join(", ")}\u202fm`;
  const near = points.map((p) => chainageAt(path, p));
  const [from, to] = [Math.min(...near.map((n) => n.chainage_m)), Math.max(...near.map((n) => n.chainage_m))].map((c) => fixed(c, 0));
  const off = met.length > 0 || (ring && path.points.some(([x, y]) => inside(points, x, y))) ? 0 : Math.min(...near.map((n) => n.off_m));
  return `chainage ${from === to ? from : `${from} to ${to}`}\u202fm${off > 0 ? `, ${fixed(off, 0)}\u202fm from the flow path` : ""}`;
}

const halfMost_m = 40;
const halfFewest_m = 3;
/** A line square to the flow path at the place nearest to `point`, on both sides as far as the ground is lower than `height_m` above the path. */
export function acrossPath(path: FlowPath, point: Point, height_m: number, relief: Relief): [Point, Point] | null {
  if (path.points.length < 2) return null;
  const { chainage_m } = chainageAt(path, point);
  const k = Math.max(1, path.chainage_m.findIndex((c) => c >= chainage_m));
  const [[x0, y0], [x1, y1]] = [path.points[k - 1], path.points[k]];
  const span = path.chainage_m[k] - path.chainage_m[k - 1];
  const t = span > 0 ? (chainage_m - path.chainage_m[k - 1]) / span : 0;
  const [x, y] = [x0 + t * (x1 - x0), y0 + t * (y1 - y0)];
  const run = Math.hypot(x1 - x0, y1 - y0) || 1;
  const [u, v] = [-(y1 - y0) / run, (x1 - x0) / run];
  const crest = relief.at(x, y) + height_m;
  const end = (sign: number): Point => {
    let half = halfFewest_m;
    while (half < halfMost_m && relief.at(x + sign * half * u, y + sign * half * v) < crest) half += 0.5;
    return [x + sign * half * u, y + sign * half * v];
  };
  return [end(-1), end(1)];
}
