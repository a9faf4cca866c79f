// A parameter that can be varied, with the range in which it is.
import type { Parameter } from "../protocol/messages";
import { unitText } from "../state/format";
import { firstRange, rangeProblem } from "../state/misfit";
import { freshId, h } from "./dom";

export interface RangeRow { parameter: Parameter; element: HTMLElement; free: HTMLInputElement; ends: [HTMLInputElement, HTMLInputElement] }

export const capital = (text: string): string => text.charAt(0).toUpperCase() + text.slice(1);

export function rangeRow(parameter: Parameter, present: number | null, chosen: boolean, range = firstRange(parameter, present)): RangeRow {
  const id = freshId("free");
  const end = (what: string, value: number): HTMLInputElement => h("input", { type: "number", step: "any", value, "aria-label": `${capital(what)} ${parameter.label}`, title: `${capital(what)} value that is tried` });
  const ends: [HTMLInputElement, HTMLInputElement] = [end("lowest", range[0]), end("highest", range[1])];
  const free = h("input", { type: "checkbox", id, "data-free": parameter.key });
  free.checked = chosen;
  const element = h("div", { class: "free" }, free, h("label", { for: id, title: parameter.help }, capital(parameter.label)), ends[0], h("span", { class: "muted" }, "to"), ends[1],
    h("span", { class: "unit muted" }, unitText(parameter.unit)));
  return { parameter, element, free, ends };
}

/** The ranges of those that are chosen, or why they cannot be used. */
export function rangesOf(rows: readonly RangeRow[]): { key: string; low: number; high: number }[] | string {
  const chosen = rows.filter((row) => row.free.checked);
  const ranges = chosen.map((row) => ({ key: row.parameter.key, low: row.ends[0].valueAsNumber, high: row.ends[1].valueAsNumber }));
  const problem = chosen.map((row, i) => rangeProblem(row.parameter, ranges[i].low, ranges[i].high)).find((p) => p !== null);
  return problem ?? (chosen.length === 0 ? "Choose at least one free parameter." : ranges);
}
