// Probes: points that the user put on the ground, and the flow that passed there.
import type { ScenarioName } from "../protocol/frame";
import type { ProbeSeries } from "../protocol/messages";
import { watchAll } from "../state/cell";
import { fixed, quantity } from "../state/format";
import type { Probe, Twin } from "../state/twin";
import { button, h } from "../ui/dom";
import { besideColour } from "../ui/theme";
import { Chart, joined, type Curve } from "./chart";

type Quantity = "depth_m" | "speed_mps" | "pressure_kPa" | "pore_pressure_ratio";
const kinds: [Quantity, string, string][] = [["depth_m", "Depth", "m"], ["speed_mps", "Speed", "m/s"], ["pressure_kPa", "Dynamic pressure", "kPa"], ["pore_pressure_ratio", "Pore-pressure ratio", ""]];

export class Probes {
  readonly element: HTMLElement;
  private readonly list = h("ul", { class: "items probes" });
  private readonly charts: Chart[];
  private readonly charted: HTMLElement;

  constructor(private readonly twin: Twin) {
    const add = button("Put a probe", { icon: "probe", class: "small", onclick: () =>
      (twin.tool.value = twin.tool.value.kind === "probe" ? { kind: "none" } : { kind: "probe" }) });
    const clear = button("Remove all", { class: "small quiet", onclick: () => (twin.probes.value = []) });
    this.charts = kinds.map(([, label, unit]) => new Chart({ title: `${label} at the points`, x: { label: "Time", unit: "s" }, y: { label, unit }, curves: [],
      height: 150, empty: `No ${label.toLowerCase()} recorded yet.` }));
    this.charted = h("div", {}, ...this.charts.map((c) => c.element));
    const hint = h("p", { class: "hint" }, "Choose “Put a probe”, then click on the ground (or press Space for the middle of the view). Depth, speed and pressure there are read from the recording, up to six points.");
    this.element = h("div", {}, h("div", { class: "row" }, add, clear), hint, this.list, this.charted);
    watchAll([twin.tool], () => add.setAttribute("aria-pressed", String(twin.tool.value.kind === "probe")));
    watchAll([twin.probes, twin.shown], () => {
      clear.hidden = twin.probes.value.length === 0;
      this.charted.hidden = twin.probes.value.length === 0;
      this.fill();
      this.draw();
      if (twin.probes.value.some((p) => Object.keys(p.series).length === 0)) void this.refresh();
    });
    twin.replay_s.watch((time) => this.charts.forEach((c) => c.mark(time)));
  }
  private fill(): void {
    this.list.replaceChildren(...this.twin.probes.value.map((probe, i) => {
      const dot = h("i", { class: "dot" });
      dot.style.background = probe.colour;
      const latest = probe.series[this.twin.edited.value];
      const peak = (column: (number | null)[] | undefined): number | null => (column ?? []).reduce<number | null>((a, v) => (v !== null && v > (a ?? -1) ? v : a), null);
      return h("li", { class: "probe" }, dot,
        h("span", { class: "grow" }, `${i + 1}: E ${fixed(probe.at[0], 1)}, N ${fixed(probe.at[1], 1)} m`,
          h("br"), h("span", { class: "muted" }, latest ? `peaks ${quantity(peak(latest.depth_m), "m")}, ${quantity(peak(latest.speed_mps), "m/s")}, ${quantity(peak(latest.pressure_kPa), "kPa")}` : "reading …")),
        button(`Remove probe ${i + 1}`, { icon: "remove", bare: true, class: "bare quiet small",
          onclick: () => (this.twin.probes.value = this.twin.probes.value.filter((p) => p !== probe)) }));
    }));
  }
  async refresh(): Promise<void> {
    const { twin } = this;
    const names = twin.shown.value;
    const probes = twin.probes.value;
    if (probes.length === 0) return;
    await twin.attempt(async () => {
      const fresh = await Promise.all(probes.map(async (probe): Promise<Probe> => {
        const read = await Promise.all(names.map((s) => twin.api.probe(s, probe.at[0], probe.at[1])));
        return { ...probe, series: Object.fromEntries(names.map((s, i) => [s, read[i]])) as Partial<Record<ScenarioName, ProbeSeries>> };
      }));
      // The list may have changed meanwhile.
      const still = twin.probes.value.map((p) => fresh.find((f) => f.at === p.at) ?? p);
      if (fresh.length > 0 && still.length > 0) twin.probes.value = still;
    });
  }
  private draw(): void {
    const { twin } = this;
    kinds.forEach(([kind, , unit], c) => {
      const tables: { x: (number | null)[]; y: (number | null)[] }[] = [];
      const curves: Curve[] = [];
      twin.probes.value.forEach((probe, i) => {
        for (const name of twin.shown.value) {
          const series = probe.series[name];
          if (!series) continue;
          tables.push({ x: series.time_s, y: series[kind] });
          const second = name === twin.shown.value[1];
          curves.push({ label: `${i + 1}${twin.shown.value.length > 1 ? ` ${name}` : ""}`, unit, colour: second ? besideColour(probe.colour) : probe.colour, dashed: second });
        }
      });
      const chart = this.charts[c];
      if (!chart) return;
      // Most debris has no pore pressure.
      if (kind === "pore_pressure_ratio") chart.element.hidden = !tables.some(({ y }) => y.some((value) => value !== null));
      chart.update(tables.length > 0 ? joined(tables) : [[]], curves);
    });
  }
}
