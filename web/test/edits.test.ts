import { expect, test } from "vitest";
import type { Action } from "../src/protocol/messages";
import { beginsScenario } from "../src/state/edits";

test("an edit of a run that has begun may begin a scenario; undo and redo act on the scenario itself", () => {
  const edits: Action[] = [{ action: "set_parameters", values: {} }, { action: "remove_barrier", id: "b" }, { action: "put_barrier", id: "b", height_m: 3 }];
  for (const action of edits) expect(beginsScenario(action), action.action).toBe(true);
  const others: Action[] = [{ action: "undo" }, { action: "redo" }, { action: "trigger_release", id: "r" }, { action: "set_speed", factor: 2 }, { action: "put_barrier", id: "b", name: "Upper wall" },
    { action: "put_note", name: "Culvert blocked", x_m: 1, y_m: 2 }, { action: "remove_note", id: "note-1" }];
  for (const action of others) expect(beginsScenario(action), action.action).toBe(false);
});
