// What the gauges of the scene read: a table whose rows lead to the place.
import type { Stage } from "../scene/stage";
import { watchAll } from "../state/cell";
import { fixed } from "../state/format";
import type { Twin } from "../state/twin";
import { h } from "../ui/dom";

const heads = [["Arrival", "s"], ["Depth", "m"], ["Peak", "m"], ["Peak", "m/s"]] as const;

export function gaugeTable(twin: Twin, stage: Stage): HTMLElement | null {
  const { gauges } = twin.scene;
  if (gauges.length === 0) return null;
  const rows = gauges.map((gauge) => {
    const cells = heads.map(() => h("td"));
    const go = (): void => stage.rig.visit(stage.reliefOf(twin.edited.value).local(gauge.x_m, gauge.y_m, 0.5), 70);
    const name = h("button", { type: "button", title: `${gauge.name}: show it` }, gauge.name);
    return { cells, element: h("tr", { onclick: go }, h("th", { scope: "row" }, name), ...cells) };
  });
  watchAll([twin.edited, ...twin.every("gauges")], () => {
    const readings = twin.now.gauges.value;
    rows.forEach(({ cells, element }, k) => {
      const reading = readings?.[k];
      element.className = (reading?.peak_depth_m ?? 0) > 0 ? "" : "untouched";
      const texts = [fixed(reading?.arrival_s, 1), fixed(reading?.depth_m, 2), fixed(reading?.peak_depth_m, 2), fixed(reading?.peak_speed_mps, 1)];
      cells.forEach((cell, i) => (cell.textContent = texts[i]));
    });
  });
  return h("div", {}, h("h3", {}, "Gauges"), h("table", { class: "impacts gauges" },
    h("thead", {}, h("tr", {}, h("th", { scope: "col" }, "Gauge"), ...heads.map(([title, unit]) => h("th", { scope: "col" }, title, h("small", {}, ` ${unit}`))))),
    h("tbody", {}, ...rows.map((row) => row.element))));
}
