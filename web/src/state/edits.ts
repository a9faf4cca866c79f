// Changes of the setup by the page.
import type { Action, HydrographRow, Point } from "../protocol/messages";
import type { BarrierSet } from "./barriers";
import type { BedSet, ZoneSet } from "./ground";
import { rowsForServer } from "./inflows";
import { lineOf, type Item } from "./shapes";
import type { Shape, Twin } from "./twin";

/**
 * Whether an action on a run that has begun may begin a scenario of its own: it changes results. Starting a release is part of running, a
 * name, a note, an observation, a trigger or an alarm changes nothing, and undo and redo are of the scenario in which something was done.
 */
export function beginsScenario(action: Action): boolean {
  if ("id" in action && "name" in action && Object.keys(action).length === 3) return false;
  return /^(put|remove|set)_/.test(action.action) && action.action !== "set_speed" && !/_(note|observation|trigger|alarm)$/.test(action.action);
}

const rounded = (points: readonly Point[]): Point[] => points.map(([x, y]) => [Number(x.toFixed(2)), Number(y.toFixed(2))]);

/** A new shape of these corners, with the sizes set in the panel; it is selected once it exists. */
export async function create(twin: Twin, shape: Shape, points: readonly Point[]): Promise<void> {
  const corners = rounded(points);
  const sizes = twin.newShape;
  const actions: Record<Shape, () => Action> = {
    release: () => ({ action: "put_release", polygon: corners, ...sizes.release }),
    barrier: () => ({ action: "put_barrier", line: corners, ...sizes.barrier }),
    building: () => ({ action: "put_building", polygon: corners, ...sizes.building }),
    zone: () => ({ action: "put_zone", polygon: corners, ...sizes.zone }),
    bed: () => ({ action: "put_bed", polygon: corners, ...sizes.bed }),
    inflow: () => ({ action: "put_inflow", ...(twin.inflowByLine.value ? { line: corners } : { polygon: corners }), hydrograph: rowsForServer(sizes.inflow.hydrograph) }),
  };
  const done = await twin.act(actions[shape]());
  if (done?.created) twin.selection.value = { shape, id: done.created };
}

/** Sizes that several shapes have may be null here; only the server knows for which that is invalid. */
export interface Change extends Omit<BarrierSet, "thickness_m" | "height_m">, ZoneSet, BedSet {
  points?: readonly Point[]; move_m?: Point; name?: string; thickness_m?: number | null; height_m?: number | null; direction_deg?: number | null; hydrograph?: HydrographRow[];
}

/** Sends only the changed values. */
export async function change(twin: Twin, item: Item, what: Change): Promise<boolean> {
  const { points, move_m, ...sizes } = what;
  const by = move_m === undefined ? {} : { move_m: rounded([move_m])[0] };
  const key = lineOf(item) ? "line" : "polygon";
  const outline = points === undefined ? {} : { [key]: rounded(points) };
  return (await twin.act({ action: `put_${item.shape}`, id: item.id, ...sizes, ...by, ...outline } as Action)) !== null;
}

export async function remove(twin: Twin, item: Item): Promise<void> {
  const done = await twin.act({ action: `remove_${item.shape}`, id: item.id });
  if (done && twin.selection.value?.id === item.id) twin.selection.value = null;
}
