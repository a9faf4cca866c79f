import { expect, it } from "vitest";
import { whatIsGone } from "../src/state/former_session";

const begin = "The session “Gully” has ended. ", end = "What was drawn or changed in it is gone unless it was saved.";

it("what is gone names the runs that had begun", () => {
  expect(whatIsGone({ title: "Gully", runs: [{ scenario: "A", time_s: 41.3 }, { scenario: "B", time_s: 0 }] })).toBe(`${begin}Its run is gone: A to 41 s. ${end}`);
  expect(whatIsGone({ title: "Gully", runs: [{ scenario: "A", time_s: 4.13 }, { scenario: "C", time_s: 60 }] })).toBe(`${begin}Its runs are gone: A to 4.1 s, C to 60 s. ${end}`);
  expect(whatIsGone({ title: "Gully", runs: [{ scenario: "A", time_s: 0.02 }] })).toBe(`${begin}${end}`);
});
