import { describe, expect, it } from "vitest";
import { aboutTime, timeLeft } from "../src/state/time_left";

describe("time left", () => {
  it("is said no better than it is known", () => {
    expect([aboutTime(null), aboutTime(3), aboutTime(44), aboutTime(7200)]).toEqual(["", "about 5\u202fs", "about 45\u202fs", "about 2\u202fh"]);
  });
  it("is that of the run, and no less than the speed that is wanted takes", () => {
    const state = { time_s: 20, expected_end_s: 60, wall_remaining_s: 12, speed_factor: null };
    expect(timeLeft(state)).toBe(12);
    expect(timeLeft({ ...state, speed_factor: 2 })).toBe(20);
    expect(timeLeft({ ...state, speed_factor: 10 })).toBe(12);
    expect(timeLeft({ ...state, expected_end_s: null, wall_remaining_s: null })).toBe(null);
  });
});
