// Selects the shape on the ground for a click that hits no house, barrier or release.
import type { Point, Setup } from "../protocol/messages";
import { distanceToLine, footprintArea, inside } from "./shapes";
import type { Selection } from "./twin";

/**
 * An inflow's line within reach, else the smallest area around the place. One that covers much of the terrain would
 * catch every stray click: it is selected in its list.
 */
export function groundUnder(setup: Setup, at: Point, reach_m: number, terrain_m2: number): Selection | null {
  const line = setup.inflows.filter((i) => i.line !== null).map((i) => ({ id: i.id, far: distanceToLine(at, i.line ?? []) })).sort((a, b) => a.far - b.far)[0];
  if (line && line.far <= reach_m) return { shape: "inflow", id: line.id };
  const [x, y] = at;
  const areas = ([["inflow", setup.inflows], ["bed", setup.beds], ["zone", setup.zones]] as const).flatMap(([shape, list]) => list
    .filter(({ polygons }) => polygons.some((rings) => rings.filter((ring) => inside(ring, x, y)).length % 2 === 1))
    .map(({ id, polygons }) => ({ shape, id, size: footprintArea(polygons) })));
  const smallest = areas.filter(({ size }) => size < terrain_m2 / 4).sort((a, b) => a.size - b.size)[0];
  return smallest ? { shape: smallest.shape, id: smallest.id } : null;
}
