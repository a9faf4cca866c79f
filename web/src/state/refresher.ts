// Polls data that the server does not push: series, impacts, gauges and cross-sections, during the run and once after it stops.
import { scenarioNames, type ScenarioName } from "../protocol/frame";
import type { Twin } from "./twin";

const every_ms = 1000;

export class Refresher {
  private readonly stale = new Set<ScenarioName>(["A"]);
  private busy = false;
  /** `also` is called after every refresh, for panels with their own requests. */
  constructor(private readonly twin: Twin, private readonly also: () => void) {
    for (const name of scenarioNames) {
      let seen = "";
      twin.cells[name].state.watch((state) => {
        const key = state ? `${state.status} ${state.step}` : "";
        if (key !== seen) this.stale.add(name);
        seen = key;
      });
      twin.cells[name].setup.watch(() => this.stale.add(name));
    }
    // Live again: the impacts are still those of the displayed time.
    twin.replay_s.watch((time) => {
      if (time !== null) return;
      for (const name of twin.shown.value) this.stale.add(name);
      void this.refresh();
    });
    twin.shown.watch(() => void this.refresh());
    // A recording is shown at its beginning at once: its values then are in the series.
    twin.connection.watch(() => void this.refresh());
    setInterval(() => void this.refresh(), every_ms);
    void this.refresh();
  }
  private async refresh(): Promise<void> {
    const { twin } = this;
    const names = [...this.stale].filter((n) => twin.shown.value.includes(n));
    if (this.busy || names.length === 0 || twin.connection.value.state !== "open" || document.hidden) return;
    this.busy = true;
    names.forEach((name) => this.stale.delete(name));
    try {
      await Promise.all(names.map(async (name) => {
        const [series, readings] = await Promise.all([twin.api.series(name), twin.readings(name, null)]);
        twin.cells[name].series.value = series;
        if (twin.replay_s.value !== null) return;
        twin.showReadings(name, readings);
      }));
      this.also();
    } catch (error) {
      // Retried at the next change; a lost connection is reported elsewhere.
      console.warn(error);
    }
    this.busy = false;
  }
}
