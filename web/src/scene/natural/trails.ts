// Keeps the wet trail of every scenario shown that of the displayed time, live and in the recording.
import { scenarioNames, type Frame, type ScenarioName } from "../../protocol/frame";
import type { Status } from "../../protocol/messages";
import { watchAll } from "../../state/cell";
import type { Twin } from "../../state/twin";
import type { Stage } from "../stage";
import type { Trail } from "./trail";

/** Frames farther apart in simulated time leave out ground that debris crossed between them. */
const longestGap_s = 1.5;

export class Trails {
  private readonly last_s = new WeakMap<Trail, number>();
  private readonly due = new Set<ScenarioName>();
  private readonly status = new Map<ScenarioName, Status>();
  private busy = false;

  constructor(private readonly twin: Twin, private readonly stage: Stage) {
    twin.onFrame((frame) => this.add(frame));
    watchAll([twin.look, twin.layer, twin.surface, twin.shown], () => {
      for (const name of twin.shown.value) this.ask(name);
    });
    // A run that has come to a stop leaves what its last frames have not shown.
    for (const name of scenarioNames) {
      twin.cells[name].state.watch((state) => {
        if (state && state.status !== this.status.get(name)) {
          this.status.set(name, state.status);
          if (state.status !== "running" && twin.shown.value.includes(name)) this.ask(name);
        }
      });
    }
  }
  private add(frame: Frame): void {
    const trail = this.stage.views.get(frame.scenario)?.trail;
    if (!trail || !this.twin.natural) return;
    const last = this.last_s.get(trail) ?? -Infinity;
    if (frame.time_s < last) trail.clear();
    this.last_s.set(trail, frame.time_s);
    trail.add(frame);
    if (frame.time_s >= last && frame.time_s <= last + longestGap_s) return;
    this.ask(frame.scenario);
  }
  private ask(name: ScenarioName): void {
    if (!this.twin.natural) return;
    this.due.add(name);
    void this.fetch();
  }
  /** The largest depths until the displayed time; of several times asked for meanwhile only the last. */
  private async fetch(): Promise<void> {
    if (this.busy || this.twin.connection.value.state !== "open") return;
    this.busy = true;
    for (const name of this.due) {
      this.due.delete(name);
      const time = this.twin.replay_s.value;
      const trail = this.stage.views.get(name)?.trail;
      if (!trail) continue;
      try {
        const peaks = await this.twin.api.layer(name, "peak_depth", time);
        if (this.twin.replay_s.value !== time) continue;
        trail.addPeaks(peaks);
        this.stage.invalidate();
      } catch (error) {
        // A run that was restarted or removed meanwhile has none; the next frame asks again.
        console.debug(error);
      }
    }
    this.busy = false;
  }
}
