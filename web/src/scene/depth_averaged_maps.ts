// Maps of the depth-averaged model of the scenarios, as long as they are those of the present setup.
import { Refused } from "../protocol/api";
import { scenarioNames, type ScenarioName } from "../protocol/frame";
import type { Grid } from "../protocol/grid";
import type { LayerName } from "../protocol/messages";
import type { Twin } from "../state/twin";
import { depthAveragedLayer, inUnit, layerInfo } from "./layers";

const most = 16;

export class DepthAveragedMaps {
  private readonly kept = new Map<string, Grid>();

  /** `changed` is called when there is a new result, or none any more. */
  constructor(private readonly twin: Twin, changed: () => void) {
    for (const s of scenarioNames) {
      let before = "";
      twin.cells[s].depthAveraged.watch((status) => {
        const now = status?.result?.hash ?? "";
        if (now === before) return;
        before = now;
        changed();
      });
    }
  }
  has(scenario: ScenarioName): boolean {
    return this.hashOf(scenario) !== null;
  }
  /** At a time of the recording, or now; null: there is no result, or the model has no such map. */
  async of(scenario: ScenarioName, quantity: LayerName, time_s: number | null): Promise<Grid | null> {
    const hash = this.hashOf(scenario);
    if (hash === null || depthAveragedLayer(quantity) === null) return null;
    // Depth is that of the moment; arrivals end at the displayed time; all else is of the whole run.
    const at = quantity === "depth" ? (time_s ?? this.twin.cells[scenario].state.value?.time_s ?? 0) : layerInfo[quantity].kind === "arrival" ? time_s : null;
    const key = `${scenario} ${hash} ${quantity} ${at ?? ""}`;
    try {
      const grid = this.kept.get(key) ?? inUnit(quantity, await this.twin.api.depthAveragedLayer(scenario, quantity, at));
      if (this.kept.size >= most) this.kept.clear();
      this.kept.set(key, grid);
      return this.hashOf(scenario) === hash ? grid : null;
    } catch (error) {
      if (error instanceof Refused && error.status === 404) return null;  // the setup has just changed
      throw error;
    }
  }
  private hashOf(scenario: ScenarioName): string | null {
    return this.twin.cells[scenario].depthAveraged.value?.result?.hash ?? null;
  }
}
