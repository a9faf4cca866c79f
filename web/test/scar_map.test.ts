import { describe, expect, it } from "vitest";
import type { Grid } from "../src/protocol/grid";
import type { Point } from "../src/protocol/messages";
import { contourInterval, contours, partOf } from "../src/start/contours";
import { descent } from "../src/start/descent";
import { barLength, fitted, groundAt, panned, pixelAt, zoomed, type MapView } from "../src/start/map_view";
import { gradient, slopeAt, slopeClass } from "../src/start/slope";
import { length } from "../src/state/shapes";

/** Heights at the centres of 2 m cells; west and south edge as of a national grid. */
function ground(columns: number, rows: number, height: (column: number, row: number) => number, cell = 2): Grid {
  const values = Float32Array.from({ length: columns * rows }, (_, k) => height(k % columns, Math.floor(k / columns)));
  return { west: 824000, south: 825000, cell, columns, rows, values };
}
const size = { width: 800, height: 500 };
const cone = ground(81, 81, (i, j) => 100 - 0.5 * 2 * Math.hypot(i - 40, j - 40));

describe("the view of a map", () => {
  const grid = ground(100, 80, () => 0);

  it("leads from a place to its pixel and back, at every zoom", () => {
    let view = fitted(grid, size);
    for (const factor of [1, 3, 2.5, 0.7]) {
      view = zoomed(view, size, grid, factor, [300, 200]);
      const [x, y] = groundAt(view, size, pixelAt(view, size, [824037.25, 825101.5]));
      expect([x, y]).toEqual([expect.closeTo(824037.25, 6), expect.closeTo(825101.5, 6)]);
    }
    expect(pixelAt(view, size, [view.x + 1, view.y])[0]).toBeGreaterThan(400);
    expect(pixelAt(view, size, [view.x, view.y + 1])[1]).toBeLessThan(250);
  });
  it("zooms around the pointer, from the whole terrain to a few cells", () => {
    const whole = fitted(grid, size);
    expect(whole.scale).toBeCloseTo(500 / 160, 9);
    const before = groundAt(whole, size, [300, 200]);
    const near = zoomed(whole, size, grid, 4, [300, 200]);
    expect(groundAt(near, size, [300, 200])).toEqual([expect.closeTo(before[0], 6), expect.closeTo(before[1], 6)]);
    expect(near.scale).toBeCloseTo(4 * whole.scale, 9);
    expect(zoomed(near, size, grid, 1e-3, [0, 0]).scale).toBeCloseTo(whole.scale, 9);
    expect(zoomed(near, size, grid, 1e6, [0, 0]).scale).toBeCloseTo(40, 9);
  });
  it("moves the ground with the pointer, and never off the map", () => {
    const near = zoomed(fitted(grid, size), size, grid, 8, [400, 250]);
    const place = groundAt(near, size, [400, 250]);
    expect(pixelAt(panned(near, grid, 30, -12), size, place)).toEqual([expect.closeTo(430, 6), expect.closeTo(238, 6)]);
    expect([panned(near, grid, 1e6, 1e6).x, panned(near, grid, 1e6, 1e6).y]).toEqual([824000, 825160]);
  });
  it("has a scale bar of 1, 2 or 5 times a power of ten that fits", () => {
    const bar = (metres_per_px: number): number => barLength({ x: 0, y: 0, scale: 1 / metres_per_px }, 120);
    expect([0.02, 0.1, 0.9, 1 / 1.2, 4, 4.2, 8.4, 20].map(bar)).toEqual([2, 10, 100, 100, 200, 500, 1000, 2000]);
  });
});

describe("contours", () => {
  it("are closed circles on a cone, at their heights, every fifth an index contour, higher ground on the left", () => {
    const lines = contours(cone, 5);
    const closed = lines.filter(({ level_m }) => level_m > 60 && level_m < 100);
    expect(closed.map(({ level_m }) => level_m).sort((a, b) => a - b)).toEqual([65, 70, 75, 80, 85, 90, 95]);
    for (const { level_m, points, index } of closed) {
      expect(points[0]).toEqual(points[points.length - 1]);
      expect(index).toBe(level_m % 25 === 0);
      expect(Math.max(...points.map(([x, y]) => Math.abs(Math.hypot(x - 824081, y - 825081) - 2 * (100 - level_m))))).toBeLessThan(0.15);
      // Around the summit anticlockwise.
      const turned = points.slice(1).reduce((sum, [x, y], k) => sum + (points[k][0] - 824081) * (y - 825081) - (x - 824081) * (points[k][1] - 825081), 0);
      expect(turned / 2).toBeCloseTo(Math.PI * (2 * (100 - level_m)) ** 2, -2);
    }
  });
  it("pass through no cell without data, and begin and end there", () => {
    const holed = ground(21, 21, (i, j) => (i >= 8 && i <= 12 && j >= 8 && j <= 12 ? NaN : 2 * i));
    const lines = contours(holed, 5);
    // Centres with data end at column 7 and begin again at column 13.
    const inHole = ([x, y]: Point): boolean => x > 824015.01 && x < 824026.99 && y > 825015.01 && y < 825026.99;
    expect(lines.flatMap(({ points }) => points).filter(inHole)).toEqual([]);
    const parts = lines.filter(({ level_m }) => level_m === 20);
    expect(parts.map(({ points }) => points.map(([x]) => x))).toEqual([Array(8).fill(824021), Array(8).fill(824021)]);
  });
  it("keep the two sides of a saddle apart", () => {
    // High in the north-east and the south-west; the middle of the square is low, then high.
    const saddle = (low: number): Grid => ground(2, 2, (i, j) => (i === j ? 10 : low), 10);
    expect(contours(saddle(0), 7).map(({ points }) => points.map(([x, y]) => Math.sign(x - 824010 + (y - 825010))))).toEqual([[-1, -1], [1, 1]]);
    expect(contours(saddle(6), 7).map(({ points }) => points.map(([x, y]) => Math.sign(x - 824010 - (y - 825010))))).toEqual([[1, 1], [-1, -1]]);
  });
  it("are every 1, 2 or 5 times a power of ten, closer the larger the map is", () => {
    expect([150, 400, 90, 12, 2600].map((relief) => contourInterval(relief, 1))).toEqual([10, 20, 5, 1, 200]);
    expect([1, 2, 5, 20, 1e6].map((zoom) => contourInterval(150, zoom))).toEqual([10, 5, 2, 0.5, 0.1]);
    expect(contourInterval(0, 1)).toBe(1);
  });
  it("of a part of the map lie where those of the whole do", () => {
    const part = partOf(cone, 824070, 825070, 824100, 825100, 3);
    expect([part.cell, part.columns < 30]).toEqual([4, true]);
    const off = contours(part, 5).flatMap(({ points, level_m }) => points.map(([x, y]) => Math.abs(Math.hypot(x - 824081, y - 825081) - 2 * (100 - level_m))));
    expect([off.length > 20, Math.max(...off) < 1]).toEqual([true, true]);
    const moved = partOf(cone, 824073, 825071, 824103, 825101, 3);
    expect([(moved.west - part.west) % 4, (moved.south - part.south) % 4]).toEqual([0, 0]);
  });
});

describe("slope", () => {
  const east = ground(20, 20, (i) => 2 * i * Math.tan(Math.PI / 6));

  it("is that of a plane, also at its edges and beside cells without data", () => {
    for (const [x, y] of [[824021, 825021], [824000.5, 825000.5], [824039.5, 825020]] as const) expect(slopeAt(east, x, y)).toBeCloseTo(30, 3);
    const oblique = ground(20, 20, (i, j) => 3 * i - 4 * j);
    expect(gradient(oblique, 7, 7)).toEqual([1.5, -2]);
    expect(slopeAt({ ...east, values: east.values.map((z, k) => (k === 20 * 10 + 11 ? NaN : z)) }, 824021, 825021)).toBeCloseTo(30, 3);
  });
  it("is none beyond the terrain and without data", () => {
    expect([slopeAt(east, 823999, 825020), slopeAt(east, 824041, 825020), slopeAt(ground(3, 3, () => NaN), 824003, 825003)]).toEqual([NaN, NaN, NaN]);
  });
  it("has classes that begin at 25, 35 and 45 degrees", () => {
    expect([0, 24.9, 25, 34.9, 35, 45, 80].map((deg) => slopeClass(deg).name)).toEqual(["below 25°", "below 25°", "25–35°", "25–35°", "35–45°", "above 45°", "above 45°"]);
  });
});

describe("the way downhill", () => {
  const heightsAlong = (grid: Grid, points: readonly Point[]): number[] => points.map(([x, y]) => grid.values[Math.floor((y - grid.south) / grid.cell) * grid.columns + Math.floor((x - grid.west) / grid.cell)]);
  const valley = ground(60, 41, (i, j) => 2 * i + 3 * Math.abs(j - 20));

  it("goes down the fall line into the valley and along it to the edge of the terrain", () => {
    const way = descent(valley, [824100.3, 825070.2]);
    const heights = heightsAlong(valley, way?.points ?? []);
    expect(way).toMatchObject({ end: "edge", hollow_m: 0 });
    expect(heights.filter((height, k) => height > heights[k - 1])).toEqual([]);
    expect(way?.points[0]).toEqual([824100.3, 825070.2]);
    expect(way?.points.at(-1)).toEqual([824001, 825041]);
  });
  it("ends at the bottom of a closed basin, and on level ground", () => {
    const basin = ground(41, 41, (i, j) => Math.hypot(i - 25, j - 18));
    expect(descent(basin, [824007, 825007])).toMatchObject({ end: "lowest", hollow_m: 0 });
    expect(descent(basin, [824007, 825007])?.points.at(-1)).toEqual([824051, 825037]);
    const shore = ground(41, 41, (i) => Math.max(0, i - 20));
    expect(descent(shore, [824071, 825041])?.points.at(-1)).toEqual([824041, 825041]);
  });
  it("crosses hollows where they spill onto lower ground, and says how deep they are", () => {
    const dammed = { ...valley, values: valley.values.slice() };
    // A dam across the valley 3 m above the ground behind it, with a notch of 2 m to one side.
    for (let j = 15; j <= 25; ++j) dammed.values[j * 60 + 20] += 5;
    const way = descent(dammed, [824100.3, 825070.2]);
    expect(way?.end).toBe("edge");
    expect(way?.points.at(-1)).toEqual([824001, 825041]);
    expect(way?.hollow_m).toBeCloseTo(3, 6);
    const straight = descent(valley, [824100.3, 825070.2]);
    expect(length(way?.points ?? [])).toBeLessThan(length(straight?.points ?? []) + 20);
  });
  it("does not zigzag between cells", () => {
    // A gully 20 degrees off the rows of cells: steps from cell to cell alone would be 8 % longer than it.
    const gully = ground(120, 80, (i, j) => i + 5 * Math.abs(j - 10 - i * Math.tan(Math.PI / 9)));
    const points = descent(gully, [824201, 825093])?.points ?? [];
    const [first, last] = [points[0], points[points.length - 1]];
    expect(points.length).toBeGreaterThan(60);
    expect(length(points) / Math.hypot(first[0] - last[0], first[1] - last[1])).toBeLessThan(1.03);
  });
  it("is none from ground without data", () => {
    expect(descent(ground(5, 5, () => NaN), [824005, 825005])).toBeNull();
    expect(descent(valley, [823999, 825005])).toBeNull();
  });
});

it("a view without size is not drawn", () => {
  const view: MapView = fitted(cone, { width: 0, height: 0 });
  expect(view.scale).toBe(0);
});
