import { describe, expect, it } from "vitest";
import type { Series, State } from "../src/protocol/messages";
import { seriesUntil, stateAt } from "../src/state/past";

const series: Series = {
  time: { time_s: [0, 0.1, 0.2, 0.3], volume_moving_m3: [0, 10, 20, 30], volume_held_m3: [40, 30, 20, 10], volume_entrained_m3: [0, 0, 4, 8], front_chainage_m: [null, 1, 2, 3] },
  front: { chainage_m: [1, 2, 3], arrival_time_s: [0.1, 0.25, 0.2], front_velocity_mps: [5, 6, 7], particle_speed_mps: [8, 9, null] },
  gauges: { time_s: [0, 0.2], depth_m: [[0, 0.5], [0, 0]] },
};
const now = { time_s: 9, volume_moving_m3: 99, volume_held_m3: 0, volume_entrained_m3: 50, volume_left_m3: 3, front_chainage_m: 50, front_velocity_mps: 4, too_compressed: false } as State;

describe("what was known at an earlier time", () => {
  it("is all of the series for the present", () => expect(seriesUntil(series, null)).toBe(series));
  it("ends with the row at that time", () => {
    const past = seriesUntil(series, 0.2);
    expect(past?.time["volume_moving_m3"]).toEqual([0, 10, 20]);
    expect(past?.time["front_chainage_m"]).toEqual([null, 1, 2]);
  });
  it("has the depths at gauges until then", () => {
    expect(seriesUntil(series, 0.15)?.gauges).toEqual({ time_s: [0], depth_m: [[0], [0]] });
  });
  it("has the chainages that the front had reached, also out of order", () => {
    const past = seriesUntil(series, 0.22);
    expect(past?.front.chainage_m).toEqual([1, 3]);
    expect(past?.front.particle_speed_mps).toEqual([8, null]);
  });
  it("is the state of that time, and of now for what no series holds", () => {
    const past = stateAt(now, series, 0.21);
    expect(past).toMatchObject({ time_s: 0.21, volume_moving_m3: 20, volume_held_m3: 20, volume_entrained_m3: 4, volume_left_m3: 3, front_chainage_m: 2, front_velocity_mps: 7 });
    expect(stateAt(now, series, null)).toBe(now);
  });
  it("is that of the first row at the beginning, with no front yet", () => {
    expect(stateAt(now, series, 0)).toMatchObject({ time_s: 0, volume_moving_m3: 0, volume_held_m3: 40, front_chainage_m: null, front_velocity_mps: null });
  });
  it("is not that of the end while the series is still on its way", () => {
    expect(stateAt(now, null, 0)).toBeNull();
    expect(stateAt(now, null, null)).toBe(now);
  });
  it("tells no front velocity when the front has long stood still", () => {
    expect(stateAt(now, series, 5)?.front_velocity_mps).toBeNull();
  });
});
