import { describe, expect, it } from "vitest";
import type { Grid } from "../src/protocol/grid";
import { divergingAt, lightness, rampAt, ramps, roundStep } from "../src/scene/colour";
import { differenceOf, scaleEnd, shownValues } from "../src/scene/layers";

const grid = (...values: number[]): Grid => ({ west: 0, south: 0, cell: 1, columns: values.length, rows: 1, values: Float32Array.from(values) });

describe("colour ramps", () => {
  it.each(Object.entries(ramps))("%s: lightness goes one way, in even steps", (_, ramp) => {
    const steps = Array.from({ length: 33 }, (_unused, k) => lightness(rampAt(ramp, k / 32)));
    const way = Math.sign(steps[32] - steps[0]);
    const mean = (steps[32] - steps[0]) / 32;
    expect(Math.abs(steps[32] - steps[0])).toBeGreaterThan(0.5);
    for (let k = 1; k < 33; ++k) {
      expect(Math.sign(steps[k] - steps[k - 1])).toBe(way);
      expect(Math.abs(steps[k] - steps[k - 1] - mean)).toBeLessThan(0.012);
    }
  });
  it("differences are lightest at none and darker either way", () => {
    expect(lightness(divergingAt(0))).toBeGreaterThan(0.93);
    expect(lightness(divergingAt(-1))).toBeLessThan(0.5);
    expect(lightness(divergingAt(1))).toBeLessThan(0.5);
    expect(divergingAt(-1)[2]).toBeGreaterThan(divergingAt(-1)[0]);
    expect(divergingAt(1)[0]).toBeGreaterThan(divergingAt(1)[2]);
  });
  it("steps are round", () => {
    expect([0.9, 1.2, 2.2, 3, 7, 80, 0.013].map(roundStep)).toEqual([1, 2, 2.5, 5, 10, 100, 0.02]);
    expect(roundStep(NaN)).toBe(1);
  });
});

describe("layers", () => {
  it("leaves out cells without debris, but an arrival at time 0 counts", () => {
    expect([...shownValues("peak_depth", grid(0, NaN, 2))]).toEqual([NaN, NaN, 2]);
    expect([...shownValues("arrival_time", grid(0, NaN, 2))]).toEqual([0, NaN, 2]);
  });
  it("a single odd cell does not set the scale", () => {
    const values = new Float32Array(1000).fill(1.8);
    values[7] = 400;
    expect(scaleEnd(values)).toBe(2);
    expect(scaleEnd(new Float32Array(5).fill(NaN))).toBe(1);
  });
  it("difference is B - A; what only one reached counts as 0 in the other, but not for times", () => {
    expect([...differenceOf("peak_depth", grid(1, NaN, NaN, 2), grid(3, 2, NaN, NaN)).values]).toEqual([2, 2, NaN, -2]);
    const a: Grid = { west: 10, south: 20, cell: 2, columns: 2, rows: 1, values: Float32Array.of(1, 2) };
    const b: Grid = { west: 12, south: 20, cell: 2, columns: 2, rows: 2, values: Float32Array.of(5, 6, 7, 8) };
    const both = differenceOf("peak_depth", a, b);
    expect(both).toMatchObject({ west: 10, south: 20, cell: 2, columns: 3, rows: 2 });
    expect([...both.values]).toEqual([-1, 3, 6, NaN, 7, 8]);
    expect([...differenceOf("arrival_time", grid(10, NaN), grid(12, 2)).values]).toEqual([2, NaN]);
  });
});
