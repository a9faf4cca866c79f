import { describe, expect, it } from "vitest";
import { fields } from "../src/protocol/schema";
import { barrierNote, openingsWith } from "../src/state/barriers";
import { shownAs, toldAs } from "../src/state/format";

describe("barriers", () => {
  it("are told in the server's units", () => {
    const { passing_share, resistance_Npm } = fields.barrier;
    expect(toldAs(passing_share, 35)).toBe(0.35);
    expect(shownAs(passing_share, 0.35)).toBe(35);
    expect(toldAs(resistance_Npm, 0.2)).toBe(200);
  });
  it("change one number of one opening", () => {
    const openings = [{ position_m: 4, width_m: 2, sill_height_m: 0 }, { position_m: 9, width_m: 3, sill_height_m: 1 }];
    expect(openingsWith(openings, 1, "width_m", 5)).toEqual([openings[0], { ...openings[1], width_m: 5 }]);
    expect(openingsWith(openings, 0, "width_m", NaN)).toEqual(openings);
    expect(openingsWith(openings, 0, "width_m", -1)).toEqual(openings);
  });
  it("say in the list that they are nets", () => {
    expect(barrierNote({ passing_share: 0.4, openings: [] })).toBe(", net, 40 % pass");
    expect(barrierNote({ passing_share: null, openings: [{ position_m: 4, width_m: 2, sill_height_m: 0 }] })).toBe(", 1 opening");
    expect(barrierNote({})).toBe("");
  });
});
