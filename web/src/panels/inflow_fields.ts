// Fields of inflows only: the hydrograph as a table and a chart, and the direction of flow.
import { Chart } from "../charts/chart";
import type { HydrographRow, Inflow } from "../protocol/messages";
import { fields as described } from "../protocol/schema";
import { hasDensity, hydrographKeys, rowsAndOne, rowsOfDensity, rowsWith, rowsWithout, rowsForServer, type HydrographKey } from "../state/inflows";
import { unitText } from "../state/format";
import { button, h } from "../ui/dom";
import { valueField } from "../ui/value_field";

export interface InflowFields {
  element: HTMLElement;
  show(inflow: Inflow): void;
  enable(hindrance: string | null): void;
  end(): void;
}
export interface InflowChange { hydrograph?: HydrographRow[]; direction_deg?: number | null; turn?: true }

const columns = hydrographKeys.map((key): [HydrographKey, string, string] => [key, described.hydrograph[key].label, described.hydrograph[key].unit]);
const text = (value: number | null | undefined): string => (value === null || value === undefined ? "" : String(Number(value.toPrecision(6))));

/** downhill_deg: initial value of a direction; restDensity: initial value of a separate density. */
export function inflowFields(inflow: Inflow, downhill_deg: number, restDensity: number, onset: (change: InflowChange) => void): InflowFields {
  let rows: HydrographRow[] = [];
  let hindered: string | null = null;
  let listed = "";
  const table = h("table", { class: "hydrograph" });
  const chart = new Chart({ title: "Discharge", x: { label: "Time", unit: "s" }, y: { label: "Discharge", unit: "m3/s" }, height: 128, legend: false, empty: "",
    curves: [{ label: "Discharge", unit: "m3/s", colour: "#0a5fae", fill: "rgb(10 95 174 / 0.12)", points: true }] });
  /** place: the new index of a row. */
  const put = (next: HydrographRow[], place?: (row: number) => number): void => {
    rows = next;
    fill(place);
    onset({ hydrograph: rowsForServer(next) });
  };
  const add = button("Add a row", { class: "small", icon: "plus", onclick: () => put(rowsAndOne(rows)) });
  const density = h("input", { type: "checkbox", onchange: () => put(rowsOfDensity(rows, density.checked ? restDensity : null)) });
  const turn = button("Turn round", { class: "small", title: "Debris enters towards the other side of the line", onclick: () => onset({ turn: true }) });
  const direction = valueField({ ...described.inflow.direction_deg, first: downhill_deg }, null, (direction_deg) => onset({ direction_deg }));
  const long = h("p", { class: "hint" }, "Its hydrograph has more than 200 rows and cannot be edited here.");
  const form = h("div", {}, table, h("div", { class: "row" }, add, h("label", { class: "check", title: "Otherwise the debris has the material's rest density" }, density, "Density")), chart.element);

  const cell = (row: number, [key, label, unit]: (typeof columns)[number]): HTMLElement => {
    const input = h("input", { type: "number", step: "any", min: described.hydrograph[key].low, value: text(rows[row][key]), disabled: hindered !== null, "data-cell": `${row} ${key}`,
      "aria-label": `Row ${row + 1}: ${label.toLowerCase()}, ${unitText(unit)}`, onchange: () => {
        const next = rowsWith(rows, row, key, input.valueAsNumber);
        // A change event precedes the move of the focus: the table is rebuilt or sorted after that.
        const before = rows;
        if (next) setTimeout(() => put(next, (k) => (k === row ? next.findIndex((r) => !before.includes(r)) : next.indexOf(before[k]))));
        else input.value = text(rows[row][key]);
      } });
    return h("td", {}, input);
  };
  const fill = (place: (row: number) => number = (row) => row): void => {
    const shown = columns.slice(0, hasDensity(rows) ? 4 : 3);
    const key = JSON.stringify([rows.map((row) => columns.map(([name]) => row[name] ?? null)), hindered]);
    density.checked = hasDensity(rows);
    if (key === listed) return;
    listed = key;
    const held = table.contains(document.activeElement) && document.activeElement instanceof HTMLElement ? document.activeElement : null;
    table.replaceChildren(
      h("thead", {}, h("tr", {}, ...shown.map(([, label, unit]) => h("th", { scope: "col" }, label, h("span", {}, unitText(unit)))), h("td", {}))),
      h("tbody", {}, ...rows.map((_, k) => h("tr", {}, ...shown.map((column) => cell(k, column)),
        h("td", {}, button(`Remove row ${k + 1}`, { icon: "remove", bare: true, class: "bare quiet small", disabled: hindered !== null || rows.length < 3, "data-cell": `${k} away`,
          onclick: () => put(rowsWithout(rows, k)) }))))));
    if (held) keepFocus(held, place);
    table.setAttribute("aria-label", `Hydrograph, ${rows.length} rows`);
    chart.update([rows.map((row) => row.time_s), rows.map((row) => row.discharge_m3ps)]);
  };
  /** The table is rebuilt while in use: the focus and the text being typed are kept. */
  const keepFocus = (held: HTMLElement, place: (row: number) => number): void => {
    const [row, key] = (held.dataset["cell"] ?? "0").split(" ");
    const fresh = table.querySelector<HTMLElement>(`[data-cell="${place(Number(row))} ${key}"]`);
    fresh?.focus();
    if (held instanceof HTMLInputElement && fresh instanceof HTMLInputElement && held.value !== held.defaultValue) fresh.value = held.value;
  };
  const way = h("div", { class: "row" }, turn, h("span", { class: "muted" }, "Debris enters in the direction of the arrows."));
  way.hidden = inflow.line === null;
  direction.element.hidden = inflow.line !== null;
  return {
    element: h("div", { class: "options" }, way, direction.element, long, form),
    show(fresh) {
      form.hidden = fresh.hydrograph === null;
      long.hidden = fresh.hydrograph !== null;
      direction.show(fresh.direction_deg);
      rows = (fresh.hydrograph ?? []).map((row) => ({ ...row }));
      fill();
    },
    enable(hindrance) {
      hindered = hindrance;
      turn.disabled = add.disabled = density.disabled = hindrance !== null;
      direction.enable(hindrance);
      fill();
    },
    end: () => chart.destroy(),
  };
}
