import { describe, expect, it } from "vitest";
import { Resolution } from "../src/scene/resolution";

/** Draws so many pictures, each of which takes so long, with `pause_ms` between one and the next; the share after them. */
function draw(resolution: Resolution, pictures: number, took_ms: number, pause_ms = 0): number {
  for (let k = 0, now = 0; k < pictures; ++k, now += took_ms + pause_ms) {
    resolution.drew(now);
    resolution.tick(now + took_ms);
    resolution.tick(now + took_ms + pause_ms / 2);
  }
  return resolution.share;
}

describe("resolution", () => {
  it("stays whole where graphics keep up", () => expect(draw(new Resolution(), 300, 16.7)).toBe(1));
  it("falls within a second of slow pictures, and not below a floor", () => {
    const resolution = new Resolution();
    expect(draw(resolution, 12, 80)).toBeLessThan(0.8);
    expect(draw(resolution, 500, 80)).toBe(0.35);
  });
  it("leaves out detail as it falls", () => {
    const resolution = new Resolution();
    expect(resolution.detail).toBe(2);
    draw(resolution, 12, 80);
    expect(resolution.detail).toBe(1);
    draw(resolution, 500, 80);
    expect(resolution.detail).toBe(0);
  });
  it("rises again, slowly, when pictures come fast", () => {
    const resolution = new Resolution();
    draw(resolution, 100, 80);
    expect(draw(resolution, 60, 10)).toBe(0.35);
    expect(draw(resolution, 1000, 10)).toBe(1);
  });
  it("does not take seldom for slow", () => expect(draw(new Resolution(), 300, 16.7, 100)).toBe(1));
  it("knows when the view stands still", () => {
    const resolution = new Resolution();
    resolution.drew(1000);
    expect(resolution.standsStill(1100)).toBe(false);
    expect(resolution.standsStill(1300)).toBe(true);
  });
});
