import { describe, expect, it } from "vitest";
import { viewOf, viewText, type LinkedView } from "../src/state/view_link";

const view: LinkedView = { camera: { position: [10.5, -20, 130], target: [0, 4, 90] }, layer: "peak_depth", shown: ["A", "C"], divider: 0.3 };

describe("a view in a link", () => {
  it("is read as it was written", () => {
    expect(viewText(view)).toBe("10.5,-20,130,0,4,90~peak_depth~AC~0.30");
    for (const each of [view, { ...view, divider: null, layer: "none" as const, shown: ["B" as const] }, { ...view, camera: { ...view.camera, plan_m: 250 } }]) expect(viewOf(viewText(each))).toEqual(each);
  });
  it("that somebody else wrote is not taken", () => {
    for (const text of ["", "~~", "1,2,3~none~A", "1,2,3,4,5,x~none~A", "1,2,3,4,5,1e9~none~A", "1,2,3,4,5,6~<b>~A", "1,2,3,4,5,6~none~Z", "1,2,3,4,5,6~none~ABC", "1,2,3,4,5,6~none~", "1,2,3,4,5,6~none~A~2",
      "1,2,3,4,5,6~none~A~0.5~", "1,2,3,4,5,6,-1~none~A"]) expect(viewOf(text), text).toBeNull();
  });
});
