import { expect, it } from "vitest";
import { whatIsGone } from "../src/state/former_session";

const begin = "The session “Gully” has ended. Lost: ", end = "all edits that were not saved.";

it("what is gone names the runs that had begun", () => {
  expect(whatIsGone({ title: "Gully", runs: [{ scenario: "A", time_s: 41.3 }, { scenario: "B", time_s: 0 }] })).toBe(`${begin}run A (41 s), ${end}`);
  expect(whatIsGone({ title: "Gully", runs: [{ scenario: "A", time_s: 4.13 }, { scenario: "C", time_s: 60 }] })).toBe(`${begin}run A (4.1 s), run C (60 s), ${end}`);
  expect(whatIsGone({ title: "Gully", runs: [{ scenario: "A", time_s: 0.02 }] })).toBe(`${begin}${end}`);
});
