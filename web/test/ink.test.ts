import { expect, test } from "vitest";
import { contrast, inkOn } from "../src/scene/colour";
import { probeColours } from "../src/state/twin";

test("names can be read on the colours of people and points: 4.5 to 1", () => {
  expect(contrast("#56b4e9", "#ffffff")).toBeCloseTo(2.29, 1); // as they were, in white
  for (const colour of ["#e69f00", "#56b4e9", "#009e73", "#f0e442", "#0072b2", "#d55e00", "#cc79a7", ...probeColours]) {
    expect(contrast(colour, inkOn(colour)), colour).toBeGreaterThanOrEqual(4.5);
  }
});
