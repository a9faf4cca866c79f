// Releases, barriers, buildings, zones, beds and inflows: lists, drawing, and the editor of the one that is selected.
import { barrierNote } from "../state/barriers";
import { watchAll } from "../state/cell";
import { quantity } from "../state/format";
import { bedNote, zoneNote } from "../state/ground";
import { inflowNote } from "../state/inflows";
import { itemsOf, type Item } from "../state/shapes";
import type { Drawing } from "../scene/drawing";
import type { Shape, Twin } from "../state/twin";
import { button, h } from "../ui/dom";
import { draftBox } from "./draft_box";
import { showEditor } from "./shape_editor";

/** invitation: where something can be drawn; a recording cannot be changed. */
const words: Record<Shape, { title: string; empty: string; invitation: string }> = {
  release: { title: "Releases", empty: "No release.", invitation: " Draw one, then trigger it to start its debris." },
  barrier: { title: "Barriers", empty: "No barrier.", invitation: " Draw a line across the path to hold debris back." },
  building: { title: "Buildings", empty: "No building.", invitation: "" },
  zone: { title: "Zones", empty: "No zone.", invitation: " Draw one where ground resistance differs, such as a forest." },
  bed: { title: "Beds", empty: "No bed.", invitation: " Draw one where debris can entrain loose material." },
  inflow: { title: "Inflows", empty: "No inflow.", invitation: " Draw one where debris enters during the run." },
};
/** Longer ones (the houses of a village) are picked in the view. */
const longestList = 6;

/** Nested sections have lower headings and list all entries, since not every zone can be picked in the view. */
const within: readonly Shape[] = ["zone", "bed", "inflow"];

function noteOf(item: Item): string {
  switch (item.shape) {
    case "release": return `${quantity(item.volume_m3, "m3")}, ${item.status === "held" ? "held" : "released"}`;
    case "barrier": return `${quantity(item.crest_length_m, "m")} long, ${quantity(item.height_m, "m")} high${barrierNote(item)}`;
    case "building": return `${quantity(item.height_m, "m")} high`;
    case "zone": return zoneNote(item);
    case "bed": return bedNote(item);
    case "inflow": return inflowNote(item);
  }
}

export function shapeSection(twin: Twin, drawing: Drawing, shape: Shape): HTMLElement {
  const word = words[shape];
  const article = shape === "inflow" ? "an" : "a";
  const draw = button("Draw", { icon: "plus", class: "small", "data-draw": shape, "aria-label": `Draw ${article} ${shape}`,
    onclick: () => (twin.tool.value = isDrawing() ? { kind: "none" } : { kind: "draw", shape }) });
  const isDrawing = (): boolean => twin.tool.value.kind === "draw" && drawing.shape === shape;
  const count = h("span", { class: "count" });
  const list = h("ul", { class: "items" });
  const drafting = draftBox(twin, drawing, shape);
  const editor = h("div", { class: "editor" });
  const section = h("section", { class: "group", "aria-label": word.title },
    h("div", { class: "group-head" }, h(within.includes(shape) ? "h3" : "h2", {}, word.title), count, draw), list, drafting, editor);
  let listed = "";
  let before: string | null = null;

  const refresh = (): void => {
    const items = itemsOf(twin.now.setup.value, shape).map((item) => ({ id: item.id, name: item.name, from_scene: item.from_scene, note: noteOf(item) }));
    const chosen = twin.selection.value?.shape === shape ? twin.selection.value.id : null;
    count.textContent = items.length > 0 ? String(items.length) : "";
    draw.disabled = twin.hindrance !== null;
    draw.title = twin.hindrance ?? `Draw a new ${shape} on the ground`;
    draw.setAttribute("aria-pressed", String(isDrawing()));
    // Long lists (the houses of a village) show what was added and what is selected; the rest is picked in the view.
    const shown = items.length <= longestList || within.includes(shape) ? items : items.filter((i) => !i.from_scene || i.id === chosen);
    const key = JSON.stringify([shown, chosen, items.length]);
    if (key !== listed) {
      listed = key;
      const held = document.activeElement instanceof HTMLElement ? document.activeElement.dataset["item"] : undefined;
      list.replaceChildren(...shown.map((item) => h("li", {}, h("button", { type: "button", class: "item", "data-item": item.id,
        "aria-pressed": String(item.id === chosen), onclick: () => (twin.selection.value = item.id === chosen ? null : { shape, id: item.id }) },
      h("b", {}, item.name), h("span", { class: "muted" }, item.note)))));
      if (shown.length < items.length) {
        list.append(h("li", { class: "hint" }, `${items.length - shown.length} from the scene: click one in the view to select it.`));
      }
      if (items.length === 0) list.append(h("li", { class: "hint" }, twin.can.change ? word.empty + word.invitation : word.empty));
      if (held) list.querySelector<HTMLElement>(`[data-item="${CSS.escape(held)}"]`)?.focus();
    }
    const opens = (drafting.hidden && isDrawing()) || (chosen !== null && chosen !== before);
    before = chosen;
    drafting.hidden = !isDrawing();
    showEditor(twin, drawing, shape, editor);
    // After its group has opened.
    if (opens) queueMicrotask(() => reveal(section));
  };
  watchAll([twin.edited, ...twin.every("setup"), twin.selection, twin.tool, twin.you, twin.controller, twin.connection, twin.people], refresh);
  return section;
}

/** Scrolls the panel until a whole section is visible, or its heading is at the top. */
function reveal(section: HTMLElement): void {
  const panel = section.closest(".controls");
  if (!panel) return;
  const [inner, outer] = [section.getBoundingClientRect(), panel.getBoundingClientRect()];
  if (inner.bottom > outer.bottom) panel.scrollTop += Math.min(inner.bottom - outer.bottom, inner.top - outer.top);
  else if (inner.top < outer.top) panel.scrollTop += inner.top - outer.top;
}
