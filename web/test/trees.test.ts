import { describe, expect, it } from "vitest";
import type { Point } from "../src/protocol/messages";
import { Relief } from "../src/scene/relief";
import { treesOf, type Planted } from "../src/scene/natural/forest";

/** 400 m by 400 m, of cells of 2 m. */
const ground = (height: (x: number, y: number) => number): Relief => {
  const side = 200;
  const values = Float32Array.from({ length: side * side }, (_, k) => height(2 * (k % side) + 1, 2 * Math.floor(k / side) + 1));
  return new Relief({ west: 0, south: 0, cell: 2, columns: side, rows: side, values }, [0, 0, 0]);
};
const flat = ground(() => 50);
const square = (left: number, low: number, side: number): Point[] => [[left, low], [left + side, low], [left + side, low + side], [left, low + side]];
const forest = (density: number, side = 100, left = 0): unknown => ({ stem_density_pm2: density, stem_diameter_m: 0.3, area_m2: side * side - 400,
  polygons: [[square(left, 0, side), square(left + 40, 40, 20)]] });
const setup = (zones: unknown[], others: object = {}): Planted => ({ zones, releases: [], barriers: [], buildings: [], ...others }) as unknown as Planted;
const within = (x: number, y: number, left: number, low: number, side: number): boolean => x > left && x < left + side && y > low && y < low + side;

describe("trees", () => {
  it("are as many as the zone has stems, none in a clearing, always at the same places", () => {
    const trees = treesOf(setup([forest(0.05)]), flat);
    expect(Math.abs(trees.length - 480)).toBeLessThan(40);
    for (const { x, y, height } of trees) {
      expect(within(x, y, 0, 0, 100)).toBe(true);
      expect(within(x, y, 40, 40, 20)).toBe(false);
      expect(height).toBeGreaterThan(8);
      expect(height).toBeLessThan(16);
    }
    expect(treesOf(setup([forest(0.05)]), flat)).toEqual(trees);
  });
  it("stand in the blocks of a zone from a raster, as in outlines of the same ground", () => {
    const blocks = [[0, 0, 100, 40], [0, 40, 40, 20], [60, 40, 40, 20], [0, 60, 100, 40]];
    const raster = { ...(forest(0.05) as object), polygons: [], blocks };
    const places = (zone: unknown): string[] => treesOf(setup([zone]), flat).map(({ x, y }) => `${x} ${y}`);
    expect(places(raster)).toEqual(places(forest(0.05)));
    expect(places({ ...raster, blocks: [] })).toEqual([]);
  });
  it("stay where they are as the zone grows", () => {
    const larger = new Set(treesOf(setup([forest(0.05, 140)]), flat).map(({ x, y }) => `${x} ${y}`));
    expect(treesOf(setup([forest(0.05)]), flat).every(({ x, y }) => within(x, y, 40, 40, 20) || larger.has(`${x} ${y}`))).toBe(true);
  });
  it("stand farther apart where there would be too many, but everywhere", () => {
    const trees = treesOf(setup([forest(0.2, 400)]), flat, 1000);
    expect(trees.length).toBeGreaterThan(800);
    expect(trees.length).toBeLessThanOrEqual(1000);
    expect(trees.filter(({ y }) => y > 300).length).toBeGreaterThan(150);
  });
  it("leave houses, barriers and releases, with room for their crowns; a courtyard may have some", () => {
    const all = treesOf(setup([forest(0.05)]), flat);
    const trees = treesOf(setup([forest(0.05)], {
      buildings: [{ polygons: [[square(5, 5, 30), square(10, 10, 20)]] }],
      barriers: [{ line: [[62, 62], [98, 62], [98, 98]], thickness_m: 2 }],
      releases: [{ polygons: [[square(5, 65, 30)]] }],
    }), flat);
    const built = ({ x, y }: { x: number; y: number }): boolean => within(x, y, 5, 5, 30) && !within(x, y, 10, 10, 20);
    expect(all.filter(built).length).toBeGreaterThan(5);
    expect(trees.filter(built)).toEqual([]);
    expect(trees.filter(({ x, y }) => within(x, y, 10, 10, 20)).length).toBeGreaterThan(3);
    expect(all.filter(({ x, y }) => within(x, y, 4, 64, 32)).length).toBeGreaterThan(20);
    expect(trees.filter(({ x, y }) => within(x, y, 4, 64, 32))).toEqual([]);
    const onWall = ({ x, y }: { x: number; y: number }): boolean => Math.abs(y - 62) < 2 && x > 62 && x < 99;
    expect(all.filter(onWall).length).toBeGreaterThan(1);
    expect(trees.filter(onWall)).toEqual([]);
    // What a bent barrier goes round is forest.
    expect(trees.filter(({ x, y }) => within(x, y, 82, 66, 11)).length).toBeGreaterThan(2);
  });
  it("do not stand on ground steeper than 55 degrees, beyond the terrain, or where it has no data", () => {
    const cliff = ground((x, y) => (y > 80 && x > 60 ? NaN : x < 50 ? 0 : 1.6 * (x - 50)));
    const trees = treesOf(setup([forest(0.05)]), cliff);
    expect(trees.filter(({ x }) => x < 48).length).toBeGreaterThan(150);
    expect(trees.filter(({ x }) => x > 54)).toEqual([]);
    const hill = ground((x, y) => (y > 80 && x > 60 ? NaN : x < 50 ? 0 : 1.2 * (x - 50)));
    expect(treesOf(setup([forest(0.05)]), hill).filter(({ x, y }) => x > 52 && y < 78).length).toBeGreaterThan(100);
    expect(treesOf(setup([forest(0.05)]), hill).filter(({ x, y }) => x > 62 && y > 82)).toEqual([]);
    const beyond = treesOf(setup([forest(0.05, 100, 350)]), flat);
    expect(beyond.length).toBeGreaterThan(150);
    expect(beyond.every(({ x }) => x <= 400)).toBe(true);
  });
  it("are those of the later forest where two lie over one another", () => {
    const one = treesOf(setup([forest(0.01)]), flat);
    expect(treesOf(setup([forest(0.05), forest(0.01)]), flat)).toEqual(one);
    expect(treesOf(setup([forest(0.01), forest(0), forest(0.01, 100, 200)]), flat).length).toBeGreaterThan(1.8 * one.length);
  });
  it("are not where there is no forest", () => expect(treesOf(setup([forest(0)]), flat)).toEqual([]));
});
