// Impact on houses and barriers: a sortable table whose rows lead to the place.
import type { BarrierImpact, Impact, Impacts, SceneInfo } from "../protocol/messages";
import { css, rampAt, ramps } from "../scene/colour";
import { hitSide } from "../scene/hit_side";
import type { Stage } from "../scene/stage";
import { watchAll } from "../state/cell";
import { fixed, quantity, unitText } from "../state/format";
import { pressures } from "../state/pressures";
import { itemOf, lineOf, pointsOf } from "../state/shapes";
import type { HouseColour, Twin } from "../state/twin";
import { h } from "../ui/dom";
import { gaugeTable, sectionTable } from "./gauges";

interface Column<Row> { key: string; title: string; unit: string; value(row: Row): number | string | null; digits?: number }

const houseColumns: Column<Impact>[] = [
  { key: "name", title: "Building", unit: "", value: (r) => r.name },
  { key: "pressure", title: "Impact", unit: "kPa", value: (r) => r.peak_impact_pressure_kPa, digits: 1 },
  { key: "force", title: "Force", unit: "kN", value: (r) => r.peak_force_kN, digits: 0 },
  { key: "depth", title: "Depth", unit: "m", value: (r) => r.peak_depth_m, digits: 2 },
  { key: "first", title: "Hit at", unit: "s", value: (r) => r.first_hit_s, digits: 1 },
  { key: "class", title: "Class", unit: "", value: (r) => r.intensity },
];
const barrierColumns: Column<BarrierImpact>[] = [
  { key: "name", title: "Barrier", unit: "", value: (r) => r.name },
  { key: "force", title: "Force", unit: "kN", value: (r) => r.peak_force_kN, digits: 0 },
  { key: "retained", title: "Retained", unit: "m3", value: (r) => r.retained_m3, digits: 0 },
  { key: "over", title: "Overtopped", unit: "m3", value: (r) => r.overtopped_m3, digits: 1 },
  { key: "through", title: "Passed through", unit: "m3", value: (r) => r.passed_m3, digits: 1 },
  { key: "failed", title: "Failed", unit: "s", value: (r) => r.failed_s, digits: 1 },
];

/** Colour of a house by its impact; null: not hit. */
export function impactColour(impact: Impact | undefined, by: HouseColour, scene: SceneInfo, most_kPa: number): string | null {
  if (!impact?.hit) return null;
  if (by === "intensity") return scene.intensity.classes.find((c) => c.name === impact.intensity)?.colour ?? null;
  return css(rampAt(ramps.impact_pressure, (impact.peak_impact_pressure_kPa ?? 0) / Math.max(most_kPa, 1e-6)));
}
export const largestPressure = (impacts: Impacts | null): number =>
  (impacts?.buildings ?? []).reduce((most, b) => Math.max(most, b.peak_impact_pressure_kPa ?? 0), 0);

/** The elements of a row stay while its values change: rows come anew every second, also between the press and the release of a click. */
class SortedTable<Row extends Impact> {
  readonly element: HTMLElement;
  private readonly body = h("tbody");
  private readonly heads = new Map<string, { cell: HTMLElement; title: HTMLElement }>();
  private readonly lines = new Map<string, { element: HTMLElement; show(row: Row): void }>();
  private sortKey: string;
  private down = true;
  private rows: Row[] = [];

  constructor(private readonly columns: Column<Row>[], private readonly go: (row: Row) => void, private readonly mark: (row: Row) => string | null,
    private readonly selected: () => string | null, kind = "") {
    this.sortKey = columns[1]?.key ?? "name";
    this.element = h("table", { class: `impacts ${kind}`.trim() }, h("thead", {}, h("tr", {}, ...columns.map((c) => this.head(c)))), this.body);
  }
  show(rows: readonly Row[]): void {
    this.rows = [...rows];
    this.draw();
  }
  private head(c: Column<Row>): HTMLElement {
    const title = h("span", {}, c.title);
    const cell = h("th", { scope: "col" }, h("button", { type: "button", onclick: () => {
      this.down = c.key === this.sortKey ? !this.down : c.key !== "name";
      this.sortKey = c.key;
      this.draw();
    } }, title, c.unit ? h("small", {}, unitText(c.unit)) : null));
    this.heads.set(c.key, { cell, title });
    return cell;
  }
  private line(first: Row): { element: HTMLElement; show(row: Row): void } {
    let now = first;
    const dot = h("i", { class: "dot" });
    const name = h("button", { type: "button" });
    const values = this.columns.slice(1).map(() => h("td"));
    const element = h("tr", { onclick: () => this.go(now) }, h("th", { scope: "row" }, dot, name), ...values);
    return { element, show: (row) => {
      now = row;
      element.className = `${row.hit ? "" : "untouched"} ${row.id === this.selected() ? "chosen" : ""}`;
      dot.style.background = this.mark(row) ?? "";
      const texts = this.columns.map((c) => {
        const v = c.value(row);
        return { text: typeof v === "number" ? fixed(v, c.digits ?? 1) : (v ?? "–"), word: typeof v !== "number" };
      });
      name.textContent = texts[0].text;
      name.title = `${texts[0].text}: show it from the side that is hit`;
      values.forEach((cell, i) => {
        cell.textContent = texts[i + 1].text;
        cell.className = texts[i + 1].word ? "word" : "";
      });
    } };
  }
  private draw(): void {
    const column = this.columns.find((c) => c.key === this.sortKey);
    const rows = [...this.rows].sort((a, b) => {
      const [u, v] = [column?.value(a) ?? null, column?.value(b) ?? null];
      if (u === v) return 0;
      if (u === null) return 1;
      if (v === null) return -1;
      return (u < v ? -1 : 1) * (this.down ? -1 : 1);
    });
    for (const c of this.columns) {
      const { cell, title } = this.heads.get(c.key)!;
      const by = c.key === this.sortKey;
      cell.setAttribute("aria-sort", by ? (this.down ? "descending" : "ascending") : "none");
      title.textContent = `${c.title}${by ? (this.down ? " ▾" : " ▴") : ""}`;
    }
    const present = new Set(rows.map((row) => row.id));
    for (const [id, line] of this.lines) {
      if (present.has(id)) continue;
      line.element.remove();
      this.lines.delete(id);
    }
    rows.forEach((row, i) => {
      let line = this.lines.get(row.id);
      if (!line) this.lines.set(row.id, (line = this.line(row)));
      line.show(row);
      if (this.body.children[i] === line.element) return;
      // An element that is moved loses the focus.
      const focused = line.element.contains(document.activeElement);
      this.body.insertBefore(line.element, this.body.children[i] ?? null);
      if (focused) line.element.querySelector("button")?.focus();
    });
  }
}

export function impactsPanel(twin: Twin, stage: Stage): HTMLElement {
  const go = (shape: "building" | "barrier") => (row: Impact): void => {
    twin.selection.value = { shape, id: row.id };
    const name = twin.edited.value;
    const at = stage.views.get(name)?.solidAt(row.id);
    const item = itemOf(twin.now.setup.value, { shape, id: row.id });
    if (!at || !item) return;
    void twin.attempt(async () => {
      const depth = row.hit ? await twin.api.layer(name, "peak_depth", twin.replay_s.value) : null;
      stage.rig.visit(at.toArray(), 70, hitSide(pointsOf(item), lineOf(item) === null, depth, stage.reliefOf(name)));
    });
  };
  const selected = (): string | null => twin.selection.value?.id ?? null;
  const houses = new SortedTable(houseColumns, go("building"),
    (row) => impactColour(row, twin.houseColour.value, twin.scene, largestPressure(twin.now.impacts.value)), selected);
  const barriers = new SortedTable(barrierColumns, go("barrier"), () => null, selected, "of-barriers");
  const colouring = h("select", { "aria-label": "Colour of houses", onchange: () => (twin.houseColour.value = colouring.value as HouseColour) },
    h("option", { value: "intensity" }, "by intensity class"), h("option", { value: "pressure" }, "by impact pressure"));
  const { intensity } = twin.scene;
  const classes = h("ul", { class: "classes" }, ...intensity.classes.map((c) => {
    const dot = h("i", { class: "dot" });
    dot.style.background = c.colour;
    return h("li", {}, dot, h("b", {}, c.name), h("span", { class: "muted" }, ` ${c.criterion}`));
  }));
  const none = h("p", { class: "hint" }, "Nothing has been hit yet. Rows fill as debris reaches houses and barriers.");
  const measured = h("p", { class: "hint" }, `${pressures} Depth is that of the debris in front of the walls.`);
  const barrierTitle = h("h3", {}, "Barriers");
  const goneTitle = h("h3", {}, "Taken away");
  const gone = h("ul", { class: "removed" });
  const then = h("p", { class: "hint" });
  watchAll([twin.edited, ...twin.every("impacts"), twin.selection, twin.houseColour, twin.replay_s], () => {
    const impacts = twin.now.impacts.value;
    houses.show(impacts?.buildings ?? []);
    barriers.show(impacts?.barriers ?? []);
    const removed = impacts?.removed ?? [];
    gone.replaceChildren(...removed.map((r) => h("li", {}, h("b", {}, r.name), ` until ${fixed(r.removed_s, 1)} s: `,
      r.hit ? `${quantity(r.peak_impact_pressure_kPa, "kPa")}, ${quantity(r.peak_force_kN, "kN")}` : "not hit",
      r.overtopped_m3 === undefined ? "" : `, ${quantity(r.overtopped_m3, "m3")} overtopped it, ${quantity(r.retained_m3, "m3")} retained`)));
    goneTitle.hidden = gone.hidden = removed.length === 0;
    then.hidden = twin.replay_s.value === null;
    then.textContent = `As of ${fixed(twin.replay_s.value, 1)} s.`;
    none.hidden = (impacts?.buildings ?? []).some((b) => b.hit) || (impacts?.barriers ?? []).some((b) => b.hit);
    barriers.element.hidden = barrierTitle.hidden = (impacts?.barriers.length ?? 0) === 0;
    houses.element.hidden = (impacts?.buildings.length ?? 0) === 0;
    colouring.value = twin.houseColour.value;
  });
  return h("div", {}, then, none, barrierTitle, barriers.element, gaugeTable(twin, stage), sectionTable(twin, stage), h("div", { class: "row" }, h("h3", { class: "grow" }, "Buildings"), h("label", { class: "check" }, "Colour", colouring)),
    houses.element, measured, goneTitle, gone, h("h3", {}, "Intensity classes"), classes, h("p", { class: "hint" }, intensity.rule), h("p", { class: "hint" }, `Source: ${intensity.source}`));
}
