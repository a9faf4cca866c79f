import { describe, expect, it } from "vitest";
import { aboutTime, endText, timeLeft } from "../src/state/time_left";

describe("time left", () => {
  it("is said no better than it is known", () => {
    expect([aboutTime(null), aboutTime(3), aboutTime(44), aboutTime(7200)]).toEqual(["", "about 5\u202fs", "about 45\u202fs", "about 2\u202fh"]);
  });
  it("ends with a sentence that says what still moves", () => {
    const ended = { status: "ended" as const, message: "reached solver.end_time_s = 90", time_s: 90, end_time_s: 90, volume_moving_m3: 12.6 };
    expect(endText(ended).replace(/[\u202f\u00a0]/g, " ")).toBe("Stopped at the 90 s limit; 12.6 m³ still moving");
    expect(endText({ ...ended, volume_moving_m3: 0 }).replace(/\u202f/g, " ")).toBe("Stopped at the 90 s limit");
    expect(endText({ ...ended, time_s: 40, message: "kinetic energy fell below 1 % of its peak" })).toBe("kinetic energy fell below 1 % of its peak");
    expect(endText({ ...ended, status: "at_rest", message: "debris came to rest" })).toBe("debris came to rest");
  });
  it("is that of the run, and no less than the speed that is wanted takes", () => {
    const state = { time_s: 20, expected_end_s: 60, wall_remaining_s: 12, speed_factor: null };
    expect(timeLeft(state)).toBe(12);
    expect(timeLeft({ ...state, speed_factor: 2 })).toBe(20);
    expect(timeLeft({ ...state, speed_factor: 10 })).toBe(12);
    expect(timeLeft({ ...state, expected_end_s: null, wall_remaining_s: null })).toBe(null);
  });
});
