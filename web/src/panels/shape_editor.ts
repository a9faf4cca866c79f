// The editor of the shape that is selected.
import type { Drawing } from "../scene/drawing";
import { change, remove, type Change } from "../state/edits";
import { fixed, quantity, tick } from "../state/format";
import { peakOf } from "../state/inflows";
import { area, canReshape, footprintArea, hasOutline, itemOf, length, lineOf, partsOf, pointsOf, releaseVolume, type Item } from "../state/shapes";
import type { Shape, Twin } from "../state/twin";
import { button, h } from "../ui/dom";
import { isTyped, put } from "../ui/typed";
import { shapeFields } from "./shape_fields";

const editors = new WeakMap<HTMLElement, { id: string; update(item: Item): void; end(): void }>();

/** Keeps the holder while the same shape is selected, so that a field in use keeps the focus. */
export function showEditor(twin: Twin, drawing: Drawing, shape: Shape, holder: HTMLElement): void {
  const item = itemOf(twin.now.setup.value, twin.selection.value);
  const open = editors.get(holder);
  const key = item?.shape === shape ? `${twin.edited.value} ${item.id}` : null;
  if (item && open && open.id === key) return open.update(item);
  open?.end();
  editors.delete(holder);
  holder.replaceChildren();
  if (item && key !== null) editors.set(holder, { id: key, ...editor(twin, drawing, item, holder) });
}

function editor(twin: Twin, drawing: Drawing, item: Item, holder: HTMLElement): { update(item: Item): void; end(): void } {
  const { shape, id } = item;
  const now = (): Item => itemOf(twin.now.setup.value, { shape, id }) ?? item;
  const send = (what: Change): void => void change(twin, now(), what).then((fine) => {
    // A refused change is reverted in the form too.
    if (!fine) update(now());
  });
  const name = h("input", { type: "text", "aria-label": "Name", maxlength: 60, onchange: () => {
    if (name.value.trim() !== "") send({ name: name.value.trim() });
  } });
  const fields = shapeFields(twin, item, now, send);
  const note = h("p", { class: "hint" });
  const trigger = shape === "release"
    ? button("Trigger", { icon: "trigger", class: "primary small", onclick: () => void twin.act({ action: "trigger_release", id }) }) : null;
  const restart = shape === "bed" || shape === "inflow"
    ? button("Restart", { icon: "restart", class: "small", title: "Back to time 0 with the present setup", onclick: () => void twin.restart() }) : null;
  const away = button("Remove", { icon: "remove", class: "small", onclick: () => void remove(twin, now()) });
  const corners = h("div", { class: "corners" });
  const table = h("details", {}, h("summary", {}, "Coordinates"), corners);
  const measure = h("output", { class: "measure" });
  const update = (fresh: Item): void => {
    const hindrance = twin.hindrance;
    if (!isTyped(name)) put(name, fresh.name);
    name.disabled = away.disabled = hindrance !== null;
    fields.show(fresh);
    fields.enable(hindrance);
    if (trigger) {
      trigger.hidden = fresh.shape === "release" && fresh.status === "released";
      trigger.disabled = hindrance !== null;
    }
    if (restart) {
      restart.hidden = !waits(fresh);
      restart.disabled = hindrance !== null;
    }
    note.textContent = noteOf(fresh);
    note.hidden = note.textContent === "";
    measure.value = measureOf(twin, fresh, pointsOf(fresh), false);
    table.hidden = !hasOutline(fresh);
    fillCorners(twin, fresh, corners, now, send);
  };
  const ended = drawing.draft.watch((draft) => {
    if (draft.length > 0 && twin.tool.value.kind === "none") measure.value = measureOf(twin, now(), draft, true);
  });
  holder.append(name, fields.element, measure, note, h("div", { class: "row" }, trigger, restart, away), table);
  update(item);
  return { update, end: () => {
    ended();
    fields.end?.();
  } };
}

const waits = (item: Item): boolean => (item.shape === "bed" || item.shape === "inflow") && !item.in_force;

function noteOf(item: Item): string {
  const said: string[] = [];
  if (item.shape === "release" && item.status === "released") said.push("Already released: changes take effect at the next restart.");
  if (waits(item)) said.push("Takes effect at the next restart.");
  if (item.shape === "zone" && !hasOutline(item)) said.push("Its shape comes from a raster: its values can be changed here, its shape cannot.");
  if (item.shape === "bed" && !hasOutline(item)) said.push("It covers all ground, or its shape comes from a raster: its values can be changed here, its shape cannot.");
  return said.join(" ");
}

/** moving: the corners are being moved, so that only they are known, not the server's values. */
function measureOf(twin: Twin, item: Item, points: readonly (readonly [number, number])[], moving: boolean): string {
  const ring = points.map(([x, y]): [number, number] => [x, y]);
  const size = canReshape(item) && !lineOf(item) ? area(ring) : footprintArea(partsOf(item));
  switch (item.shape) {
    case "release":
      return `${quantity(area(ring), "m2")}, ${quantity(moving ? releaseVolume(ring, item.thickness_m ?? 0, twin.relief) : item.volume_m3, "m3")}`;
    case "barrier":
      return `${quantity(length(ring), "m")} long`;
    case "building":
      return `${quantity(size, "m2")}, base ${fixed(item.base_m, 1)} m, roof ${fixed(item.roof_m, 1)} m`;
    case "zone":
      return quantity(moving ? size : item.area_m2, "m2");
    case "bed":
      return `${quantity(moving ? size : item.area_m2, "m2")}, ${quantity(moving && item.depth_m !== null ? size * item.depth_m : item.volume_m3, "m3")}`;
    case "inflow":
      return `${item.line ? `${quantity(length(ring), "m")} wide` : quantity(size, "m2")}, ${quantity(item.volume_m3, "m3")}` +
        (item.hydrograph ? `, peak ${tick(peakOf(item.hydrograph))}\u202fm³/s` : "");
  }
}

/** Corners as numbers, for exact positions and for use without a mouse. */
function fillCorners(twin: Twin, item: Item, holder: HTMLElement, now: () => Item, send: (what: Change) => void): void {
  const inputs = (): HTMLInputElement[] => [...holder.querySelectorAll("input")];
  if (inputs().some(isTyped)) return;
  const focused = inputs().findIndex((input) => input === document.activeElement);
  if (focused >= 0) queueMicrotask(() => inputs()[focused]?.focus());
  const disabled = twin.hindrance !== null;
  if (!canReshape(item)) {
    const [east, north] = ["east", "north"].map((way) => h("input", { type: "number", step: "0.1", value: "0", disabled,
      "aria-label": `Move all parts to the ${way} by, m` }));
    const move = button("Move", { class: "small", disabled, onclick: () => {
      const by: [number, number] = [east.valueAsNumber, north.valueAsNumber];
      if (by.every(Number.isFinite)) send({ move_m: by });
      else twin.notice("To move it, give metres to the east and north.", "error");
    } });
    holder.replaceChildren(h("p", { class: "hint" }, "Has several parts or a courtyard: it can be moved as a whole, by metres to the east and north."),
      h("div", { class: "row coordinates" }, east, north, move));
    return;
  }
  const word = lineOf(item) ? (item.shape === "inflow" ? "End" : "Point") : "Corner";
  holder.replaceChildren(...pointsOf(item).map((point, k) => {
    const inputs = point.map((value, axis) => h("input", { type: "number", step: "0.1", value: value.toFixed(2), disabled,
      "aria-label": `${word} ${k + 1}, ${axis === 0 ? "east" : "north"}, m`, onchange: () => {
        send({ points: pointsOf(now()).map((p, i): [number, number] => (i === k ? [inputs[0].valueAsNumber, inputs[1].valueAsNumber] : p)) });
      } }));
    return h("div", { class: "row coordinates" }, h("span", { class: "muted" }, String(k + 1)), ...inputs, h("span", { class: "muted" }, "m"));
  }));
}
