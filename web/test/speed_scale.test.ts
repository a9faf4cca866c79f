import { expect, test } from "vitest";
import { speedScale_mps } from "../src/scene/colour";

test("the scale of speed follows from the runs alone, not from when somebody came", () => {
  expect(speedScale_mps([null])).toBe(10);
  expect(speedScale_mps([{ peak_speed_mps: 4 }, null])).toBe(10);
  expect(speedScale_mps([{ peak_speed_mps: 13.2 }, { peak_speed_mps: 17 }])).toBe(20);
  expect(speedScale_mps([{ peak_speed_mps: null }]), "after a restart").toBe(10);
});
