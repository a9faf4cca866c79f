import { describe, expect, it } from "vitest";
import type { Place } from "../src/protocol/messages";
import { Relief } from "../src/scene/relief";
import type { Planted } from "../src/scene/natural/forest";
import { Trees } from "../src/scene/natural/trees";
import { hidesDebris, type Behind } from "../src/scene/natural/veil";

const flat = (): number => 0;
/** Debris 1 m deep in a strip to the north of y. */
const strip = (from: number, to: number) => (_: number, y: number): number => (y > from && y < to ? 1 : 0);
const tree = (x: number, y: number) => ({ foot: [x, y, 0] as Place, height: 15 });

describe("the crown of a tree before debris", () => {
  const eye: Place = [0, -100, 20];
  it("is thinned where the sight of the debris passes through it, not where there is none", () => {
    expect(hidesDebris(tree(0, 0), eye, { ground: flat, depth: strip(10, 30) })).toBe(true);
    expect(hidesDebris(tree(0, 0), eye, { ground: flat, depth: () => 0 })).toBe(false);
    expect(hidesDebris(tree(0, 0), eye, { ground: flat, depth: strip(-40, -10) })).toBe(false);
  });
  it("stays whole where debris is seen over it or below its branches", () => {
    expect(hidesDebris(tree(0, 0), [0, -100, 400], { ground: flat, depth: strip(10, 30) })).toBe(false);
    // Debris high up on the slope behind it.
    expect(hidesDebris(tree(0, 0), eye, { ground: (_, y) => y, depth: strip(40, 60) })).toBe(false);
    // Close behind the stem, seen from low.
    expect(hidesDebris(tree(0, 0), [0, -100, 1], { ground: flat, depth: strip(2, 6) })).toBe(false);
  });
  it("stays whole beside the sight, and where the debris is next to none", () => {
    expect(hidesDebris(tree(60, 0), eye, { ground: flat, depth: (x, y) => (Math.abs(x) < 5 && y > 10 && y < 30 ? 1 : 0) })).toBe(false);
    expect(hidesDebris(tree(0, 0), eye, { ground: flat, depth: () => 0.05 })).toBe(false);
  });
});

describe("the crowns of a forest", () => {
  it("are looked at once they are drawn, if debris moved while they were not", () => {
    const relief = new Relief({ west: 0, south: 0, cell: 2, columns: 50, rows: 50, values: new Float32Array(2500) }, [0, 0, 0]);
    const trees = new Trees({}, 0.5);
    trees.plant({ zones: [{ stem_density_pm2: 0.02, stem_diameter_m: 0.3, area_m2: 10_000, polygons: [[[[0, 0], [100, 0], [100, 100], [0, 100]]]] }],
      releases: [], barriers: [], buildings: [] } as unknown as Planted, relief);
    trees.stand(relief);
    const eye: Place = [50, -100, 20];
    const dry: Behind = { ground: flat, depth: () => 0 };
    const wet: Behind = { ground: flat, depth: () => 1 };
    const thinned = (): number => trees.meshes.reduce((sum, { geometry }) => sum + [...geometry.getAttribute("aVeil").array].filter((veil) => veil === 1).length, 0);
    trees.show(true, 1);
    expect(trees.veil(eye, dry, true)).toBe(false);
    expect(thinned()).toBe(0);
    trees.show(false, 1);
    expect(trees.veil(eye, wet, true)).toBe(false);
    expect(thinned()).toBe(0);
    trees.show(true, 1);
    trees.veil(eye, wet, false);
    expect(thinned()).toBeGreaterThan(50);
    trees.dispose();
  });
});
