import { describe, expect, it } from "vitest";
import { hindranceOf, leastOf, limitsOf } from "../src/state/rules";

const scene = { particle_spacing_m: 1.25, settings: { "solver.internal_friction": "stress" } };
const pairs = { ...scene, settings: { "solver.internal_friction": "pair" } };

describe("rules of the field table", () => {
  it("raise what a value must be at least with the particle spacing, and say why", () => {
    expect(leastOf("barrier_opening", "width_m", scene)).toBe(2.5);
    const thickness = limitsOf("barrier", "thickness_m", scene, {});
    expect(thickness.low).toBe(0.625);
    expect(thickness.hint).toBe("Minimum 0.625 m; thinner walls let debris interact across them.");
    expect(thickness.hindrance).toBeNull();
    expect(limitsOf("barrier", "thickness_m", { ...scene, particle_spacing_m: 1e-5 }, {}).low).toBeCloseTo(0.001, 9);
  });
  it("keep a gap below the crest, where that is a height", () => {
    expect(limitsOf("barrier", "clearance_m", scene, { height_m: 3 })).toMatchObject({ low: 1.25, high: 2.999, hindrance: null });
    expect(limitsOf("barrier", "clearance_m", scene, { height_m: 3 }).hint).toMatch(/Below height, 3\.00\u202fm\.$/);
    expect(limitsOf("barrier", "clearance_m", scene, { height_m: null }).high).toBe(100);
  });
  it("say what a value is nothing without", () => {
    expect(hindranceOf("material", "cohesion_Pa", scene)).toBeNull();
    expect(hindranceOf("material", "cohesion_Pa", pairs)).toBe('Needs solver.internal_friction = "stress": friction by pairs has no such law.');
    expect(limitsOf("zone", "cohesion_Pa", pairs, {}).hindrance).toMatch(/^Needs solver/);
    expect(limitsOf("zone", "friction_coefficient", pairs, {})).toMatchObject({ hindrance: null, hint: null, low: 0, high: 10 });
  });
});
