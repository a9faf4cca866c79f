import { describe, expect, it } from "vitest";
import type { FlowPath, SceneInfo, Setup, TableEntry, TableKey, TableSection } from "../src/protocol/messages";
import { beginsScenario } from "../src/state/edits";
import { chainageAt, entriesOf, hintOf, needsText, observationText, observedVelocities, placeOf, placeValues, sectionsOf, summaryOf, valueFrom } from "../src/state/tables";

const path: FlowPath = { points: [[0, 0, 9], [100, 0, 5], [100, 50, 1]], chainage_m: [0, 100, 150], corridor_width_m: 20, traced: false };
const key = (name: string, more: Partial<TableKey> = {}): TableKey =>
  ({ key: name, label: name.replace(/_(m|mps|s)$/, "").replaceAll("_", " "), unit: "m", is: "number", required: false, default: null, absent: "", allowed: "0 to 10000", help: "Help.", ...more });
const runUp: TableSection = { section: "run_up", kind: "observation", help: "", one_of: [],
  keys: [key("name", { is: "text", unit: "" }), key("x_m", { required: true }), key("y_m", { required: true }), key("height_m", { required: true }), key("uncertainty_m", { default: 1 })] };
const velocity: TableSection = { section: "observation", kind: "observation", help: "", one_of: [["front_velocity_mps", "debris_speed_mps"]],
  keys: [key("chainage_m", { required: true }), key("front_velocity_mps", { unit: "m/s" }), key("debris_speed_mps", { unit: "m/s" })] };
const alarm: TableSection = { section: "alarm", kind: "alarm", help: "", one_of: [["structure", "chainage_m", "x_m"]], keys: [key("chainage_m"), key("x_m"), key("y_m")] };
const entry = (section: string, values: TableEntry["values"], name = "Bend"): TableEntry => ({ id: `${section}-1`, section, name, values, from_scene: false });
const setup = (observations: TableEntry[]): Setup => ({ observations, triggers: [], alarms: [] }) as unknown as Setup;

describe("an entry at a place of the ground", () => {
  it("is at the nearest point of the flow path", () => {
    expect(chainageAt(path, [40, 7])).toBeCloseTo(40);
    expect(chainageAt(path, [130, 20])).toBeCloseTo(120);
    expect(chainageAt(path, [-30, 0])).toBe(0);
    expect(chainageAt(null, [0, 0])).toBeNull();
  });
  it("begins with the place that its section has, and an alarm with one of its places", () => {
    expect(placeValues(runUp, [40.004, 7], path)).toEqual({ x_m: 40, y_m: 7 });
    expect(placeValues(velocity, [40, 7], path)).toEqual({ chainage_m: 40 });
    expect(placeValues(alarm, [40, 7], path)).toEqual({ x_m: 40, y_m: 7 });
    expect(placeValues(velocity, null, path)).toEqual({});
  });
  it("is found again, or has no place", () => {
    expect(placeOf(entry("run_up", { x_m: 1, y_m: 2 }), () => null)).toEqual([1, 2]);
    expect(placeOf(entry("arrival", { chainage_m: 30 }), (c) => [c, 0])).toEqual([30, 0]);
    expect(placeOf(entry("damage", { building: "House 1" }), () => null)).toBeNull();
  });
});

describe("the form of an entry", () => {
  it("reads numbers with point or comma, and says what is none", () => {
    expect(valueFrom(key("height_m"), " 2,5 ")).toBe(2.5);
    expect(valueFrom(key("height_m"), "")).toBeNull();
    expect(() => valueFrom(key("height_m"), "high")).toThrow("“high” is not a number; it must be 0 to 10000 m");
    expect(valueFrom(key("name", { is: "text" }), " Bend ")).toBe("Bend");
  });
  it("says what each kind needs, and what no value means", () => {
    expect(needsText(runUp)).toBe("x; y; height");
    expect(needsText(velocity)).toBe("chainage; one of front velocity, debris speed");
    expect(hintOf(key("uncertainty_mps", { unit: "m/s", absent: "a fifth of the value", help: "" }))).toContain("if empty: a fifth of the value");
  });
});

describe("entries on display", () => {
  it("are told in a line, without what is as usual", () => {
    expect(summaryOf(runUp, entry("run_up", { x_m: 1, y_m: 2, height_m: 2.5, uncertainty_m: 1 }))).toBe("height 2.50\u202fm");
    expect(observationText(entry("observation", { chainage_m: 10, debris_speed_mps: 11 }))).toBe("Bend, debris 11.0\u202fm/s");
  });
  it("are marks in the chart of the front where they are velocities", () => {
    const all = setup([entry("observation", { chainage_m: 10, debris_speed_mps: 11, front_velocity_mps: null }), entry("run_up", { height_m: 2 })]);
    expect(observedVelocities(all, "debris_speed_mps")).toEqual([{ chainage_m: 10, mps: 11 }]);
    expect(observedVelocities(all, "front_velocity_mps")).toEqual([]);
    expect(entriesOf(null, "alarm")).toEqual([]);
    expect(sectionsOf({ table_sections: [runUp, alarm] } as unknown as SceneInfo, "alarm")).toEqual([alarm]);
  });
  it("begin no scenario of their own: no step of the run knows them", () => {
    expect(beginsScenario({ action: "put_observation", section: "run_up", values: {} })).toBe(false);
    expect(beginsScenario({ action: "remove_alarm", id: "alarm-1" })).toBe(false);
    expect(beginsScenario({ action: "put_gauge", x_m: 1, y_m: 2 })).toBe(true);
  });
});
