import { describe, expect, it } from "vitest";
import type { ObservedRow } from "../src/protocol/messages";
import { comparisonRows, type Side } from "../src/state/comparison";
import { pairedRows } from "../src/state/observed";

const row = (id: string | null, name: string, computed: number, more: Partial<ObservedRow> = {}): ObservedRow =>
  ({ id, name, unit: "m/s", observed: 7, uncertainty: 1, is: "equal", computed, deviation: 0, ...more });
const computed = (runs: ObservedRow[][]): (number | null)[][] => pairedRows(runs).map((group) => group.map((r) => r?.computed ?? null));

describe("rows of observations", () => {
  it("belong together by observation where two have the same name, whatever their order", () => {
    expect(computed([[row("a", "Bend", 1), row("b", "Bend", 2)], [row("b", "Bend", 20), row("a", "Bend", 10)]])).toEqual([[1, 10], [2, 20]]);
  });
  it("of one observation keep apart, and those of files belong together by name", () => {
    expect(computed([[row("a", "front", 1), row("a", "debris", 2), row(null, "Run-out", 3)], [row(null, "Run-out", 30), row("a", "debris", 20)]])).toEqual([[1, null], [2, 20], [3, 30]]);
  });
  it("of observations that each run has got for itself belong together by name", () => {
    expect(computed([[row("a", "Mark", 1)], [row("c", "Mark", 10), row("d", "Mark", 11), row("e", "Other", 12)]])).toEqual([[1, 10], [null, 11], [null, 12]]);
  });
  it("stand in the comparison with what was observed", () => {
    const side = (...observed: ObservedRow[]): Side => ({ setup: null, figures: [], impacts: null, gauges: [], points: [], observed });
    const mark = { is: "at_least", observed: 3, unit: "m" } as const;
    expect(comparisonRows(side(row("a", "Run-up", 2, mark), row("b", "Run-up", 4, mark)), side(row("b", "Run-up", 5, mark)), []).map(({ name, a, b }) => [name, a, b]))
      .toEqual([["Run-up (observed: at least 3.00)", 2, null], ["Run-up (observed: at least 3.00)", 4, 5]]);
  });
});
