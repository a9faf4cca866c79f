// The left panel: everything that changes a scenario.
import type { Drawing } from "../scene/drawing";
import { watchAll } from "../state/cell";
import type { Twin } from "../state/twin";
import { button, h } from "../ui/dom";
import { groundGroup } from "./ground_group";
import { parameterFields } from "./parameters";
import { scenarioList } from "./scenarios";
import { shapeSection } from "./shapes";

export function controls(twin: Twin, drawing: Drawing): HTMLElement {
  const why = h("div", { class: "why", role: "status" });
  const undo = button("Undo", { icon: "undo", onclick: () => void twin.act({ action: "undo" }), class: "grow" });
  const redo = button("Redo", { icon: "redo", onclick: () => void twin.act({ action: "redo" }), class: "grow" });
  const undoName = h("div", { class: "undo-name muted" });

  watchAll([twin.edited, twin.you, twin.controller, twin.connection, twin.people, ...twin.every("setup")], () => {
    const hindrance = twin.hindrance;
    why.hidden = hindrance === null;
    why.textContent = hindrance ?? "";
    const setup = twin.now.setup.value;
    for (const [control, sentence, verb, keys] of [[undo, setup?.undo, "Undo", "Ctrl+Z"], [redo, setup?.redo, "Redo", "Ctrl+Shift+Z"]] as const) {
      control.disabled = hindrance !== null || !sentence;
      control.title = hindrance ?? (sentence ? `${verb}: ${sentence} (${keys})` : `Nothing to ${verb.toLowerCase()}`);
    }
    undoName.textContent = setup?.undo ? `Last change: ${setup.undo}` : "No change yet";
  });

  return h("aside", { class: "controls", "aria-label": "Controls" },
    h("div", { class: "group head" }, scenarioList(twin), why, h("div", { class: "row" }, undo, redo), undoName),
    shapeSection(twin, drawing, "release"),
    shapeSection(twin, drawing, "barrier"),
    shapeSection(twin, drawing, "building"),
    groundGroup(twin, drawing),
    parameterFields(twin));
}
