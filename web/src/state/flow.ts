// Files of the moving flow: what they will contain, and how far they are.
import type { FlowExport, FlowFormat, FlowOffer } from "../protocol/messages";
import { bytes, percent, tick } from "./format";

export const flowTitles: Record<FlowFormat, string> = { gltf: "glTF animation", "3dtiles": "3D Tiles", geotiff: "GeoTIFF maps", netcdf: "NetCDF maps" };

/** What is chosen, in one sentence: frames, times, about how large. */
export function flowSummary(offer: FlowOffer, chosen: readonly FlowFormat[]): string {
  const formats = offer.formats.filter((format) => chosen.includes(format.name));
  if (formats.length === 0) return "Choose at least one format.";
  // glTF and 3D Tiles share their largest file.
  const drawn = formats.filter((format) => format.files.includes("run.glb"));
  const maps = formats.filter((format) => !format.files.includes("run.glb"));
  const size = Math.max(0, ...drawn.map((format) => format.bytes)) + maps.reduce((sum, format) => sum + format.bytes, 0);
  const fewest = Math.min(...formats.map((format) => format.frames));
  const thinned = fewest < offer.frames ? `, ${fewest} of them in the animation` : "";
  return `${offer.frames} frames from ${tick(offer.from_s)} to ${tick(offer.to_s)} s, ${tick(offer.interval_s)} s apart${thinned}; about ${bytes(size)}.`;
}

const longest_s = 1e7;
/** What is wrong with an interval as it is typed; empty: nothing. */
export function intervalProblem(text: string, shortest_s: number): string {
  const seconds = Number(text);
  if (!(seconds >= shortest_s)) return `The interval must be at least ${tick(shortest_s)} s, that of the recording.`;
  return seconds <= longest_s ? "" : `The interval must be at most ${tick(longest_s)} s.`;
}

/** How far it is; empty: nothing to say. */
export function flowProgress(job: FlowExport): string {
  switch (job.state) {
    case "running": return `Writing the flow of scenario ${job.scenario}: ${percent(job.share, 0)}`;
    case "cancelling": return "Cancelling";
    case "done": return `Written: ${job.files.map((file) => `${file.name}, ${bytes(file.bytes)}`).join("; ")} (scenario ${job.scenario})`;
    case "cancelled": return "Cancelled; no files were kept";
    case "failed": return `Not written: ${job.message}`;
    case "idle": return "";
  }
}
