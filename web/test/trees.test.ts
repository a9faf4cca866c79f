import { describe, expect, it } from "vitest";
import type { Zone } from "../src/protocol/messages";
import { treesOf } from "../src/scene/natural/trees";

const forest = (density: number, side = 100): Zone => ({ stem_density_pm2: density, stem_diameter_m: 0.3, area_m2: side * side - 400,
  polygons: [[[[0, 0], [side, 0], [side, side], [0, side]], [[40, 40], [60, 40], [60, 60], [40, 60]]]] }) as unknown as Zone;

describe("trees", () => {
  it("are as many as the zone has stems, none in a clearing, always at the same places", () => {
    const trees = treesOf([forest(0.05)]);
    expect(Math.abs(trees.length - 480)).toBeLessThan(40);
    for (const { x, y } of trees) {
      expect(x >= 0 && x <= 100 && y >= 0 && y <= 100).toBe(true);
      expect(x > 40 && x < 60 && y > 40 && y < 60).toBe(false);
    }
    expect(treesOf([forest(0.05)])).toEqual(trees);
  });
  it("stand farther apart where there would be too many, but everywhere", () => {
    const trees = treesOf([forest(0.2, 400)], 1000);
    expect(trees.length).toBeGreaterThan(800);
    expect(trees.length).toBeLessThanOrEqual(1000);
    expect(trees.filter(({ y }) => y > 300).length).toBeGreaterThan(150);
  });
  it("are not where there is no forest", () => expect(treesOf([forest(0)])).toEqual([]));
});
