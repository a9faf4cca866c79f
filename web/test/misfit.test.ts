import { describe, expect, it } from "vitest";
import type { CalibrationStatus, Parameter } from "../src/protocol/messages";
import { firstRange, MisfitScale, progressText, rangeProblem, runsAfterChoice, startsFree } from "../src/state/misfit";

const parameter = (key: string, value: number | null, low: number | null = 0, high: number | null = null): Parameter =>
  ({ key, label: key, unit: "", default: value, value, help: "", used_by_depth_averaged: !key.includes("viscosity"), range: { low, high, low_included: true, high_included: true } });
const run = (misfit: number | null) => ({ values: [0.3, 0.1], phase: "design" as const, misfit });
const status = (parts: Partial<CalibrationStatus>): CalibrationStatus => ({
  state: "running", why_not: null, by: "Ada", message: "", observations: [], parameters: [], phase: "design", runs_at_most: 40, runs_failed: 0,
  fast_runs: [], fast_runs_at_most: 0, wall_remaining_s: null, runs: [], map: null, best: null, result: null, ...parts,
});

describe("scale of misfits", () => {
  it("goes from the best to the worst of runs and map, and back", () => {
    const scale = MisfitScale.of({ runs: [run(3), run(null), run(900)], fast_runs: [], map: { columns: 2, rows: 1, misfit: [1, null] } });
    expect([scale.low, scale.high]).toEqual([1, 900]);
    expect([scale.share(1), scale.share(900), scale.share(5000)]).toEqual([0, 1, 1]);
    expect(scale.share(3)).toBeLessThan(0.15);
    for (const share of [0, 0.3, 1]) expect(scale.share(scale.at(share))).toBeCloseTo(share);
  });
  it("has ends where there is nothing, or one run", () => {
    expect(MisfitScale.of({ runs: [], fast_runs: [], map: null })).toMatchObject({ low: 0, high: 1 });
    expect(MisfitScale.of({ runs: [run(7)], fast_runs: [], map: null })).toMatchObject({ low: 7, high: 11 });
    expect(MisfitScale.of({ runs: [], fast_runs: [run(7)], map: null }), "before the first run of particles").toMatchObject({ low: 7, high: 11 });
  });
});

describe("ranges that are tried", () => {
  it("are those of the docs, or lie around the present value within what is allowed", () => {
    expect(firstRange(parameter("material.friction_coefficient", 0.4), null)).toEqual([0.1, 0.6]);
    expect(firstRange(parameter("material.friction_coefficient", 0.4), 0.9)).toEqual([0.45, 1.35]);
    expect(firstRange(parameter("material.rest_density_kgpm3", 2000, 100, 2500), null)).toEqual([1000, 2500]);
    expect(firstRange(parameter("material.cohesion_Pa", 0), null)).toEqual([0, 1]);
  });
  it("are of parameters that the model which searches has a use for", () => {
    const viscosity = parameter("material.viscosity", 0.1);
    expect([startsFree(viscosity, false), startsFree(viscosity, true)]).toEqual([true, false]);
    expect(startsFree(parameter("material.friction_coefficient", 0.4), true)).toBe(true);
  });
  it("leave a number of runs that was typed as it is", () => {
    expect(runsAfterChoice(true, 3, 10)).toBe(3);
    expect(runsAfterChoice(false, 40, 10)).toBe(10);
    expect(runsAfterChoice(true, NaN, 10)).toBe(10);
  });
  it("are refused in words", () => {
    const p = parameter("friction", 0.4, 0, 10);
    expect(rangeProblem(p, 0.1, 0.6)).toBeNull();
    expect(rangeProblem(p, 0.6, 0.1)).toContain("must be below");
    expect(rangeProblem(p, NaN, 0.1)).toContain("give a lowest");
    expect(rangeProblem(p, -1, 0.1)).toContain("at least 0");
    expect(rangeProblem(p, 1, 11)).toContain("at most 10");
  });
});

describe("how far it is", () => {
  it("says runs, phase and time", () => {
    expect(progressText(status({ runs: [run(1), run(null)], runs_failed: 1, wall_remaining_s: 200 })))
      .toBe("2 of at most 40 runs, 1 failed · spread over the ranges · about 3\u202fmin left at most");
    expect(progressText(status({ runs: [run(1)], runs_at_most: 10, fast_runs: Array.from({ length: 38 }, () => run(2)), fast_runs_at_most: 100 })))
      .toBe("38 of at most 100 runs depth-averaged, 1 of at most 10 runs of particles · spread over the ranges");
    expect(progressText(status({ state: "cancelled", runs: [run(1)] }))).toBe("Cancelled after 1 run");
    expect(progressText(status({ state: "cancelled", fast_runs: [run(1), run(2)], fast_runs_at_most: 100 }))).toBe("Cancelled after 0 runs of particles and 2 depth-averaged");
    expect(progressText(status({ state: "failed", message: "disk full" }))).toContain("disk full");
    expect(progressText(status({ state: "idle" }))).toBe("");
  });
});
