import { expect, test } from "vitest";
import { heightsText, heightUnit, heightUnits } from "../src/state/heights";

test("heights of a terrain in feet are in feet unless its user says otherwise", () => {
  expect(heightUnit(null, 0.30480060960121924)).toBe(1200 / 3937);
  expect(heightUnit(null, 0.3048)).toBe(0.3048);
  expect(heightUnit(null, 1)).toBe(null);
  expect(heightUnit(null, null), "the user has said metres").toBe(null);
  expect(heightUnit(0.3048, 1), "converted already").toBe(0.3048);
  expect(heightUnits(0.3048).map(([, name]) => name)).toEqual(["metres", "feet", "US survey feet"]);
  expect(heightUnits(0.9144).at(-1)).toEqual([0.9144, "units of 0.914400 m"]);
  expect([heightsText([12, 340.46]), heightsText(null)]).toEqual(["heights 12.0 to 340.5 m", ""]);
});
