// Zones, beds and inflows under one heading, folded until needed: most scenes have none.
import type { Drawing } from "../scene/drawing";
import { watchAll } from "../state/cell";
import { itemsOf } from "../state/shapes";
import type { Shape, Twin } from "../state/twin";
import { button, h } from "../ui/dom";
import { shapeSection } from "./shapes";

const shapes: readonly Shape[] = ["zone", "bed", "inflow"];

export function groundGroup(twin: Twin, drawing: Drawing): HTMLElement {
  const count = h("span", { class: "count" });
  const restart = button("Restart", { icon: "restart", class: "small", onclick: () => void twin.restart() });
  const pending = h("div", { class: "pending", role: "status" }, h("span", {}, "Changes to beds, inflows and gauges take effect at the next restart."), restart);
  const group = h("details", { class: "ground-group" }, h("summary", {}, h("h2", {}, "Ground and inflow"), count), pending,
    ...shapes.map((shape) => shapeSection(twin, drawing, shape)));
  let before = 0;
  watchAll([twin.edited, ...twin.every("setup"), twin.selection, twin.tool, twin.you, twin.controller, twin.connection, twin.people], () => {
    const setup = twin.now.setup.value;
    const there = shapes.reduce((sum, shape) => sum + itemsOf(setup, shape).length, 0);
    const tool = twin.tool.value;
    const wanted = tool.kind === "draw" ? tool.shape : twin.selection.value?.shape;
    // If the user folds it, it stays folded until one of its shapes is needed.
    if ((there > 0 && before === 0) || (wanted && shapes.includes(wanted))) group.open = true;
    before = there;
    count.textContent = there > 0 ? String(there) : "";
    pending.hidden = setup?.pending_restart !== true;
    restart.disabled = twin.hindrance !== null;
  });
  return group;
}
