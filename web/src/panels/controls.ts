// The left panel: everything that changes a scenario.
import type { ScenarioName } from "../protocol/frame";
import type { Drawing } from "../scene/drawing";
import { watchAll } from "../state/cell";
import type { Twin } from "../state/twin";
import { button, h } from "../ui/dom";
import { groundGroup } from "./ground_group";
import { parameterFields } from "./parameters";
import { shapeSection } from "./shapes";

export function controls(twin: Twin, drawing: Drawing): HTMLElement {
  const why = h("div", { class: "why", role: "status" });
  const undo = button("Undo", { icon: "undo", onclick: () => void twin.act({ action: "undo" }), class: "grow" });
  const redo = button("Redo", { icon: "redo", onclick: () => void twin.act({ action: "redo" }), class: "grow" });
  const undoName = h("div", { class: "undo-name muted" });

  const choice = (name: ScenarioName): HTMLButtonElement => button(`Scenario ${name}`, { "data-scenario": name, onclick: () => (twin.edited.value = name) });
  const [a, b] = [choice("A"), choice("B")];
  const compare = button("Compare", { icon: "compare", title: "A second scenario B with the same setup, from time 0, beside this one",
    onclick: () => void twin.attempt(async () => {
      await twin.api.addScenario();
      twin.edited.value = "B";
    }) });
  const endB = button("End scenario B", { icon: "close", bare: true, onclick: () => void twin.attempt(() => twin.api.endScenario()) });
  const which = h("div", { class: "which", role: "group", "aria-label": "Scenario that these controls change" }, a, b, compare, endB);

  watchAll([twin.scenarios, twin.edited, twin.you, twin.controller, twin.connection, twin.people, twin.cells.A.setup, twin.cells.B.setup], () => {
    const two = twin.scenarios.value.length > 1;
    b.hidden = endB.hidden = !two;
    compare.hidden = two;
    a.setAttribute("aria-pressed", String(twin.edited.value === "A"));
    b.setAttribute("aria-pressed", String(twin.edited.value === "B"));
    const hindrance = twin.hindrance;
    why.hidden = hindrance === null;
    why.textContent = hindrance ?? "";
    const setup = twin.now.setup.value;
    for (const [control, sentence, verb, keys] of [[undo, setup?.undo, "Undo", "Ctrl+Z"], [redo, setup?.redo, "Redo", "Ctrl+Shift+Z"]] as const) {
      control.disabled = hindrance !== null || !sentence;
      control.title = hindrance ?? (sentence ? `${verb}: ${sentence} (${keys})` : `Nothing to ${verb.toLowerCase()}`);
    }
    undoName.textContent = setup?.undo ? `Last change: ${setup.undo}` : "No change yet";
    for (const control of [compare, endB]) control.disabled = hindrance !== null;
  });

  return h("aside", { class: "controls", "aria-label": "Controls" },
    h("div", { class: "group head" }, which, why, h("div", { class: "row" }, undo, redo), undoName),
    shapeSection(twin, drawing, "release"),
    shapeSection(twin, drawing, "barrier"),
    shapeSection(twin, drawing, "building"),
    groundGroup(twin, drawing),
    parameterFields(twin));
}
