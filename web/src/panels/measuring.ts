// Measuring on the ground: lengths, heights, slopes and areas of a line or an outline that the user draws; its profile.
import type { Point } from "../protocol/messages";
import type { Drawing } from "../scene/drawing";
import type { Stage } from "../scene/stage";
import { watchAll } from "../state/cell";
import { decimalsFor, fixed, quantity } from "../state/format";
import { areaMeasures, lineMeasures } from "../state/measures";
import type { Twin } from "../state/twin";
import { button, h } from "../ui/dom";

export function toggleMeasuring(twin: Twin): void {
  twin.tool.value = twin.tool.value.kind === "measure" ? { kind: "none" } : { kind: "measure" };
}
export function measureButton(twin: Twin): HTMLElement {
  const measure = button("Measure", { icon: "ruler", bare: true, title: "Measure distance, height, slope and area on the ground (M)", onclick: () => toggleMeasuring(twin) });
  twin.tool.watch((tool) => measure.setAttribute("aria-pressed", String(tool.kind === "measure")));
  return measure;
}

/** What is measured, over the view: while a line is drawn, and as long as it is kept. */
export function measuring(twin: Twin, stage: Stage, drawing: Drawing): HTMLElement {
  const values = h("dl", { class: "measures" });
  const how = h("p", { class: "hint" }, "Click points on the ground; double-click or Enter ends.");
  const profile = button("Profile", { icon: "section", class: "small", title: "Ground and debris along this line, in the readings", onclick: () => (twin.section.value = twin.measured.value) });
  const again = button("New line", { class: "small", onclick: () => toggleMeasuring(twin) });
  const remove = button("Remove", { class: "small quiet", onclick: () => (twin.measured.value = null) });
  const box = h("section", { class: "measuring", "aria-label": "Measurement", hidden: true }, how, values, h("div", { class: "row" }, profile, again, remove));
  const show = (): void => {
    const drawn = twin.tool.value.kind === "measure";
    const line = drawn ? drawing.outline : (twin.measured.value ?? []);
    box.hidden = !drawn && twin.measured.value === null;
    how.hidden = !drawn;
    // A click goes through to the ground below.
    box.classList.toggle("drawn", drawn);
    for (const each of [profile, again, remove]) each.hidden = drawn;
    values.replaceChildren(...line.length < 2 ? [] : rows(line, stage, twin).flatMap(([name, value]) => [h("dt", {}, name), h("dd", {}, value)]));
  };
  twin.tool.watch((tool) => {
    // One measurement at a time.
    if (tool.kind === "measure") twin.measured.value = null;
  });
  watchAll([twin.tool, twin.measured, drawing.draft, drawing.pointer, twin.edited, stage.sinkings], show);
  return box;
}

function rows(line: readonly Point[], stage: Stage, twin: Twin): [string, string][] {
  const relief = stage.reliefOf(twin.edited.value);
  const m = lineMeasures(line, relief);
  const inside = areaMeasures(line, relief);
  const digits = decimalsFor(m.plan_m, 1);
  const rows: [string, string][] = [
    ["Distance", `${quantity(m.plan_m, "m")} (${quantity(m.ground_m, "m")} over the ground)`],
    ["Height difference", `${m.rise_m > 0 ? "+" : m.rise_m < 0 ? "−" : ""}${fixed(Math.abs(m.rise_m), digits)}\u202fm (${fixed(m.lowest_m, digits)} to ${fixed(m.highest_m, digits)}\u202fm)`],
    ["Slope", `${fixed(m.slope_deg, 1)}° end to end, up to ${fixed(m.steepest_deg, 0)}°`]];
  if (inside) rows.push(["Area inside", `${quantity(inside.plan_m2, "m2")} (${quantity(inside.ground_m2, "m2")} over the ground)`]);
  return rows;
}
