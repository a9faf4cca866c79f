import { describe, expect, it } from "vitest";
import { joined } from "../src/charts/chart";
import { frameDepthAt, sectionStations } from "../src/charts/section";
import type { Frame } from "../src/protocol/frame";
import type { Grid } from "../src/protocol/grid";
import type { Point, SceneInfo } from "../src/protocol/messages";
import { Relief } from "../src/scene/relief";
import { band } from "../src/scene/solids";
import { bytes, count, decimalsFor, fixed, number, quantity, tick, unitText } from "../src/state/format";
import { area, footprintArea, crossesItself, inside, length, releaseVolume } from "../src/state/shapes";

/** A plane that rises by `slope` to the east, 100 x 100 cells of 1 m in national coordinates. */
function plane(slope: number): Relief {
  const values = new Float32Array(100 * 100);
  for (let j = 0; j < 100; ++j) for (let i = 0; i < 100; ++i) values[100 * j + i] = 50 + slope * (i + 0.5);
  const grid: Grid = { west: 824000, south: 825000, cell: 1, columns: 100, rows: 100, values };
  return new Relief(grid, [824050, 825050, 50]);
}
const box: Point[] = [[824020, 825020], [824040, 825020], [824040, 825050], [824020, 825050]];

describe("shapes", () => {
  it("area and length keep their digits in national coordinates", () => {
    expect(area(box)).toBe(600);
    expect(area([...box].reverse())).toBe(600);
    expect(length(box)).toBe(70);
    expect(inside(box, 824030, 825030)).toBe(true);
    expect(inside(box, 824045, 825030)).toBe(false);
  });
  it("volume is area times thickness over the cosine of the slope", () => {
    expect(releaseVolume(box, 2, plane(0))).toBeCloseTo(1200, 6);
    expect(releaseVolume(box, 2, plane(1))).toBeCloseTo(1200 * Math.SQRT2, 3);
    expect(releaseVolume(box.slice(0, 2), 2, plane(0))).toBe(0);
  });
  it("notices an outline that crosses itself", () => {
    expect(crossesItself(box)).toBe(false);
    expect(crossesItself([box[0], box[2], box[1], box[3]])).toBe(true);
  });
  it("a wall has its thickness, also after a corner", () => {
    const [left, right] = band([[0, 0], [10, 0], [10, 10]], 2);
    expect(left[0]).toEqual([0, 1]);
    expect(right[0]).toEqual([0, -1]);
    expect(left[1][0]).toBeCloseTo(9);
    expect(left[1][1]).toBeCloseTo(1);
    expect(right[2]).toEqual([11, 10]);
  });
});

describe("relief", () => {
  it("is read between cells and held at the edges", () => {
    const relief = plane(0.5);
    expect(relief.at(824010, 825010)).toBeCloseTo(55, 4);
    expect(relief.at(823000, 825010)).toBeCloseTo(50.25, 4);
    expect(relief.local(824050, 825050, 2)).toEqual([0, 0, 27]);
  });
  it("finds where a ray meets the ground", () => {
    const relief = plane(0.5);
    const met = relief.meet([0, 0, 100], [0.1 / Math.hypot(0.1, 1), 0, -1 / Math.hypot(0.1, 1)]);
    expect(met).not.toBeNull();
    const [x, , z] = met ?? [0, 0, 0];
    expect(z).toBeCloseTo(50 + 0.5 * (x - 824000), 2);
    expect(x - 824050).toBeCloseTo(0.1 * (150 - z), 1);
    expect(relief.meet([0, 0, 100], [0, 0, 1])).toBeNull();
  });
  it("sees the same sky where only every second cell is looked at", () => {
    const wave = (columns: number, rows: number): Float32Array => {
      const values = new Float32Array(columns * rows);
      for (let k = 0; k < values.length; ++k) values[k] = 6 * Math.sin((k % columns) / 8) + 4 * Math.cos(Math.floor(k / columns) / 11);
      return values;
    };
    const large = new Relief({ west: 0, south: 0, cell: 1, columns: 301, rows: 200, values: wave(301, 200) }, [0, 0, 0]).skyView();
    const small = new Relief({ west: 0, south: 0, cell: 1, columns: 301, rows: 160, values: wave(301, 160) }, [0, 0, 0]).skyView();
    for (const [i, j] of [[40, 40], [41, 40], [40, 41], [41, 41], [200, 77], [99, 58]]) {
      expect(Math.abs(large[j * 301 + i] - small[j * 301 + i])).toBeLessThan(0.03);
    }
    expect(large[large.length - 1]).toBeGreaterThan(0.3);
  });
  it("a pit sees less sky than a plain", () => {
    const values = new Float32Array(400);
    for (let k = 0; k < 400; ++k) values[k] = Math.hypot((k % 20) - 10, Math.floor(k / 20) - 10);
    const sky = new Relief({ west: 0, south: 0, cell: 1, columns: 20, rows: 20, values }, [0, 0, 0]).skyView();
    expect(sky[10 * 20 + 10]).toBeLessThan(0.6);
    expect(plane(0).skyView()[50]).toBe(1);
  });
});

describe("cross-section", () => {
  it("has stations from end to end, also around a corner", () => {
    const stations = sectionStations([[0, 0], [10, 0], [10, 5]], 16);
    expect(stations[0]).toEqual({ along: 0, at: [0, 0] });
    expect(stations[15].at[0]).toBeCloseTo(10);
    expect(stations[15].at[1]).toBeCloseTo(5);
    expect(stations[10].at[0]).toBeCloseTo(10);
  });
  it("reads depth from the frame's window", () => {
    const scene = { map: { x_min_m: 100, y_min_m: 200, cell_m: 2, columns: 50, rows: 50 } } as SceneInfo;
    const frame = { window: { column: 10, row: 20, columns: 2, rows: 1 }, depth: Uint16Array.of(1000, 3000), depthUnit_m: 0.001 } as Frame;
    expect(frameDepthAt(frame, scene, 121, 241)).toBeCloseTo(1);
    expect(frameDepthAt(frame, scene, 122, 241)).toBeCloseTo(2);
    expect(frameDepthAt(frame, scene, 122, 242)).toBeCloseTo(1);
    expect(frameDepthAt(frame, scene, 300, 242)).toBe(0);
  });
  it("joins curves that have their own abscissa", () => {
    expect(joined([{ x: [0, 2], y: [5, 6] }, { x: [1, 2, null], y: [7, null, 9] }])).toEqual([[0, 1, 2], [5, null, 6], [null, 7, null]]);
  });
});

describe("numbers and units", () => {
  it("are written with units, thin spaces and true minus signs", () => {
    expect(quantity(12345.6, "m3", 3)).toBe("12\u202f346\u202fm³");
    expect(quantity(0.04567, "m/s")).toBe("0.0457\u202fm/s");
    expect(quantity(null, "m")).toBe("–");
    expect(number(-3.14159)).toBe("\u22123.14");
    expect(fixed(-0.5, 1)).toBe("\u22120.5");
    expect(decimalsFor(0.0112, 1)).toBe(4);
    expect(decimalsFor(2.47, 0)).toBe(2);
    expect([0, 10, 612.3, NaN].map((size) => decimalsFor(size, 1))).toEqual([1, 1, 1, 1]);
    expect(unitText("kg/m3")).toBe("kg/m³");
    expect(unitText("m2/s")).toBe("m²/s");
    expect(count(5673)).toBe("5\u202f673");
    expect([0, 5, 2.5, 100, 0.25].map(tick)).toEqual(["0", "5", "2.5", "100", "0.25"]);
    expect(bytes(2_340_000)).toBe("2.34\u202fMB");
  });
});

describe("a footprint of several parts", () => {
  it("has the area of all of them without their courtyards", () => {
    const square = (west: number, side: number): [number, number][] => [[west, 0], [west + side, 0], [west + side, side], [west, side]];
    expect(footprintArea([[square(0, 10), square(2, 3)], [square(20, 4)]])).toBeCloseTo(100 - 9 + 16);
  });
});
