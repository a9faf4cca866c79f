import { describe, expect, it } from "vitest";
import { xRange } from "../src/charts/chart";
import { probeColours } from "../src/state/twin";
import { besideColour } from "../src/ui/theme";

describe("a chart", () => {
  it("leaves room for separate marks at both ends of its axis, wider than half a mark", () => {
    const [low, high] = xRange(0, 200, true);
    const pixels_per_m = 300 / ((high ?? 0) - (low ?? 0));
    expect((0 - (low ?? 0)) * pixels_per_m).toBeGreaterThan(6.5);
    expect(((high ?? 0) - 200) * pixels_per_m).toBeGreaterThan(6.5);
    expect(xRange(121, 121, true)).toEqual([120, 122]);
    expect(xRange(0, 200, false)).toEqual([0, 200]);
    expect(xRange(null, null, true)).toEqual([null, null]);
  });
  it("has another colour for each curve of two scenarios", () => {
    const all = [...probeColours, ...probeColours.map(besideColour)];
    expect(new Set(all).size).toBe(all.length);
  });
});
