// Changes of the setup as the page asks for them.
import type { Action, Point } from "../protocol/messages";
import type { Item } from "./shapes";
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

/** Sends just what changes: all else stays as it is. */
export async function change(twin: Twin, item: Item, what: Change): Promise<boolean> {
  const { points, ...sizes } = what;
  const corners = points === undefined ? null : rounded(points);
  const { id } = item;
  const action: Action = item.shape === "release" ? { action: "put_release", id, ...sizes, ...(corners ? { polygon: corners } : {}) }
    : item.shape === "barrier" ? { action: "put_barrier", id, ...sizes, ...(corners ? { line: corners } : {}) }
      : { action: "put_building", id, ...sizes, ...(corners ? { footprint: corners } : {}) };
  return (await twin.act(action)) !== null;
}

export async function remove(twin: Twin, item: Item): Promise<void> {
  const done = await twin.act({ action: `remove_${item.shape}`, id: item.id });
  if (done && twin.selection.value?.id === item.id) twin.selection.value = null;
}
