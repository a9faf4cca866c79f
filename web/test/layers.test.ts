import { describe, expect, it } from "vitest";
import type { Grid } from "../src/protocol/grid";
import type { Ensemble, EnsembleMap } from "../src/protocol/messages";
import { divergingAt, hex, lightness, rampAt, ramps, roundStep } from "../src/scene/colour";
import { colourOf, differenceOf, ensembleLayer, ensembleTitle, findMap, infoOf, inUnit, layerInfo, rangeOfMap, scaleEnd, shownOfMap, shownValues } from "../src/scene/layers";

const grid = (...values: number[]): Grid => ({ west: 0, south: 0, cell: 1, columns: values.length, rows: 1, values: Float32Array.from(values) });

describe("colour ramps", () => {
  it.each([...Object.entries(ramps), ...Object.entries(layerInfo).map(([name, layer]) => [name, layer.ramp] as const)])("%s: lightness goes one way, in even steps", (_, ramp) => {
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
  it("pressures come in Pa and are shown in kPa", () => {
    expect([...inUnit("peak_pressure", grid(2500, NaN)).values]).toEqual([2.5, NaN]);
    expect([...inUnit("peak_speed", grid(2500)).values]).toEqual([2500]);
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

describe("maps of an ensemble", () => {
  const map = (name: string, kind: "probability" | "percentile", greatest: number | null = 80): EnsembleMap =>
    ({ name, title: `Title of ${name}`, unit: kind === "probability" ? "%" : "m", kind, of: "peak_depth" as const, description: "", threshold: 0.5, threshold_unit: "m", percentile: 95, categories: [], greatest });
  const ensemble: Ensemble = { id: "2", name: "wet", runs: 64, failed: 1, factors: [{ key: "material.viscosity", distribution: "uniform from 0 to 1" }],
    same_terrain: true, maps: [map("probability_depth_0.5m", "probability"), map("peak_depth_p95", "percentile", null)] };
  const name = ensembleLayer(ensemble, ensemble.maps[0]);

  it("are found by their key, with title, unit, and what they are of", () => {
    expect(name).toBe("ensemble/2/probability_depth_0.5m");
    expect(findMap([ensemble], name)?.map).toBe(ensemble.maps[0]);
    expect(findMap([], name)).toBeNull();
    expect(ensembleTitle(ensemble)).toBe("wet, 64 runs, 1 failed");
    expect(infoOf(name, [ensemble])).toMatchObject({ title: "Title of probability_depth_0.5m", unit: "%", from: "wet, 64 runs, 1 failed", ramp: ramps.probability });
    expect(infoOf(ensembleLayer(ensemble, ensemble.maps[1]), [ensemble])).toMatchObject({ ramp: layerInfo.peak_depth.ramp, from: "wet, 64 runs, 1 failed: nowhere" });
    expect(infoOf(name, [{ ...ensemble, same_terrain: false }]).from).toContain("other terrain");
    expect(infoOf("peak_speed", []).title).toBe("Peak speed");
  });
  it("of an intensity say what they count, and zones have a colour per class", () => {
    const odds: EnsembleMap = { ...map("probability_intensity_high", "probability"), title: "Probability of high intensity", of: "intensity", threshold: null, threshold_unit: null };
    const zones: EnsembleMap = { ...odds, name: "hazard_zones", title: "Hazard zones", unit: "", kind: "zones", description: "hazard zones, a matrix: 1 low, 2 high",
      categories: [{ name: "low", colour: "#f5dc46" }, { name: "high", colour: "#c81e28" }] };
    const both = [{ ...ensemble, maps: [odds, zones] }];
    expect(infoOf(ensembleLayer(both[0], odds), both)).toMatchObject({ ramp: ramps.probability, help: expect.stringContaining("with high intensity") });
    const info = infoOf(ensembleLayer(both[0], zones), both);
    expect(info.help).toContain("1 low, 2 high");
    expect(rangeOfMap(zones, Float32Array.of(1, 2))).toEqual([0.5, 2.5]);
    expect([0, 0.25, 0.49, 0.51, 1].map((s) => hex(colourOf(info, s)))).toEqual(["#f5dc46", "#f5dc46", "#f5dc46", "#c81e28", "#c81e28"]);
    expect([...shownOfMap(zones, grid(NaN, 1, 2, NaN))]).toEqual([NaN, 1, 2, NaN]);
  });
  it("probabilities have one scale, and places that no run reached are left out", () => {
    const values = shownOfMap(ensemble.maps[0], grid(0, NaN, 12.5, 100));
    expect([...values]).toEqual([NaN, NaN, 12.5, 100]);
    expect(rangeOfMap(ensemble.maps[0], values)).toEqual([0, 100]);
    expect(rangeOfMap(ensemble.maps[1], Float32Array.of(1.7))).toEqual([0, 2]);
  });
});
