import { describe, expect, it } from "vitest";
import { lightAt, momentOf, sunAt, textOf } from "../src/scene/natural/sun";

const elevation = (day: number, hour: number, latitude: number): number => (Math.asin(sunAt({ day, hour }, latitude).z) * 180) / Math.PI;
const azimuth = (day: number, hour: number, latitude: number): number => {
  const { x, y } = sunAt({ day, hour }, latitude);
  return ((Math.atan2(x, y) * 180) / Math.PI + 360) % 360;
};

describe("the sun", () => {
  it("stands at noon at 90 degrees less latitude plus declination", () => {
    expect(elevation(172, 12, 47)).toBeCloseTo(90 - 47 + 23.45, 1);
    expect(elevation(355, 12, 47)).toBeCloseTo(90 - 47 - 23.45, 1);
    expect(azimuth(81, 12, 47)).toBeCloseTo(180, 0);
    expect(azimuth(81, 12, -30)).toBeCloseTo(0, 0);
  });
  it("rises in the east and sets in the west at an equinox, six hours from noon", () => {
    expect(elevation(81, 6, 30)).toBeCloseTo(0, 0);
    expect(azimuth(81, 6, 30)).toBeCloseTo(90, 0);
    expect(azimuth(81, 18, 30)).toBeCloseTo(270, 0);
  });
  it("does not set at midsummer near the pole", () => expect(elevation(172, 0, 80)).toBeGreaterThan(10));
  it("is weaker and redder the lower it stands, and dark below the horizon, under a sky that is never black", () => {
    const [high, low, night] = [1, 0.1, -0.5].map(lightAt);
    expect(low.sun.g).toBeLessThan(0.7 * high.sun.g);
    expect(low.sun.r / low.sun.b).toBeGreaterThan(high.sun.r / high.sun.b);
    expect(night.sun.g).toBe(0);
    expect(night.sky.g).toBeGreaterThan(0);
  });
  it("is set by a field for date and time", () => {
    expect(momentOf("2027-09-22T15:30")).toEqual({ day: 265, hour: 15.5 });
    expect(momentOf(textOf({ day: 32, hour: 6.25 }))).toEqual({ day: 32, hour: 6.25 });
    expect(momentOf("")).toBeNull();
  });
});
