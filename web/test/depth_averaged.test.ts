import { describe, expect, it } from "vitest";
import type { DepthAveragedComparison, DepthAveragedRow, DepthAveragedStatus } from "../src/protocol/messages";
import { depthAveragedLayer, infoOf, isDepthAveragedLayer, isEnsembleLayer, layerInfo, quantityOf } from "../src/scene/layers";
import { agreementText, comparedTable, isOn, sourceText, statusText } from "../src/state/depth_averaged";

const row: DepthAveragedRow = { key: "front_velocity", name: "Front velocity at 30 m", unit: "m/s", decimals: 1, particles: 8.04, depth_averaged_by_then: null, depth_averaged: 6.96, observed: 7 };
const compared: DepthAveragedComparison = { time_s: 12.34, over: false, rows: [row], least_depth_m: 0.1, differs: [],
  area: { both_m2: 70, particles_only_m2: 20, depth_averaged_only_m2: 10, intersection_over_union: 0.7 } };
const result: NonNullable<DepthAveragedStatus["result"]> = { end_s: 61.2, complete: true, stop_reason: "debris came to rest", verdict: { within_limits: true, text: "Within limits", warnings: [], checks: [] }, wall_time_s: 2.44, processor_time_s: 2.5, grid_cell_m: 2.5, hash: "1", notes: [],
  front: { chainage_m: [], arrival_time_s: [], front_velocity_mps: [] } };
const status: DepthAveragedStatus = { scenario: "A", state: "done", message: "", share: null, result };

describe("figures of both models", () => {
  it("while particles move, the other model stands beside them by the same time and as a whole", () => {
    expect(comparedTable(compared).heads).toEqual(["Particles by 12.3 s", "Depth-averaged by 12.3 s", "Depth-averaged, whole run", "Observed"]);
    expect(comparedTable(compared).rows[0].values).toEqual(["8.0", "–", "7.0", "7.0"]);
    expect(agreementText(compared)).toMatch(/^Agreement of the affected area by 12.3 s: 70 % .*deeper than 0.100.m/);
  });
  it("once their run is over, both are compared as a whole", () => {
    const over = { ...compared, over: true, rows: [{ ...row, observed: null }] };
    expect(comparedTable(over).heads).toEqual(["Particles", "Depth-averaged"]);
    expect(comparedTable(over).rows[0].values).toEqual(["8.0", "7.0"]);
    expect(agreementText({ ...over, area: { ...over.area, intersection_over_union: null } })).toMatch(/^Neither model/);
  });
});

describe("what is said of the model", () => {
  it("is how far it is, its cost, or why there is none", () => {
    expect([isOn(null), isOn({ ...status, state: "off" }), isOn(status)]).toEqual([false, false, true]);
    expect(statusText(null)).toBe("");
    expect(statusText({ ...status, state: "running", share: 0.4, result: null })).toBe("Computing: 40 % of the time.");
    expect(statusText({ ...status, state: "refused", message: "It has no nets.", result: null })).toBe("It has no nets.");
    expect(statusText(status)).toMatch(/^Computed in 2.4.s on cells of 2.5.m: 61 s of the present setup/);
    expect(statusText({ ...status, result: { ...result, complete: false, stop_reason: "ended after 300 s" } })).toContain("not complete: ended after 300 s");
    expect(sourceText(status)).toBe("Depth-averaged model, whole run of 61 s");
    expect(sourceText({ ...status, state: "waiting", result: null })).toBe("Depth-averaged model: Waiting to be computed.");
  });
});

describe("maps of the model", () => {
  it("have the colours and the unit of those of the particles, and their own name", () => {
    expect(depthAveragedLayer("erosion_depth")).toBeNull();
    const name = depthAveragedLayer("peak_depth");
    if (name === null) throw new Error("no map of peak depth");
    expect([isDepthAveragedLayer(name), isEnsembleLayer(name), quantityOf(name), quantityOf("peak_speed")]).toEqual([true, false, "peak_depth", "peak_speed"]);
    const info = infoOf(name, []);
    expect([info.ramp, info.unit]).toEqual([layerInfo.peak_depth.ramp, "m"]);
    expect(info.title).toBe("Peak depth, depth-averaged");
    expect(info.help).not.toContain("so far");
  });
});
