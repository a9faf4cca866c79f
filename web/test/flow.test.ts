import { describe, expect, it } from "vitest";
import type { FlowExport, FlowOffer } from "../src/protocol/messages";
import { flowProgress, flowSummary, intervalProblem } from "../src/state/flow";

const offer: FlowOffer = { scenario: "A", from_s: 0, to_s: 212.4, frames: 213, interval_s: 1, shortest_interval_s: 0.1, formats: [
  { name: "gltf", what: "", files: ["run.glb"], frames: 100, bytes: 12e6, refused: null },
  { name: "3dtiles", what: "", files: ["tileset.json", "run.glb"], frames: 100, bytes: 12e6, refused: null },
  { name: "geotiff", what: "", files: ["depth.tif", "speed.tif", "pressure.tif"], frames: 213, bytes: 3e6, refused: null },
  { name: "netcdf", what: "", files: ["maps.nc"], frames: 213, bytes: 3e6, refused: null },
] };
const job = (now: Partial<FlowExport>): FlowExport => ({ state: "idle", scenario: "A", share: null, message: "", files: [], ...now });

describe("the moving flow", () => {
  it("says how many frames there will be and about how large, counting the shared file once", () => {
    expect(flowSummary(offer, ["geotiff", "netcdf"])).toBe("213 frames from 0 to 212 s, 1 s apart; about 6.00\u202fMB.");
    expect(flowSummary(offer, ["gltf", "3dtiles"])).toBe("213 frames from 0 to 212 s, 1 s apart, 100 of them in the animation; about 12.0\u202fMB.");
    expect(flowSummary(offer, ["3dtiles", "netcdf"])).toContain("about 15.0\u202fMB");
    expect(flowSummary({ ...offer, to_s: 0.84, interval_s: 0.004 }, ["netcdf"])).toContain("from 0 to 0.84 s, 0.004 s apart");
    expect(flowSummary(offer, [])).toBe("Choose at least one format.");
  });
  it("refuses an interval shorter than that of the recording, none and no number", () => {
    for (const text of ["0.1", "2", "1e3"]) expect(intervalProblem(text, 0.1)).toBe("");
    for (const text of ["0.099", "-1", "", "abc"]) expect(intervalProblem(text, 0.1)).toBe("The interval must be at least 0.1 s, that of the recording.");
    expect(intervalProblem("0.002", 0.004)).toContain("at least 0.004 s");
    expect(intervalProblem("2e7", 0.1)).toMatch(/^The interval must be at most 10.000.000 s\.$/);
  });
  it("says how far the writing is, and why it failed", () => {
    expect(flowProgress(job({ state: "running", share: 0.404 }))).toBe("Writing the flow of scenario A: 40 %");
    expect(flowProgress(job({ state: "done", files: [{ name: "run.glb", bytes: 1.2e6 }] }))).toBe("Written: run.glb, 1.20\u202fMB (scenario A)");
    expect(flowProgress(job({ state: "failed", message: "No space left on device" }))).toBe("Not written: No space left on device");
    expect(flowProgress(job({ state: "cancelled" }))).toBe("Cancelled; no files were kept");
    expect(flowProgress(job({}))).toBe("");
  });
});
