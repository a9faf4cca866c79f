// What the gauges of a run read: a table whose rows lead to the place.
import type { Stage } from "../scene/stage";
import { watchAll } from "../state/cell";
import { fixed } from "../state/format";
import type { Twin } from "../state/twin";
import { h } from "../ui/dom";

const heads = [["Arrival", "s"], ["Depth", "m"], ["Peak", "m"], ["Peak", "m/s"]] as const;

interface Row { element: HTMLElement; cells: HTMLElement[] }

export function gaugeTable(twin: Twin, stage: Stage): HTMLElement {
  const body = h("tbody");
  const rows = new Map<string, Row>();
  const element = h("div", {}, h("h3", {}, "Gauges"), h("table", { class: "impacts gauges" },
    h("thead", {}, h("tr", {}, h("th", { scope: "col" }, "Gauge"), ...heads.map(([title, unit]) => h("th", { scope: "col" }, title, h("small", {}, ` ${unit}`))))),
    body));
  const rowOf = (name: string): Row => {
    const cells = heads.map(() => h("td"));
    const go = (): void => {
      const gauge = twin.now.setup.value?.gauges.find((g) => g.name === name);
      if (gauge) stage.rig.visit(stage.reliefOf(twin.edited.value).local(gauge.x_m, gauge.y_m, 0.5), 70);
    };
    return { cells, element: h("tr", { onclick: go }, h("th", { scope: "row" }, h("button", { type: "button", title: `${name}: show it` }, name)), ...cells) };
  };
  watchAll([twin.edited, ...twin.every("gauges")], () => {
    const readings = twin.now.gauges.value ?? [];
    element.hidden = readings.length === 0;
    // A row stays between the press and the release of a click.
    const names = readings.map(({ name }) => name);
    for (const name of [...rows.keys()]) if (!names.includes(name)) rows.delete(name);
    for (const reading of readings) {
      const row = rows.get(reading.name) ?? rowOf(reading.name);
      rows.set(reading.name, row);
      row.element.className = reading.peak_depth_m > 0 ? "" : "untouched";
      const texts = [fixed(reading.arrival_s, 1), fixed(reading.depth_m, 2), fixed(reading.peak_depth_m, 2), fixed(reading.peak_speed_mps, 1)];
      row.cells.forEach((cell, i) => (cell.textContent = texts[i]));
    }
    const elements = names.flatMap((name) => rows.get(name)?.element ?? []);
    if (elements.length !== body.children.length || elements.some((each, i) => body.children[i] !== each)) body.replaceChildren(...elements);
  });
  return element;
}
