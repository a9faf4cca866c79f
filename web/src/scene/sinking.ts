// Lowers the ground of every scenario by the erosion of its bed, live and in the recording.
import { scenarioNames, type ScenarioName } from "../protocol/frame";
import { watchAll } from "../state/cell";
import type { Twin } from "../state/twin";
import type { ScenarioView } from "./scenario_view";
import type { Stage } from "./stage";

const every_ms = 1000;

/**
 * Key of a ground that has lost `entrained_m3` so far and is shown at a time, null: now. Equal keys mean equal
 * grounds; the empty key is the ground of the scene, which needs no request.
 */
export function groundKey(entrained_m3: number, time_s: number | null): string {
  if (!(entrained_m3 > 0)) return "";
  return time_s === null ? `now ${entrained_m3}` : `at ${time_s}`;
}

export class Sinking {
  /** Keys of the grounds that are drawn. */
  private readonly drawn = new WeakMap<ScenarioView, string>();
  private busy = false;
  private again = false;

  constructor(private readonly twin: Twin, private readonly stage: Stage) {
    for (const name of scenarioNames) {
      twin.cells[name].state.watch((state) => {
        if (state && (state.status !== "running" || state.volume_entrained_m3 === 0)) void this.follow();
      });
    }
    watchAll([twin.shown, twin.replay_s], () => void this.follow());
    setInterval(() => void this.follow(), every_ms);
  }

  private async follow(): Promise<void> {
    if (this.busy) {
      this.again = true;
      return;
    }
    if (this.twin.connection.value.state !== "open" || document.hidden) return;
    this.busy = true;
    try {
      do {
        this.again = false;
        await Promise.all([...this.stage.views].map(([name, view]) => this.bring(name, view)));
      } while (this.again);
    } catch (error) {
      // Retried after a second; a lost connection is reported elsewhere.
      console.warn(error);
    }
    this.busy = false;
  }
  private async bring(name: ScenarioName, view: ScenarioView): Promise<void> {
    const { twin, stage } = this;
    const time = twin.replay_s.value;
    const key = groundKey(twin.cells[name].state.value?.volume_entrained_m3 ?? 0, time);
    if (key === (this.drawn.get(view) ?? "")) return;
    const depth = key === "" ? null : await twin.api.layer(name, "erosion_depth", time);
    if (stage.views.get(name) !== view) return;
    this.drawn.set(view, key);
    stage.sink(view, depth?.values.some((v) => v > 0) ? depth : null);
  }
}
