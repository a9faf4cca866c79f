// Releases, barriers and buildings: lists, drawing, and the editor of the one that is selected.
import type { Setup } from "../protocol/messages";
import type { Drawing } from "../scene/drawing";
import { watchAll } from "../state/cell";
import { change, remove } from "../state/edits";
import { fixed, number, quantity } from "../state/format";
import { area, canReshape, fewestPoints, itemOf, length, pointsOf, releaseVolume, type Item } from "../state/shapes";
import type { Shape, Twin } from "../state/twin";
import { button, h, type IconName } from "../ui/dom";
import { numberField, type NumberField } from "../ui/field";

const words: Record<Shape, { title: string; draw: string; icon: IconName; empty: string; how: string }> = {
  release: { title: "Releases", draw: "Draw", icon: "polygon", empty: "No release. Draw one: debris starts from it when you trigger it.",
    how: "Click corners on the ground; double-click or Enter closes the outline." },
  barrier: { title: "Barriers", draw: "Draw", icon: "barrier", empty: "No barrier. Draw a line across the path to hold debris back.",
    how: "Click points along the line; double-click or Enter ends it." },
  building: { title: "Buildings", draw: "Draw", icon: "house", empty: "No building.", how: "Click the corners of the footprint; double-click or Enter closes it." },
};
const longestList = 6;

function itemsOf(setup: Setup | null, shape: Shape): { id: string; name: string; note: string; from_scene: boolean }[] {
  if (!setup) return [];
  if (shape === "release") {
    return setup.releases.map((r) => ({ id: r.id, name: r.name, from_scene: r.from_scene,
      note: `${quantity(r.volume_m3, "m3")}, ${r.status === "held" ? "held" : "released"}` }));
  }
  if (shape === "barrier") {
    return setup.barriers.map((b) => ({ id: b.id, name: b.name, from_scene: b.from_scene, note: `${quantity(b.crest_length_m, "m")} long, ${quantity(b.height_m, "m")} high` }));
  }
  return setup.buildings.map((b) => ({ id: b.id, name: b.name, from_scene: b.from_scene, note: `${quantity(b.height_m, "m")} high` }));
}

export function shapeSection(twin: Twin, drawing: Drawing, shape: Shape): HTMLElement {
  const word = words[shape];
  const draw = button(word.draw, { icon: "plus", class: "small", "data-draw": shape, title: `Draw a new ${shape} on the ground`,
    onclick: () => (twin.tool.value = isDrawing() ? { kind: "none" } : { kind: "draw", shape }) });
  const isDrawing = (): boolean => twin.tool.value.kind === "draw" && drawing.shape === shape;
  const count = h("span", { class: "count" });
  const list = h("ul", { class: "items" });
  const drafting = draftBox(twin, drawing, shape);
  const editor = h("div", { class: "editor" });
  let listed = "";

  const refresh = (): void => {
    const items = itemsOf(twin.now.setup.value, shape);
    const chosen = twin.selection.value?.shape === shape ? twin.selection.value.id : null;
    count.textContent = items.length > 0 ? String(items.length) : "";
    draw.disabled = twin.hindrance !== null;
    draw.title = twin.hindrance ?? `Draw a new ${shape} on the ground`;
    draw.setAttribute("aria-pressed", String(isDrawing()));
    // Long lists (the houses of a village) show what was added and what is selected; the rest is picked in the view.
    const shown = items.length <= longestList ? items : items.filter((i) => !i.from_scene || i.id === chosen);
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
      if (items.length === 0) list.append(h("li", { class: "hint" }, word.empty));
      if (held) list.querySelector<HTMLElement>(`[data-item="${CSS.escape(held)}"]`)?.focus();
    }
    drafting.hidden = !isDrawing();
    showEditor(twin, drawing, shape, editor);
  };
  watchAll([twin.edited, twin.cells.A.setup, twin.cells.B.setup, twin.selection, twin.tool, twin.you, twin.controller, twin.connection, twin.people], refresh);
  return h("section", { class: "group", "aria-label": word.title },
    h("div", { class: "group-head" }, h("h2", {}, word.title), count, draw), list, drafting, editor);
}

interface Sizes { thickness_m?: number | null; height_m?: number | null }

function sizeFields(shape: Shape, value: Sizes, onset: (key: "thickness_m" | "height_m", value: number) => void): NumberField[] {
  const fields: NumberField[] = [];
  if (shape !== "release") {
    fields.push(numberField({ label: "Height", unit: "m", low: 0.01, high: 1000, sliderLow: 0.5, sliderHigh: shape === "barrier" ? 15 : 40,
      value: value.height_m ?? null, help: "Above the ground", onset: (v) => onset("height_m", v) }));
  }
  if (shape !== "building") {
    fields.push(numberField({ label: "Thickness", unit: "m", low: 0.01, high: 1000, sliderLow: 0.1, sliderHigh: shape === "barrier" ? 5 : 10,
      value: value.thickness_m ?? null, help: shape === "release" ? "Normal to the slope" : "Across the line", onset: (v) => onset("thickness_m", v) }));
  }
  return fields;
}

/** What is shown while a new shape is drawn: how to, sizes, live measures, and a way without a mouse. */
function draftBox(twin: Twin, drawing: Drawing, shape: Shape): HTMLElement {
  const sizes: { thickness_m?: number; height_m?: number } = twin.newShape[shape];
  const measure = h("output", { class: "measure", "aria-live": "polite" });
  const done = button("Finish", { class: "primary small", onclick: () => drawing.finish() });
  const fields = sizeFields(shape, sizes, (key, value) => {
    sizes[key] = value;
    show();
  });
  const east = h("input", { type: "number", step: "any", "aria-label": "East of the next point, m", placeholder: "E, m" });
  const north = h("input", { type: "number", step: "any", "aria-label": "North of the next point, m", placeholder: "N, m" });
  const add = button("Add point", { class: "small", onclick: () => {
    if (Number.isFinite(east.valueAsNumber) && Number.isFinite(north.valueAsNumber)) drawing.addPoint([east.valueAsNumber, north.valueAsNumber]);
    else twin.notice("A point needs an east and a north coordinate in metres.", "error");
  } });
  const show = (): void => {
    const points = [...drawing.draft.value];
    done.disabled = points.length < fewestPoints[shape];
    if (drawing.shape !== shape) return;
    measure.value = points.length < fewestPoints[shape]
      ? `${points.length} of at least ${fewestPoints[shape]} points`
      : shape === "release" ? `${number(area(points))} m² × ${number(sizes.thickness_m)} m = ${quantity(releaseVolume(points, sizes.thickness_m ?? 0, twin.relief), "m3")}`
        : shape === "barrier" ? `${quantity(length(points), "m")} long` : `${quantity(area(points), "m2")}`;
  };
  drawing.draft.watch(show);
  return h("div", { class: "draft" }, h("p", { class: "hint" }, `${words[shape].how} Backspace takes the last one back, Escape cancels.`),
    ...fields.map((f) => f.element), measure,
    h("details", {}, h("summary", {}, "By coordinates"), h("div", { class: "row coordinates" }, east, north, add)),
    h("div", { class: "row" }, done, button("Cancel", { class: "small", onclick: () => drawing.cancel() })));
}

const editors = new WeakMap<HTMLElement, { id: string; update(item: Item): void }>();

function showEditor(twin: Twin, drawing: Drawing, shape: Shape, holder: HTMLElement): void {
  const item = itemOf(twin.now.setup.value, twin.selection.value);
  if (!item || item.shape !== shape) {
    holder.replaceChildren();
    editors.delete(holder);
    return;
  }
  const key = `${twin.edited.value} ${item.id}`;
  const open = editors.get(holder);
  if (open?.id === key) {
    open.update(item);
    return;
  }
  const now = (): Item => itemOf(twin.now.setup.value, { shape, id: item.id }) ?? item;
  const name = h("input", { type: "text", "aria-label": "Name", maxlength: 60, onchange: () => {
    if (name.value.trim() !== "") void change(twin, now(), { name: name.value.trim() });
  } });
  const fields = sizeFields(shape, item, (field, value) => void change(twin, now(), { [field]: value }));
  const note = h("p", { class: "hint" });
  const trigger = shape === "release"
    ? button("Trigger", { icon: "trigger", class: "primary small", onclick: () => void twin.act({ action: "trigger_release", id: item.id }) }) : null;
  const away = button("Remove", { icon: "remove", class: "small", onclick: () => void remove(twin, now()) });
  const corners = h("div", { class: "corners" });
  const table = h("details", {}, h("summary", {}, "Coordinates"), corners);
  const measure = h("output", { class: "measure" });
  const update = (fresh: Item): void => {
    const hindrance = twin.hindrance;
    if (document.activeElement !== name) name.value = fresh.name;
    name.disabled = away.disabled = hindrance !== null;
    const values = fresh.shape === "release" ? [fresh.thickness_m] : fresh.shape === "barrier" ? [fresh.height_m, fresh.thickness_m] : [fresh.height_m];
    fields.forEach((f, i) => {
      f.show(values[i] ?? null);
      f.enable(hindrance);
    });
    if (trigger) {
      trigger.hidden = fresh.shape === "release" && fresh.status === "released";
      trigger.disabled = hindrance !== null;
    }
    note.textContent = fresh.shape === "release" && fresh.status === "released" ? "Already released: changes hold from the next restart." : "";
    note.hidden = note.textContent === "";
    showMeasure(fresh, pointsOf(fresh));
    fillCorners(twin, fresh, corners, now);
  };
  const showMeasure = (fresh: Item, points: readonly (readonly [number, number])[]): void => {
    const ring = points.map(([x, y]): [number, number] => [x, y]);
    measure.value = fresh.shape === "release"
      ? `${quantity(area(ring), "m2")}, ${quantity(drawing.draft.value.length > 2 ? releaseVolume(ring, fresh.thickness_m ?? 0, twin.relief) : fresh.volume_m3, "m3")}`
      : fresh.shape === "barrier" ? `${quantity(length(ring), "m")} long`
        : `${quantity(area(ring), "m2")}, base ${fixed(fresh.base_m, 1)} m, roof ${fixed(fresh.roof_m, 1)} m`;
  };
  const ended = drawing.draft.watch((draft) => {
    if (!holder.isConnected || editors.get(holder)?.id !== key) return queueMicrotask(() => ended());
    if (draft.length > 0 && twin.tool.value.kind === "none") showMeasure(now(), draft);
  });
  holder.replaceChildren(name, ...fields.map((f) => f.element), measure, note, h("div", { class: "row" }, trigger, away), table);
  editors.set(holder, { id: key, update });
  update(item);
}

/** Corners as numbers, for exact places and for those who use no mouse. */
function fillCorners(twin: Twin, item: Item, holder: HTMLElement, now: () => Item): void {
  if (holder.contains(document.activeElement)) return;
  const points = pointsOf(item);
  holder.replaceChildren(...points.map((point, k) => {
    const inputs = point.map((value, axis) => h("input", { type: "number", step: "0.1", value: value.toFixed(2), disabled: twin.hindrance !== null || !canReshape(item),
      "aria-label": `Corner ${k + 1}, ${axis === 0 ? "east" : "north"}, m`, onchange: () => {
        const moved = pointsOf(now()).map((p, i): [number, number] => (i === k ? [inputs[0].valueAsNumber, inputs[1].valueAsNumber] : p));
        void change(twin, now(), { points: moved });
      } }));
    return h("div", { class: "row coordinates" }, h("span", { class: "muted" }, String(k + 1)), ...inputs, h("span", { class: "muted" }, "m"));
  }));
}
