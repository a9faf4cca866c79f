import { describe, expect, it } from "vitest";
import type { Grid } from "../src/protocol/grid";
import { Relief } from "../src/scene/relief";
import { crestAt } from "../src/scene/solids";
import { acrossPath, areaMeasures, chainageAt, crossings, groundMeasures, lineMeasures } from "../src/state/measures";

/** A gully along x = 50 that falls to the south by 1 in 10; its sides rise by 1 in 2. */
const grid: Grid = { west: 0, south: 0, cell: 1, columns: 100, rows: 100,
  values: Float32Array.from({ length: 10_000 }, (_, k) => 0.1 * Math.floor(k / 100) + 0.5 * Math.abs((k % 100) + 0.5 - 50)) };
const relief = new Relief(grid, [0, 0, 0]);
const path = { points: [[50, 90, 9], [50, 50, 5], [50, 10, 1]], chainage_m: [0, 40, 80], source: "" } as never;

describe("what is drawn on the ground", () => {
  it("is at a chainage of the flow path", () => {
    expect(chainageAt(path, [60, 70])).toEqual({ chainage_m: 20, off_m: 10 });
    expect(crossings(path, [[40, 30], [60, 30], [60, 80], [40, 80]])).toEqual([10, 60]);
    expect(crossings(path, [[60, 30], [60, 80]])).toEqual([]);
  });
  it("has a length, heights and a slope", () => {
    expect(groundMeasures([[40, 30], [60, 30]], false, relief, path)).toBe("20.0\u202fm long, ground 3.2 to 7.9\u202fm, slope 25°, crosses the flow path at 60\u202fm");
    expect(groundMeasures([[60, 70]], false, relief, path)).toBe("ground 11.9\u202fm, slope 27°, chainage 20\u202fm, 10\u202fm from the flow path");
    expect(groundMeasures([[60, 30], [70, 30], [70, 40], [60, 40]], true, relief, null)).toBe("ground 7.9 to 13.9\u202fm, slope 27°");
  });
  it("as a barrier lies square across the path, as far as the ground is lower than its crest", () => {
    const [a, b] = acrossPath(path, [55, 30], 4, relief) ?? [];
    expect([a?.[1], b?.[1]]).toEqual([30, 30]);
    expect([a?.[0], b?.[0]].sort()).toEqual([41.5, 58.5]);
  });
});

describe("a measurement", () => {
  it("of a line down the gully has its fall, its slope and its length over the ground", () => {
    const down = lineMeasures([[50, 80], [50, 50], [50, 20]], relief);
    expect(down.plan_m).toBe(60);
    expect(down.rise_m).toBeCloseTo(-6, 3);
    expect(down.slope_deg).toBeCloseTo(5.71, 2);
    expect(down.steepest_deg).toBeCloseTo(5.71, 1);
    expect(down.ground_m).toBeCloseTo(60 * Math.hypot(1, 0.1), 2);
  });
  it("across the gully returns to its height, but not over level ground", () => {
    const across = lineMeasures([[30, 50], [70, 50]], relief);
    expect(across.rise_m).toBeCloseTo(0, 3);
    expect(across.slope_deg).toBeCloseTo(0, 2);
    expect(across.steepest_deg).toBeCloseTo(26.57, 1);
    expect(across.highest_m - across.lowest_m).toBeGreaterThan(9);
    expect(across.ground_m).toBeGreaterThan(43);
  });
  it("of an outline has its area in plan and over the slope, of one that crosses itself none", () => {
    const side = areaMeasures([[60, 30], [80, 30], [80, 50], [60, 50]], relief);
    expect(side?.plan_m2).toBe(400);
    expect(side?.ground_m2).toBeCloseTo(400 * Math.hypot(1, 0.5, 0.1), 0);
    expect(areaMeasures([[60, 30], [80, 50], [80, 30], [60, 50]], relief)).toBeNull();
    expect(areaMeasures([[60, 30], [80, 30]], relief)).toBeNull();
  });
});

describe("the crest of a barrier", () => {
  it("follows the ground or is level, and falls to the sill in an opening", () => {
    const openings = [{ position_m: 5, width_m: 2, sill_height_m: 1 }];
    expect(crestAt({ height_m: 3 }, 0, 100)).toBe(103);
    expect(crestAt({ height_m: 3, crest_elevation_m: 105 }, 0, 100)).toBe(105);
    expect([3, 5, 7].map((along) => crestAt({ height_m: 3, openings }, along, 100))).toEqual([103, 101, 103]);
  });
});
