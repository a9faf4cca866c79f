// Changes of the setup as the page asks for them.
import type { Point } from "../protocol/messages";
import { area, type Item } from "./shapes";
import type { Shape, Twin } from "./twin";

const rounded = (points: readonly Point[]): Point[] => points.map(([x, y]) => [Number(x.toFixed(2)), Number(y.toFixed(2))]);

/** A new shape of these corners, with the sizes set in the panel; it is selected once it is there. */
export async function create(twin: Twin, shape: Shape, points: readonly Point[]): Promise<void> {
  const corners = rounded(points);
  const sizes = twin.newShape;
  const done = await twin.act(
    shape === "release" ? { action: "put_release", polygon: corners, ...sizes.release }
      : shape === "barrier" ? { action: "put_barrier", line: corners, ...sizes.barrier }
        : { action: "put_building", footprint: corners, ...sizes.building });
  if (done?.created) twin.selection.value = { shape, id: done.created };
}

export interface Change { points?: readonly Point[]; name?: string; thickness_m?: number; height_m?: number }

export async function change(twin: Twin, item: Item, what: Change): Promise<boolean> {
  const name = what.name ?? item.name;
  const { id } = item;
  if (item.shape === "release") {
    const polygon = rounded(what.points ?? item.polygons[0] ?? []);
    const thickness_m = what.thickness_m ?? item.thickness_m ?? item.volume_m3 / Math.max(1, area(polygon));
    return (await twin.act({ action: "put_release", id, name, polygon, thickness_m })) !== null;
  }
  if (item.shape === "barrier") {
    return (await twin.act({ action: "put_barrier", id, name, line: rounded(what.points ?? item.line),
      height_m: what.height_m ?? item.height_m, thickness_m: what.thickness_m ?? item.thickness_m })) !== null;
  }
  return (await twin.act({ action: "put_building", id, name, footprint: rounded(what.points ?? item.footprint[0] ?? []),
    height_m: what.height_m ?? item.height_m })) !== null;
}

export async function remove(twin: Twin, item: Item): Promise<void> {
  const done = await twin.act({ action: `remove_${item.shape}`, id: item.id });
  if (done && twin.selection.value?.id === item.id) twin.selection.value = null;
}
