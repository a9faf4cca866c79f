import { describe, expect, it } from "vitest";
import type { RaisedAlarm, TriggeredRun } from "../src/protocol/messages";
import { AlarmBook, clockText, readingText, runKey, startedText } from "../src/state/alerts";

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

describe("an alarm", () => {
  const alarm = (name: string, hash = "1", raised_at: string | null = "2026-11-24T14:03:00Z"): RaisedAlarm =>
    ({ scenario: "B", alarm: name, sentence: "", message: "", time_s: 1, expected_s: null, step: 1, hash, raised_at, delivery: "" });
  const names = (alarms: readonly RaisedAlarm[]): string[] => alarms.map((a) => a.alarm);

  it("stands until it is acknowledged, also when its run starts again, and alarms once", () => {
    const book = new AlarmBook(new Set());
    expect(names(book.hear([alarm("road")]))).toEqual(["road"]);
    expect(book.hear([alarm("road"), alarm("bridge")]).length).toBe(1);
    expect(book.hear([]).length).toBe(0);
    expect(names(book.pending)).toEqual(["bridge", "road"]);
    book.acknowledge([alarm("road")]);
    expect(names(book.pending)).toEqual(["bridge"]);
    expect(book.hear([alarm("road")]).length).toBe(0);
    expect(names(book.hear([alarm("road", "2")]))).toEqual(["road"]);
  });
  it("stays acknowledged when the page is loaded again", () => {
    let kept: readonly string[] = [];
    new AlarmBook(new Set(), (keys) => (kept = keys)).acknowledge([alarm("road")]);
    expect(new AlarmBook(new Set(kept)).hear([alarm("road")]).length).toBe(0);
  });
  it("of a saved session is not raised again", () => {
    expect(new AlarmBook(new Set()).hear([alarm("road", "1", null)]).length).toBe(0);
  });
});
