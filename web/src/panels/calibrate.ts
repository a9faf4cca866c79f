// Calibration: finds the values that explain the field observations, while the live run continues.
import type { CalibrationStatus } from "../protocol/messages";
import { watchAll } from "../state/cell";
import { number, quantity, unitText } from "../state/format";
import { progressText, runsAfterChoice, startsFree } from "../state/misfit";
import type { Twin } from "../state/twin";
import { button, h } from "../ui/dom";
import { capital, rangeRow, rangesOf } from "../ui/range_row";
import { MisfitMap } from "./misfit_map";

const usualRuns = 40;
const runsBesideFast = 10;

function observationTable(status: CalibrationStatus): HTMLElement {
  const ran = status.observations.some((o) => o.best !== null || o.deviation !== null);
  const sign = { equal: "", at_least: "at least ", below: "below " };
  return h("table", { class: "plain observed" }, h("thead", {}, h("tr", {}, h("th", { scope: "col" }, "Observation"), h("td", {}, "Observed"), ran ? h("td", {}, "Best run") : null)),
    h("tbody", {}, ...status.observations.map((o) => h("tr", { title: o.deviation === null ? "" : `${number(Math.abs(o.deviation), 2)} standard deviations from the observation` },
      h("th", { scope: "row" }, o.name), h("td", {}, `${sign[o.is]}${number(o.observed)} ± ${quantity(o.uncertainty, o.unit, 2)}`),
      ran ? h("td", {}, o.best === null ? "none" : quantity(o.best, o.unit)) : null))));
}

function resultTable(status: CalibrationStatus): HTMLElement | null {
  const { result } = status;
  if (!result) return null;
  return h("table", { class: "plain found" }, h("caption", {}, "Best fit"),
    h("thead", {}, h("tr", {}, h("th", { scope: "col" }, "Parameter"), h("td", {}, "Best"), h("td", { title: "Of the posterior" }, "Median"), h("td", { title: "Contains 95 % of the posterior" }, "95\u202f% interval"))),
    h("tbody", {}, ...result.parameters.map((p) => {
      const about = status.parameters.find((q) => q.key === p.key);
      const unit = about?.unit ? `, ${unitText(about.unit)}` : "";
      return h("tr", { title: `The interval is ${number(100 * p.share_of_prior_width, 2)} % as wide as before the observations` },
        h("th", { scope: "row" }, capital(about?.label ?? p.key) + unit), h("td", {}, h("b", {}, number(p.best))), h("td", {}, number(p.median)),
        h("td", {}, `${number(p.low_95)} – ${number(p.high_95)}`));
    })));
}

/** The engine names parameters by their keys; the page by their labels. */
const inWords = (warning: string, status: CalibrationStatus): string =>
  capital(status.parameters.reduce((text, p) => text.replaceAll(p.key, p.label), warning));

function warnings(status: CalibrationStatus): HTMLElement | null {
  const list = status.result?.warnings ?? [];
  if (list.length === 0) return null;
  return h("details", { class: "why", open: true }, h("summary", {}, h("b", {}, `Warnings (${list.length})`)), h("ul", {}, ...list.map((w) => h("li", {}, inWords(w, status)))));
}

const inList = (names: readonly string[]): string => names.join(", ").replace(/, ([^,]*)$/, " or $1");

export function calibratePanel(twin: Twin): HTMLElement {
  const choices = twin.scene.parameters.map((p) => rangeRow(p, twin.now.setup.value?.parameters[p.key] ?? null, startsFree(p, false)));
  const first = choices.filter((c) => c.free.checked);
  const others = choices.filter((c) => !c.free.checked);
  const runs = h("input", { type: "number", min: 8, max: 2000, step: 1, value: usualRuns, "aria-label": "Runs at most" });
  const two = h("input", { type: "checkbox", "aria-describedby": "two-models-help" });
  let runsTyped = false;
  runs.addEventListener("input", () => (runsTyped = true));
  /** Those of no use to the fast model, with whether they are free without it. */
  const unused = choices.filter((c) => !c.parameter.used_by_depth_averaged).map((choice) => ({ choice, free: choice.free.checked }));
  const unusedNote = h("p", { class: "hint", hidden: true }, `The depth-averaged model does not use ${inList(unused.map(({ choice }) => choice.parameter.label))}.`);
  two.addEventListener("change", () => {
    runs.value = String(runsAfterChoice(runsTyped, runs.valueAsNumber, two.checked ? runsBesideFast : usualRuns));
    runs.min = two.checked ? "3" : "8";
    for (const one of unused) {
      if (two.checked) one.free = one.choice.free.checked;
      one.choice.free.checked = !two.checked && one.free;
    }
    unusedNote.hidden = !two.checked || unused.length === 0;
    show();
  });
  const problem = h("p", { class: "field-note", role: "alert" });
  let successor: HTMLButtonElement | null = null;  // of a pressed button that disappears: it gets the keyboard focus
  const start = button("Start", { class: "primary", onclick: () => void begin() });
  const begin = async (): Promise<void> => {
    const ranges = rangesOf(choices);
    problem.textContent = typeof ranges === "string" ? ranges : "";
    if (typeof ranges === "string") return;
    start.disabled = true;
    successor = cancel;
    if (!await twin.attempt(() => twin.api.calibrate(ranges, runs.valueAsNumber, two.checked ? "depth_averaged" : null))) successor = null;
    show();
  };
  const heading = h("h3", {});
  const form = h("div", { class: "calibrate-form" }, heading, ...first.map((c) => c.element),
    others.length === 0 ? null : h("details", {}, h("summary", {}, "More parameters"), ...others.map((c) => c.element)),
    h("label", { class: "two-models" }, two, "Search with the depth-averaged model"),
    h("p", { class: "hint", id: "two-models-help" }, "It takes seconds per run: up to 100 of its runs search, and particles run only where they are needed to confirm."), unusedNote,
    h("div", { class: "row" }, h("label", { class: "row runs", title: "Two parameters need some 30 to 60" }, "Runs at most", runs), h("span", { class: "spring" }), start), problem);

  const map = new MisfitMap();
  const bar = h("progress", { "aria-label": "Runs done" });
  const progress = h("p", { class: "calibrate-progress", role: "status" });
  const cancel = button("Cancel", { class: "small", onclick: async () => {
    successor = start;
    if (!await twin.attempt(() => twin.api.cancelCalibration())) successor = null;
  } });
  const going = h("div", { class: "calibrate-going" }, progress, h("div", { class: "row" }, bar, cancel));
  const observed = h("div", {});
  const found = h("div", {});
  const use = button("Use these values", { class: "primary", onclick: () => {
    const status = twin.calibration.value;
    const best = status?.best;
    if (!status || !best) return;
    // More digits would only suggest a false precision.
    void twin.act({ action: "set_parameters", values: Object.fromEntries(status.parameters.map((p, i) => [p.key, Number(best.values[i].toPrecision(4))])) });
  } });
  const why = h("p", { class: "hint calibrate-why" });
  const about = h("p", { class: "hint" }, "Finds the values that explain the field observations. The runs use the scene as it was opened, with the observations of scenario A but no other changes made in the page; the live run continues alongside.");
  const table = h("details", {}, h("summary", {}, "All runs"));
  const element = h("div", { class: "calibrate" }, about, why, going, map.element, found, table, observed, form);

  const fillRuns = (status: CalibrationStatus): void => {
    const head = h("tr", {}, h("th", { scope: "col" }, "Run"), ...status.parameters.map((p) => h("td", {}, capital(p.label))), h("td", {}, "Misfit"));
    table.replaceChildren(h("summary", {}, "All runs"), h("table", { class: "plain" }, h("thead", {}, head), h("tbody", {},
      ...[...status.runs.map((r, k) => ({ r, name: `${k + 1}, ${r.phase}` })), ...status.fast_runs.map((r, k) => ({ r, name: `${k + 1}, depth-averaged, ${r.phase}` }))]
        .map(({ r, name }) => h("tr", {}, h("th", { scope: "row" }, name), ...r.values.map((v) => h("td", {}, number(v))), h("td", {}, r.misfit === null ? "failed" : number(r.misfit)))))));
  };
  let told: CalibrationStatus | null = null;
  const show = (): void => {
    const status = twin.calibration.value;
    const possible = status !== null && status.why_not === null;
    why.hidden = possible;
    why.textContent = status?.why_not ?? "";
    about.hidden = !possible || status.state !== "idle";
    heading.textContent = status === null || status.state === "idle" ? "Free parameters and their ranges" : "Run again";
    for (const part of [observed, form]) part.hidden = !possible;
    const ran = possible && status.state !== "idle";
    const runningNow = ran && (status.state === "running" || status.state === "cancelling");
    for (const part of [going, map.element]) part.hidden = !ran;
    found.hidden = !ran || runningNow || status.best === null;
    table.hidden = !ran || status.runs.length + status.fast_runs.length === 0;
    form.hidden = !possible || runningNow;
    if (!possible) return;
    const hindrance = twin.hindrance;
    start.disabled = use.disabled = hindrance !== null;
    start.title = hindrance ?? "Runs beside the live run, at lower priority";
    for (const { parameter, free, ends } of choices) {
      free.disabled = hindrance !== null || (two.checked && !parameter.used_by_depth_averaged);
      for (const end of ends) end.disabled = hindrance !== null || !free.checked;
    }
    runs.disabled = two.disabled = hindrance !== null;
    cancel.disabled = hindrance !== null || status.state === "cancelling";
    cancel.hidden = bar.hidden = !runningNow;
    if (successor === (runningNow ? cancel : start) && !successor.disabled) {
      successor.focus();
      successor = null;
    }
    observed.replaceChildren(observationTable(status));
    if (!ran) return;
    bar.max = Math.max(1, status.runs_at_most + status.fast_runs_at_most);
    bar.value = status.runs.length + status.fast_runs.length;
    const sentence = progressText(status) + (status.state === "running" && status.by ? ` · started by ${status.by}` : "");
    if (progress.textContent !== sentence) progress.textContent = sentence;
    progress.classList.toggle("bad", status.state === "failed");
    const setup = twin.now.setup.value;
    map.update(status, status.parameters.map((p) => setup?.parameters[p.key] ?? null));
    if (told !== status) found.replaceChildren(...[resultTable(status), use, warnings(status)].filter((e): e is HTMLElement => e !== null));
    use.title = hindrance ?? `${status.parameters.map((p, i) => `${p.label} ${quantity(status.best?.values[i], p.unit, 4)}`).join(", ")}: sets them in scenario ${twin.edited.value}; one undo takes it back`;
    if (told !== status) fillRuns(status);
    told = status;
  };
  for (const { free } of choices) free.addEventListener("change", show);
  watchAll([twin.calibration, twin.edited, twin.you, twin.controller, twin.connection, twin.people, ...twin.every("setup")], show);
  return element;
}
