// What the gauges and cross-sections of a run read: tables whose rows lead to the place.
import type { Point } from "../protocol/messages";
import type { Stage } from "../scene/stage";
import { type Cell, watchAll } from "../state/cell";
import { fixed } from "../state/format";
import { middle } from "../state/shapes";
import type { Twin } from "../state/twin";
import { h } from "../ui/dom";

interface Row { element: HTMLElement; cells: HTMLElement[] }

/** A table of what is measured at places that have names. */
interface Measured<Reading extends { name: string }> {
  title: string;
  head: string;
  className: string;
  heads: readonly (readonly [string, string])[];
  cells: readonly Cell<readonly Reading[] | null>[];
  readings(): readonly Reading[];
  placeOf(name: string): Point | null;
  /** Whether debris has been there. */
  reached(reading: Reading): boolean;
  texts(reading: Reading): string[];
}

function readingTable<Reading extends { name: string }>(twin: Twin, stage: Stage, what: Measured<Reading>): HTMLElement {
  const body = h("tbody");
  const rows = new Map<string, Row>();
  const element = h("div", {}, h("h3", {}, what.title), h("table", { class: `impacts ${what.className}` },
    h("thead", {}, h("tr", {}, h("th", { scope: "col" }, what.head), ...what.heads.map(([title, unit]) => h("th", { scope: "col" }, title, h("small", {}, ` ${unit}`))))),
    body));
  const rowOf = (name: string): Row => {
    const cells = what.heads.map(() => h("td"));
    const go = (): void => {
      const at = what.placeOf(name);
      if (at) stage.rig.visit(stage.reliefOf(twin.edited.value).local(at[0], at[1], 0.5), 70);
    };
    return { cells, element: h("tr", { onclick: go }, h("th", { scope: "row" }, h("button", { type: "button", title: `${name}: show it` }, name)), ...cells) };
  };
  watchAll([twin.edited, ...what.cells], () => {
    const readings = what.readings();
    element.hidden = readings.length === 0;
    // A row stays between the press and the release of a click.
    const names = readings.map(({ name }) => name);
    for (const name of [...rows.keys()]) if (!names.includes(name)) rows.delete(name);
    for (const reading of readings) {
      const row = rows.get(reading.name) ?? rowOf(reading.name);
      rows.set(reading.name, row);
      row.element.className = what.reached(reading) ? "" : "untouched";
      const texts = what.texts(reading);
      row.cells.forEach((cell, i) => (cell.textContent = texts[i] ?? ""));
    }
    const elements = names.flatMap((name) => rows.get(name)?.element ?? []);
    if (elements.length !== body.children.length || elements.some((each, i) => body.children[i] !== each)) body.replaceChildren(...elements);
  });
  return element;
}

export function gaugeTable(twin: Twin, stage: Stage): HTMLElement {
  return readingTable(twin, stage, {
    title: "Gauges", head: "Gauge", className: "gauges", heads: [["Arrival", "s"], ["Depth", "m"], ["Peak", "m"], ["Peak", "m/s"]], cells: twin.every("gauges"),
    readings: () => twin.now.gauges.value ?? [],
    placeOf: (name) => {
      const gauge = twin.now.setup.value?.gauges.find((g) => g.name === name);
      return gauge ? [gauge.x_m, gauge.y_m] : null;
    },
    reached: (reading) => reading.peak_depth_m > 0,
    texts: (reading) => [fixed(reading.arrival_s, 1), fixed(reading.depth_m, 2), fixed(reading.peak_depth_m, 2), fixed(reading.peak_speed_mps, 1)],
  });
}

export function sectionTable(twin: Twin, stage: Stage): HTMLElement {
  return readingTable(twin, stage, {
    title: "Cross-sections", head: "Cross-section", className: "sections", heads: [["Now", "m³/s"], ["Peak", "m³/s"], ["Passed", "m³"]], cells: twin.every("sections"),
    readings: () => twin.now.sections.value ?? [],
    placeOf: (name) => {
      const section = twin.scene.cross_sections.find((s) => s.name === name);
      return section ? middle(section.line) : null;
    },
    reached: (reading) => reading.peak_discharge_m3ps !== 0,
    texts: (reading) => [fixed(reading.discharge_m3ps, 2), fixed(reading.peak_discharge_m3ps, 2), fixed(reading.passed_m3, 1)],
  });
}
