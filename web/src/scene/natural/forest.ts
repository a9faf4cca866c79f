// Where the trees of forest zones stand: as many stems as a zone has, as thick as they are, at places that are always the same.
import type { Point, Setup } from "../../protocol/messages";
import { distanceToLine, inside } from "../../state/shapes";
import type { Relief } from "../relief";
import { scattered } from "./noise";

/** Largest number of trees in a view; a denser forest is thinned. */
export const mostTrees = 8000;
/** Height over stem diameter. */
const slenderness = 45;
/** Gradient of a slope of 55 degrees: no tree stands on steeper ground. */
const steepest = Math.tan((55 * Math.PI) / 180);
/** A crown that a wall or the edge of a release cuts looks wrong; branches may reach over. */
const clearance = 0.6;

/** crown: its radius; number: of its place. */
export interface Tree { x: number; y: number; height: number; crown: number; number: number }
export type Planted = Pick<Setup, "zones" | "releases" | "barriers" | "buildings">;

const within = (polygons: readonly (readonly (readonly Point[])[])[], x: number, y: number): boolean =>
  polygons.some((rings) => rings.filter((ring) => inside(ring, x, y)).length % 2 === 1);

/** filled: an area, not only a line; half: of a wall's thickness. */
interface Obstacle { lines: readonly (readonly Point[])[]; filled: boolean; half: number }

/** What no tree stands in, found by place: there can be thousands of houses. */
class Obstacles {
  private static readonly cell = 16;
  private static readonly widest = 6;
  private readonly at = new Map<number, Obstacle[]>();

  constructor({ releases, barriers, buildings }: Planted) {
    const closed = (ring: readonly Point[]): readonly Point[] => (ring.length > 0 ? [...ring, ring[0]] : ring);
    for (const rings of [...releases, ...buildings].flatMap(({ polygons }) => polygons)) this.add({ lines: rings.map(closed), filled: true, half: 0 });
    for (const { line, thickness_m } of barriers) this.add({ lines: [line], filled: false, half: thickness_m / 2 });
  }
  private static key(x: number, y: number): number {
    return ((Math.floor(x) & 0xffff) << 16) | (Math.floor(y) & 0xffff);
  }
  private add(obstacle: Obstacle): void {
    const { cell, widest } = Obstacles;
    const reach = obstacle.half + widest;
    const points = obstacle.lines.flat();
    const range = (axis: 0 | 1): [number, number] => [Math.floor((Math.min(...points.map((p) => p[axis])) - reach) / cell), Math.floor((Math.max(...points.map((p) => p[axis])) + reach) / cell)];
    const [[left, right], [low, high]] = [range(0), range(1)];
    for (let j = low; j <= high; ++j) {
      for (let i = left; i <= right; ++i) {
        const key = Obstacles.key(i, j);
        const there = this.at.get(key);
        if (there) there.push(obstacle);
        else this.at.set(key, [obstacle]);
      }
    }
  }
  /** Whether a place is outside of all of them and so far from their edges, at most `widest`. */
  leave(x: number, y: number, free_m: number): boolean {
    const { cell, widest } = Obstacles;
    const far = Math.min(free_m, widest);
    return !this.at.get(Obstacles.key(x / cell, y / cell))?.some(({ lines, filled, half }) =>
      (filled && within([lines], x, y)) || lines.some((line) => distanceToLine([x, y], line) < half + far));
  }
}

function holdsTrees(relief: Relief, x: number, y: number): boolean {
  const e = Math.max(1, relief.grid.cell);
  return relief.hasGround(x, y) && Math.hypot(relief.at(x + e, y) - relief.at(x - e, y), relief.at(x, y + e) - relief.at(x, y - e)) / (2 * e) < steepest;
}

/** Whether a place lies in a zone: in its outlines or, of one from a raster, in its blocks. */
type Area = (x: number, y: number) => boolean;

const bucket_m = 32;
function areaOf({ polygons, blocks = [] }: Planted["zones"][number]): Area {
  if (polygons.length > 0) return (x, y) => within(polygons, x, y);
  const rows = new Map<number, number[][]>();
  for (const block of blocks) {
    for (let row = Math.floor(block[1] / bucket_m); row * bucket_m < block[1] + block[3]; ++row) {
      const there = rows.get(row);
      if (there) there.push(block);
      else rows.set(row, [block]);
    }
  }
  return (x, y) => rows.get(Math.floor(y / bucket_m))?.some(([west, south, wide, high]) => x >= west && y >= south && x < west + wide && y < south + high) ?? false;
}
/** The corners of a zone's outlines or blocks. */
const cornersOf = ({ polygons, blocks = [] }: Planted["zones"][number]): readonly (readonly number[])[] =>
  [...polygons.flatMap((rings) => rings[0] ?? []), ...blocks.flatMap(([x, y, wide, high]) => [[x, y], [x + wide, y + high]])];

/** Stems on a jittered grid whose cells are as large as the ground that a tree has. */
export function treesOf(setup: Planted, relief: Relief, most = mostTrees): Tree[] {
  const forests = setup.zones.filter((zone) => zone.stem_density_pm2 > 0 && zone.polygons.length + (zone.blocks?.length ?? 0) > 0);
  if (forests.length === 0) return [];
  const obstacles = new Obstacles(setup);
  const wanted = forests.reduce((sum, zone) => sum + zone.area_m2 * zone.stem_density_pm2, 0);
  const thinned = Math.min(1, most / Math.max(1, wanted));
  const { west, south } = relief.grid;
  const trees: Tree[] = [];
  const areas = forests.map(areaOf);
  forests.forEach((zone, which) => {
    // Where forests overlap the later one counts, as in the model.
    const later = areas.slice(which + 1);
    const corners = cornersOf(zone);
    const step = 1 / Math.sqrt(zone.stem_density_pm2 * thinned);
    const height = Math.min(28, Math.max(3, slenderness * zone.stem_diameter_m));
    const widest = Math.min(0.26 * height, 0.62 / Math.sqrt(zone.stem_density_pm2));
    const range = (axis: 0 | 1, low: number, size: number): [number, number] => {
      const [least, greatest] = corners.reduce(([a, b], p) => [Math.min(a, p[axis]), Math.max(b, p[axis])], [Infinity, -Infinity]);
      return [Math.floor(Math.max(low, least) / step), Math.min(low + size, greatest) / step];
    };
    const [[left, right], [low, high]] = [range(0, west, relief.width), range(1, south, relief.height)];
    for (let j = low; j <= high; ++j) {
      for (let i = left; i <= right && trees.length < most; ++i) {
        const x = (i + scattered(i, j, 1)) * step;
        const y = (j + scattered(i, j, 2)) * step;
        const crown = widest * (0.8 + 0.5 * scattered(i, j, 4));
        if (!areas[which](x, y) || later.some((area) => area(x, y))) continue;
        if (!holdsTrees(relief, x, y) || !obstacles.leave(x, y, clearance * crown)) continue;
        trees.push({ x, y, height: (0.65 + 0.5 * scattered(i, j, 3)) * height, crown, number: i * 7919 + j });
      }
    }
  });
  return trees;
}
