import { describe, expect, it } from "vitest";
import type { Grid } from "../src/protocol/grid";
import { Relief } from "../src/scene/relief";
import { groundKey } from "../src/scene/sinking";

const grid = (west: number, south: number, cell: number, rows: number[][]): Grid =>
  ({ west, south, cell, columns: rows[0].length, rows: rows.length, values: Float32Array.from(rows.flat()) });

describe("a ground that debris has picked up from", () => {
  const flat = grid(100, 200, 2, [[10, 10, 10, 10], [10, 10, 10, 10], [10, 10, NaN, 10]]);
  const relief = new Relief(flat, [100, 200, 0]);

  it("lies deeper in the cells of the layer, which covers a part of it", () => {
    const lower = relief.lowered(grid(102, 202, 2, [[0.5, NaN, 1], [NaN, 3, 0.25]]));
    expect([...lower.grid.values]).toEqual([10, 10, 10, 10, 10, 9.5, 10, 9, 10, 10, NaN, 9.75]);
    expect([lower.lowest, lower.highest]).toEqual([9, 10]);
    expect(lower.at(103, 202)).toBe(9.75);
    expect([...flat.values].filter((z) => z !== 10)).toEqual([NaN]);
  });
  it("takes what lies right below where its cells are wider or narrower than the layer's", () => {
    // Every third cell of a finer terrain, as a server thins it: centres fall on centres.
    const fine = grid(100, 200, 2 / 3, Array.from({ length: 9 }, (_, j) => Array.from({ length: 12 }, (_unused, i) => (i === 4 && j === 1 ? 2 : i === 3 && j === 4 ? 7 : NaN))));
    expect([...relief.lowered(fine).grid.values]).toEqual([10, 8, 10, 10, 10, 10, 10, 10, 10, 10, NaN, 10]);
    expect([...relief.lowered(grid(100, 200, 4, [[1, NaN]])).grid.values]).toEqual([9, 9, 10, 10, 9, 9, 10, 10, 10, 10, NaN, 10]);
  });
  it("is the same where the layer is beside it or holds nothing", () => {
    for (const layer of [grid(300, 200, 2, [[5]]), grid(100, 100, 2, [[5]]), grid(90, 190, 2, [[5, 5]]), grid(100, 200, 2, [[NaN]])]) {
      expect([...relief.lowered(layer).grid.values]).toEqual([...flat.values]);
    }
  });
  it("needs no question before anything was picked up, and one per volume or time after", () => {
    expect([groundKey(0, null), groundKey(0, 3)]).toEqual(["", ""]);
    expect(new Set([groundKey(2, null), groundKey(2.5, null), groundKey(2.5, 3), groundKey(2.5, 4)]).size).toBe(4);
    expect(groundKey(2, 3)).toBe(groundKey(2.5, 3));
  });
});
