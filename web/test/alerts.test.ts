import { describe, expect, it } from "vitest";
import type { TriggeredRun } from "../src/protocol/messages";
import { clockText, readingText, runKey, startedText } from "../src/state/alerts";

const run: TriggeredRun = { scenario: "B", trigger: "Gauge", source: "MQTT", received_at: "2026-11-24T14:03:00Z", reason: "",
  values: { discharge_m3ps: 12 }, reading: null };

describe("a run that a trigger started", () => {
  it("says who started it, when and with what", () => {
    expect(startedText(run, "UTC")).toBe("Started by trigger Gauge (MQTT) at 14:03:00: gauge 12.0\u202fm³/s");
    expect(startedText({ ...run, values: { volume_m3: 500, pore_pressure_ratio: 0.3 }, reason: "tilt meter 2" }, "UTC"))
      .toBe("Started by trigger Gauge (MQTT) at 14:03:00: volume 500\u202fm³, pore pressure ratio 0.30, tilt meter 2");
    expect(startedText({ ...run, values: {} }, "UTC")).toBe("Started by trigger Gauge (MQTT) at 14:03:00");
  });
  it("is another one when it starts again in the same place", () => {
    expect(runKey(run)).not.toBe(runKey({ ...run, received_at: "2026-11-24T15:00:00Z" }));
  });
  it("tells the newest value of its gauge", () => {
    expect(readingText(run)).toBe("");
    expect(readingText({ ...run, reading: { discharge_m3ps: 7.5, received_at: "2026-11-24T14:04:10Z" } }, "UTC")).toBe("Gauge now 7.50\u202fm³/s (14:04:10)");
    expect(clockText(null)).toBe("–");
  });
});
