// The crest of a barrier and the ground under it, along its line.
import type { Barrier, Point } from "../protocol/messages";
import type { Relief } from "../scene/relief";
import { crestAt } from "../scene/solids";
import { Chart } from "./chart";
import { sectionStations } from "./section";

export type Crest = Pick<Barrier, "height_m"> & Partial<Pick<Barrier, "crest_elevation_m" | "openings">>;

export class CrestProfile {
  private readonly chart = new Chart({ title: "Profile of the crest", x: { label: "Along the line", unit: "m" }, y: { label: "Height", unit: "m" }, height: 130,
    curves: [{ label: "Ground", unit: "m", colour: "#6a5b41", fill: "ground" }, { label: "Crest", unit: "m", colour: "#a3262a" }], empty: "" });
  readonly element = this.chart.element;

  constructor() {
    this.element.hidden = true;
  }
  /** Heights above the lowest ground under the line, so that the axis starts at zero. */
  show(barrier: Crest, line: readonly Point[], relief: Relief): void {
    this.element.hidden = line.length < 2;
    if (this.element.hidden) return;
    const stations = sectionStations(line);
    const ground = stations.map(({ at }) => relief.at(...at));
    const lowest = Math.min(...ground);
    this.chart.update([stations.map((s) => s.along), ground.map((z) => z - lowest), ground.map((z, k) => crestAt(barrier, stations[k].along, z) - lowest)]);
  }
  end(): void {
    this.chart.destroy();
  }
}
