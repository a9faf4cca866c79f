import { describe, expect, it } from "vitest";
import type { State } from "../src/protocol/messages";
import { standingText } from "../src/state/standing";

const state = (status: State["status"], volume_moving_m3: number): State => ({ status, time_s: 30, volume_moving_m3 }) as State;

describe("how a run stands", () => {
  it("says beside the end what still moves", () => {
    expect(standingText(state("ended", 12.61))).toBe("End reached, 30.0 s; 12.6\u202fm³ still moving");
    expect(standingText(state("ended", 12.61), false)).toBe("End reached; 12.6\u202fm³ still moving");
    expect(standingText(state("ended", 0))).toBe("End reached, 30.0 s");
    expect(standingText(state("running", 12.61))).toBe("Running, 30.0 s");
  });
  it("is not at rest while debris moves", () => {
    expect(standingText(state("at_rest", 0.2))).toBe("Stopped, 30.0 s; 0.200\u202fm³ still moving");
    expect(standingText(state("at_rest", 0))).toBe("At rest, 30.0 s");
  });
});
