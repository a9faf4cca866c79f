import { describe, expect, it } from "vitest";
import { Resolution } from "../src/scene/resolution";

/** Draws so many pictures, so far apart; the share after them. */
function draw(resolution: Resolution, from_ms: number, pictures: number, gap_ms: number): number {
  for (let k = 1; k <= pictures; ++k) resolution.drew(from_ms + k * gap_ms);
  return resolution.share;
}

describe("resolution", () => {
  it("stays whole where graphics keep up", () => expect(draw(new Resolution(), 0, 300, 16.7)).toBe(1));
  it("falls within a second of slow pictures, and not below a floor", () => {
    const resolution = new Resolution();
    expect(draw(resolution, 0, 12, 80)).toBeLessThan(0.8);
    expect(draw(resolution, 1000, 500, 80)).toBe(0.35);
  });
  it("rises again, slowly, when pictures come fast", () => {
    const resolution = new Resolution();
    draw(resolution, 0, 100, 80);
    expect(draw(resolution, 8000, 60, 10)).toBe(0.35);
    expect(draw(resolution, 8600, 1000, 10)).toBe(1);
  });
  it("learns nothing from the pause before a picture", () => {
    const resolution = new Resolution();
    expect(draw(resolution, 0, 50, 1500)).toBe(1);
    expect(resolution.standsStill(50 * 1500 + 100)).toBe(false);
    expect(resolution.standsStill(50 * 1500 + 300)).toBe(true);
  });
});
