// Two scenarios in numbers, and the report of their comparison.
import type { ScenarioName } from "../protocol/frame";
import type { Figure } from "../protocol/messages";
import { watchAll } from "../state/cell";
import { comparisonRows, differenceText, untouched, type PointPeaks, type Row, type Side } from "../state/comparison";
import { paneText } from "../state/differences";
import { fixed, unitText } from "../state/format";
import { pressures } from "../state/pressures";
import { rerunning } from "../state/rerunning";
import type { Probe, Twin } from "../state/twin";
import { button, h } from "../ui/dom";
import { comparisonReport } from "./comparison_report";
import { shownValue, standing, timeSoFar } from "./comparison_text";
import { save } from "../ui/save";
import type { ObservedTable } from "./observed";
import type { Picture } from "./picture";

const peak = (column: readonly (number | null)[]): number | null => column.reduce<number | null>((most, v) => (v === null ? most : Math.max(most ?? v, v)), null);
const peaksOf = (probe: Probe, i: number, name: ScenarioName): PointPeaks => {
  const series = probe.series[name];
  return { name: `point ${i + 1}`, depth_m: series ? peak(series.depth_m) : null, speed_mps: series ? peak(series.speed_mps) : null,
    pressure_kPa: series ? peak(series.pressure_kPa) : null };
};

export class ComparePanel {
  readonly element: HTMLElement;
  private readonly figures = new Map<ScenarioName, readonly Figure[]>();
  private readonly head = h("thead", {});
  private readonly body = h("tbody", {});
  private readonly rest = h("p", { class: "hint" });
  private readonly notEqual = h("p", { class: "hint", role: "status" });
  private rows: Row[] = [];
  /** Fetches the key figures and what was observed; the table follows the rest by itself. Whoever waits for it has those of now. */
  readonly refresh = rerunning(() => this.fetch());

  constructor(private readonly twin: Twin, picture: Picture, private readonly observed: ObservedTable) {
    const report = button("Save the comparison", { icon: "download", class: "small", title: "One page with both views, the table and the charts (HTML)",
      onclick: () => void twin.attempt(async () => {
        await this.refresh();
        save("comparison.html", new Blob([comparisonReport(twin, this.rows, this.rest.textContent ?? "", picture.still())], { type: "text/html" }));
      }) });
    const none = h("p", { class: "hint" }, "Choose “Compare” in the list of scenarios to see two side by side.");
    const table = h("table", { class: "comparison plain" }, this.head, this.body);
    const shown = h("div", {}, h("div", { class: "row" }, report), this.notEqual, table, this.rest,
      h("p", { class: "hint" }, `${pressures} Figures are those of the runs as far as they have come.`));
    this.element = h("div", {}, none, shown);
    watchAll([twin.shown, ...twin.every("impacts"), ...twin.every("gauges"), ...twin.every("setup"), ...twin.every("state"), twin.probes, twin.replay_s], () => {
      shown.hidden = twin.shown.value.length < 2;
      none.hidden = !shown.hidden;
      this.draw();
    });
    twin.shown.watch(() => this.open());
  }
  /** Until the figures have come there are none: not those of another time. */
  open(): void {
    this.figures.clear();
    this.draw();
    void this.refresh();
  }
  private async fetch(): Promise<void> {
    const { twin } = this;
    if (twin.shown.value.length < 2 || twin.connection.value.state !== "open") return;
    const figures = twin.attempt(async () => {
      await Promise.all(twin.shown.value.map(async (name) => this.figures.set(name, await twin.api.figures(name))));
    });
    await Promise.all([figures, this.observed.refresh()]);
    this.draw();
  }
  private side(name: ScenarioName): Side {
    const { setup, impacts, gauges } = this.twin.cells[name];
    return { setup: setup.value, impacts: impacts.value, gauges: gauges.value ?? [], observed: this.observed.of(name), figures: this.figures.get(name) ?? [], points: this.twin.probes.value.map((p, i) => peaksOf(p, i, name)) };
  }
  private draw(): void {
    const { twin } = this;
    const [a, b] = twin.shown.value;
    if (b === undefined) return;
    const [left, right] = [this.side(a), this.side(b)];
    this.rows = comparisonRows(left, right, twin.scene.parameters, twin.replay_s.value);
    const count = untouched(left, right);
    this.rest.textContent = count > 0 ? `${count} ${count === 1 ? "house" : "houses"} not hit in either run` : "";
    const [then, now] = [a, b].map((name) => twin.cells[name].state.value?.time_s ?? 0);
    const over = [a, b].every((name) => ["ended", "at_rest"].includes(twin.cells[name].state.value?.status ?? ""));
    this.notEqual.hidden = over;
    this.notEqual.textContent = over ? "" : `These runs are still in progress: ${a} is at ${fixed(then, 1)} s, ${b} at ${fixed(now, 1)} s.`;
    this.head.replaceChildren(h("tr", {}, h("th", {}), ...[a, b].map((name) => h("th", { scope: "col", title: `${paneText(twin, name)}: ${standing(twin, name)}` }, name, h("small", {}, ` ${timeSoFar(twin, name)}`))),
      h("th", { scope: "col" }, `${b} − ${a}`)));
    const lines: HTMLElement[] = [];
    let group = "";
    for (const row of this.rows) {
      if (row.group !== group) lines.push(h("tr", { class: "group-row" }, h("th", { colspan: "4", scope: "rowgroup" }, row.group)));
      group = row.group;
      lines.push(h("tr", {}, h("th", { scope: "row" }, row.name, row.unit ? h("small", {}, ` ${unitText(row.unit)}`) : null),
        h("td", {}, shownValue(row.a)), h("td", {}, shownValue(row.b)), h("td", { class: differenceText(row) === "0" ? "muted" : "" }, differenceText(row))));
    }
    this.body.replaceChildren(...lines);
  }
}
