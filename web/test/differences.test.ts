import { describe, expect, it } from "vitest";
import type { Figure, Parameter, Setup } from "../src/protocol/messages";
import { comparisonRows, differenceText, type Side } from "../src/state/comparison";
import { changesText, differences } from "../src/state/differences";

const parameter = (key: string, label: string, unit = ""): Parameter =>
  ({ key: `material.${key}`, label, unit, default: null, value: null, range: { low: null, high: null, low_included: true, high_included: true }, used_by_depth_averaged: true, help: "" });
const parameters = [parameter("friction_coefficient", "friction coefficient"), parameter("building_friction_coefficient", "building friction coefficient"),
  parameter("cohesion_kPa", "cohesion", "kPa")];
const setup = (scenario: "A" | "B", friction: number, more: Partial<Setup> = {}): Setup => ({ scenario, name: "", changes: [], revision: 1,
  parameters: { "material.friction_coefficient": friction, "material.building_friction_coefficient": friction, "material.cohesion_kPa": 0 },
  releases: [], barriers: [], buildings: [], zones: [], beds: [], inflows: [], gauges: [], notes: [], observations: [], triggers: [], alarms: [], pending_restart: false, undo: null, redo: null, ...more });
const barrier = (id: string, height_m: number, name = id): Setup["barriers"][number] => ({ id, name, height_m }) as Setup["barriers"][number];

describe("differences of two scenarios", () => {
  it("names values that differ, but not those that follow another", () => {
    expect(differences(setup("A", 0.4), setup("B", 0.27), parameters)).toEqual(["friction 0.27"]);
    const rough = setup("B", 0.4);
    rough.parameters["material.building_friction_coefficient"] = 0.1;
    rough.parameters["material.cohesion_kPa"] = 2;
    expect(differences(setup("A", 0.4), rough, parameters)).toEqual(["building friction 0.1", "cohesion 2\u202fkPa"]);
  });
  it("lists every parameter that differs in the table, also one that follows another", () => {
    const side = (of: Setup): Side => ({ setup: of, figures: [], impacts: null, gauges: [], points: [] });
    expect(comparisonRows(side(setup("A", 0.4)), side(setup("B", 0.27)), parameters).map(({ name, a, b }) => [name, a, b]))
      .toEqual([["friction coefficient", 0.4, 0.27], ["building friction coefficient", 0.4, 0.27]]);
  });
  it("tells values of what both have, of neither that it was changed", () => {
    const release = (thickness_m: number, x: number): Setup["releases"][number] =>
      ({ id: "release-1", name: "main failure", thickness_m, volume_m3: 100, polygons: [[[[x, 0], [9, 0], [9, 9]]]] }) as unknown as Setup["releases"][number];
    const [a, b] = [setup("A", 0.4, { releases: [release(1.5, 0)] }), setup("B", 0.4, { releases: [release(2, 0)] })];
    expect(differences(a, b, parameters)).toEqual(["main failure thickness 2.00\u202fm"]);
    expect(differences(b, a, parameters)).toEqual(["main failure thickness 1.50\u202fm"]);
    const moved = setup("B", 0.4, { releases: [release(1.5, 1)] });
    expect(differences(a, moved, parameters)).toEqual(["main failure differs"]);
    expect(differences(moved, a, parameters)).toEqual(["main failure differs"]);
  });
  it("names what was added and removed; another name is no difference", () => {
    const a = setup("A", 0.4, { barriers: [barrier("barrier-1", 3), barrier("barrier-2", 3, "net")] });
    expect(differences(a, { ...a, scenario: "B", barriers: [barrier("barrier-1", 4), barrier("barrier-3", 1)] }, parameters))
      .toEqual(["barrier-3", "no net", "barrier-1 height 4.00\u202fm"]);
    expect(differences(a, { ...a, scenario: "B", barriers: [barrier("barrier-1", 3, "dam"), barrier("barrier-2", 3)] }, parameters)).toEqual([]);
  });
  it("of many changes tells the last ones", () => {
    const change = (time_s: number): Setup["changes"][number] => ({ time_s, by: "Ada", sentence: `step ${time_s}` });
    expect(changesText(setup("A", 0.4, { changes: [1, 2, 3, 4].map(change) }))).toBe("2 changes from 1.0 s; step 3 at 3.0 s; step 4 at 4.0 s");
  });
  it("says when a run was changed on the way", () => {
    expect(changesText(setup("A", 0.4))).toBe("");
    expect(changesText(setup("A", 0.27, { changes: [{ time_s: 30.31, by: "Ada", sentence: "friction coefficient 0.4 -> 0.27" }] })))
      .toBe("friction coefficient 0.4 -> 0.27 at 30.3 s");
  });
});

describe("gauges in the table", () => {
  const side = (arrival_s: number | null, peak_depth_m: number): Side => ({ setup: null, figures: [], impacts: null, points: [],
    gauges: [{ name: "bridge", arrival_s, depth_m: 0, speed_mps: 0, peak_depth_m, peak_speed_mps: 3 * peak_depth_m },
      { name: "dry", arrival_s: null, depth_m: 0, speed_mps: 0, peak_depth_m: 0, peak_speed_mps: 0 }] });
  it("have arrival and peaks of both; those that debris reached in neither are left out", () => {
    expect(comparisonRows(side(12, 2), side(null, 0), [])).toEqual([
      { group: "Gauges", name: "bridge, arrival", unit: "s", a: 12, b: null },
      { group: "Gauges", name: "bridge, peak depth", unit: "m", a: 2, b: 0 },
      { group: "Gauges", name: "bridge, peak speed", unit: "m/s", a: 6, b: 0 }]);
  });
});

describe("rows of a time of the recording", () => {
  it("say so, while figures and points are of the runs so far", () => {
    const side = (depth_m: number): Side => ({ setup: null, figures: [{ key: "k", name: "Run-out", value: 10, format: "", unit: "m", note: "", kind: "result" } as unknown as Figure],
      impacts: null, points: [{ name: "point 1", depth_m, speed_mps: null, pressure_kPa: null }],
      gauges: [{ name: "bridge", arrival_s: 1, depth_m: 0, speed_mps: 0, peak_depth_m: 2, peak_speed_mps: 3 }] });
    expect([...new Set(comparisonRows(side(1), side(2), [], 20).map((row) => row.group))]).toEqual(["Key figures", "Gauges, until 20.0 s", "Points"]);
  });
});

describe("a difference in the table", () => {
  const text = (a: number | null, b: number | null): string => differenceText({ group: "", name: "", unit: "m", a, b });
  it("has no more decimals than the values beside it", () => {
    expect(text(1.2271, 1.22116)).toBe("−0.01");
    expect(text(227.4, 230.9)).toBe("+4");
    expect(text(0.205, 0.25)).toBe("+0.045");
    expect(text(0, 0.00594)).toBe("+0.00594");
    expect(text(3, 2.5)).toBe("−0.5");
  });
  it("is that of the values as they are shown", () => {
    expect(text(286.6, 213.4)).toBe("−74");  // 287 and 213; not −73
    expect(text(9.871, 10.14)).toBe("+0.2");  // 9.87 and 10.1
    expect(text(1234.4, 999.6)).toBe("−234");  // 1234 and 1000
  });
  it("is zero where that rounds it away, and missing without a value", () => {
    expect(text(227.1, 227.2)).toBe("0");
    expect(text(5, 5)).toBe("0");
    expect(text(null, 5)).toBe("–");
  });
});
