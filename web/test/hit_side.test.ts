import { describe, expect, it } from "vitest";
import type { Grid } from "../src/protocol/grid";
import { ramps } from "../src/scene/colour";
import { hitSide } from "../src/scene/hit_side";
import { layerInfo } from "../src/scene/layers";
import { Relief } from "../src/scene/relief";

const size = 40;
const grid = (at: (x: number, y: number) => number): Grid => ({ west: 0, south: 0, cell: 1, columns: size, rows: size,
  values: Float32Array.from({ length: size * size }, (_, k) => at((k % size) + 0.5, Math.floor(k / size) + 0.5)) });
/** Falls to the south. */
const relief = new Relief(grid((_, y) => y), [0, 0, 0]);
const house: [number, number][] = [[18, 18], [22, 18], [22, 22], [18, 22]];

describe("the side of a house from which it is seen", () => {
  it("is that where debris was deepest in front of its walls", () => {
    const [east, north] = hitSide(house, true, grid((x, y) => (x < 18 && y > 17 && y < 23 ? 2 : NaN)), relief);
    expect(east).toBeLessThan(-0.98);
    expect(Math.abs(north)).toBeLessThan(0.15);
  });
  it("is uphill where nothing has come, as much on all sides, or not close to it", () => {
    for (const depth of [null, grid(() => 1), grid((x) => (x < 5 ? 3 : NaN))]) {
      const [east, north] = hitSide(house, true, depth, relief);
      expect(north).toBeGreaterThan(0.99);
      expect(Math.abs(east)).toBeLessThan(0.05);
    }
  });
  it("of a barrier is the side of its line", () => {
    const [east, north] = hitSide([[10, 20], [30, 20]], false, grid((_, y) => (y < 20 ? 1 : NaN)), relief);
    expect(north).toBeLessThan(-0.95);
    expect(Math.abs(east)).toBeLessThan(0.1);
  });
});

describe("colours", () => {
  it("of debris and houses are not those of a layer under them, which has another scale", () => {
    const texts = [...Object.values(ramps), ...Object.values(layerInfo).map((layer) => layer.ramp)].map((ramp) => JSON.stringify(ramp));
    for (const name of ["speed", "surface_depth", "impact_pressure"] as const) {
      expect(texts.filter((text) => text === JSON.stringify(ramps[name]))).toHaveLength(1);
    }
  });
});
