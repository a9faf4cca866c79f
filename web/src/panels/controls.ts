// The left panel: everything that changes a scenario.
import type { Drawing } from "../scene/drawing";
import { watchAll } from "../state/cell";
import type { Twin } from "../state/twin";
import { button, h } from "../ui/dom";
import { groundGroup } from "./ground_group";
import { parameterFields } from "./parameters";
import { scenarioList } from "./scenarios";
import { shapeSection } from "./shapes";

/** A change that takes long: how far it is, and a way out. Laid over what is above it, so that nothing moves. */
function preparing(twin: Twin): HTMLElement {
  const bar = h("progress", { max: "1" });
  const text = h("span", { class: "grow" });
  const cancel = button("Cancel", { class: "small", onclick: () => void twin.act({ action: "cancel" }) });
  const whole = h("div", { class: "row preparing", role: "status" }, text, bar, cancel);
  watchAll([twin.edited, ...twin.every("state"), twin.you, twin.controller, twin.connection], () => {
    const job = twin.now.state.value?.preparing ?? null;
    whole.hidden = job === null;
    if (job) text.textContent = `Preparing: ${job.what}`;
    bar.value = job?.share ?? 0;
    cancel.disabled = twin.hindrance !== null;
  });
  return whole;
}

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
    h("div", { class: "group head" }, scenarioList(twin), why, preparing(twin), h("div", { class: "row" }, undo, redo), undoName),
    shapeSection(twin, drawing, "release"),
    shapeSection(twin, drawing, "barrier"),
    shapeSection(twin, drawing, "building"),
    groundGroup(twin, drawing),
    parameterFields(twin));
}
