import { describe, expect, it } from "vitest";
import type { Frame } from "../src/protocol/frame";
import { FrameClock } from "../src/scene/frame_clock";

const frame = (time_s: number, stride = 1): Frame => ({
  scenario: "A", flags: 1, time_s, step: 0, stride, count: 0, particles: new Uint16Array(), origin: [0, 0, 0], scale: [1, 1, 1], speedUnit_mps: 1,
  window: { column: 0, row: 0, columns: 0, rows: 0 }, depth: new Uint16Array(), mapSpeed: new Uint8Array(), depthUnit_m: 1, mapSpeedUnit_mps: 1,
});

describe("frame clock", () => {
  it("shows the first frame at once", () => {
    const clock = new FrameClock();
    expect(clock.time_s(0)).toBeNull();
    expect(clock.push(frame(1), 0)).toBe(false);
    expect(clock.fraction(0)).toBe(1);
    expect(clock.time_s(0)).toBe(1);
  });
  it("goes from the older to the newer frame within one interval and waits there", () => {
    const clock = new FrameClock();
    for (let k = 0; k < 60; ++k) clock.push(frame(k * 0.1), k * 40);
    const arrived = 59 * 40;
    expect(clock.fraction(arrived)).toBe(0);
    expect(clock.time_s(arrived)).toBeCloseTo(5.8);
    expect(clock.fraction(arrived + 20)).toBeCloseTo(0.5, 1);
    expect(clock.moving(arrived + 20)).toBe(true);
    expect(clock.fraction(arrived + 80)).toBe(1);
    expect(clock.time_s(arrived + 80)).toBeCloseTo(5.9);
    expect(clock.moving(arrived + 80)).toBe(false);
  });
  it("does not join what does not follow: back in time, a long gap, another stride, the same time", () => {
    const clock = new FrameClock();
    clock.push(frame(10), 0);
    expect(clock.push(frame(3), 30)).toBe(false);
    expect(clock.push(frame(3.1), 60)).toBe(true);
    expect(clock.push(frame(3.1), 90)).toBe(false);
    expect(clock.push(frame(9), 120)).toBe(false);
    expect(clock.push(frame(9.1, 2), 150)).toBe(false);
    expect(clock.fraction(150)).toBe(1);
  });
  it("says which frames are displayed no more, each once", () => {
    const gone: number[] = [];
    const clock = new FrameClock((frame) => gone.push(frame.time_s));
    for (const time of [1, 1.1, 1.2]) clock.push(frame(time), 0);
    expect(gone).toEqual([1]);
    clock.push(frame(5), 0); // far away: it is shown alone
    expect(gone).toEqual([1, 1.1, 1.2]);
    clock.push(frame(5.1), 0);
    expect([clock.previous?.time_s, clock.next?.time_s]).toEqual([5, 5.1]);
    expect(gone).toEqual([1, 1.1, 1.2]);
  });
});
