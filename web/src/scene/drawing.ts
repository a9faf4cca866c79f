// Tools that work on the ground: draw a shape by clicks, put a probe, draw a cross-section, select and reshape.
import { Raycaster, Vector2 } from "three";
import type { Line2 } from "three/examples/jsm/lines/Line2.js";
import type { Point } from "../protocol/messages";
import { Cell, watchAll } from "../state/cell";
import { change, create } from "../state/edits";
import { arrowsOf } from "../state/inflows";
import { acrossPath } from "../state/measures";
import { groundUnder } from "../state/picking";
import { canReshape, crossesItself, drawnAsLine, fewestPoints, hasOutline, inside, itemOf, lineOf, mostPoints, pointsOf } from "../state/shapes";
import { probeColours, type Selection, type Shape, type Twin } from "../state/twin";
import { h } from "../ui/dom";
import { Handles } from "./handles";
import { disposeLine, pixelLine } from "./lines";
import type { Hit, Stage } from "./stage";

const drawColour = "#d98a00";

/** Lines that belong to the page, not to the setup. */
type Ruled = "section" | "measure";
const isRuled = (shape: Shape | Ruled): shape is Ruled => shape === "section" || shape === "measure";
const subjects: Record<Shape | Ruled, string> = { release: "A release", barrier: "A barrier", building: "A building", zone: "A zone", bed: "A bed", inflow: "An inflow",
  section: "A cross-section", measure: "A measurement" };

/** Nearer than this to the last corner, px, a click is the second of a double click. */
const sameSpot_px = 6;
/** And sooner than this, ms, once a shape of two points is whole. */
const doubleClick_ms = 600;

export class Drawing {
  /** Corners set so far of what is being drawn, or those of the selected shape while it is dragged. */
  readonly draft = new Cell<readonly Point[]>([]);
  /** Where the pointer is on the ground while something is drawn. */
  readonly pointer = new Cell<Point | null>(null);
  private lines: Line2[] = [];
  /** The line was laid across the flow path: it is whole, another point begins a new one. */
  private snapped = false;
  /** The last click that set a corner, in pixels of the page. */
  private lastClick: { x: number; y: number; at_ms: number } | null = null;
  private readonly handles: Handles;
  private readonly crosshair = h("div", { class: "crosshair", hidden: true, "aria-hidden": "true" });

  constructor(private readonly twin: Twin, private readonly stage: Stage) {
    this.handles = new Handles(stage);
    stage.element.append(this.crosshair);
    this.listen();
    twin.tool.watch((tool) => {
      this.snapped = false;
      if (tool.kind !== "none") this.lastClick = null;
      this.draft.value = [];
      this.pointer.value = null;
      stage.element.classList.toggle("drawing", tool.kind !== "none");
      this.crosshair.hidden = tool.kind === "none" || document.activeElement !== stage.canvas;
      if (tool.kind !== "none") twin.selection.value = null;
      this.redraw();
    });
    const reselect = (): void => this.reselect();
    watchAll([twin.selection, twin.edited, ...twin.every("setup"), twin.controller, twin.you, twin.tool], reselect);
  }

  get shape(): Shape | Ruled | null {
    const tool = this.twin.tool.value;
    return tool.kind === "draw" ? tool.shape : tool.kind === "section" || tool.kind === "measure" ? tool.kind : null;
  }
  /** Ends drawing with the current corners. */
  finish(): void {
    const { shape } = this;
    const points = this.draft.value;
    if (shape === null) return;
    const byLine = this.twin.inflowByLine.value;
    const fewest = isRuled(shape) ? 2 : fewestPoints(shape, byLine);
    if (points.length < fewest) {
      this.twin.notice(`${subjects[shape]} needs at least ${fewest} points; click on the ground to add them.`, "error");
      return;
    }
    if (!isRuled(shape) && !drawnAsLine(shape, byLine) && crossesItself(points)) {
      this.twin.notice(`The outline of the ${shape} crosses itself; remove the last point with Backspace.`, "error");
      return;
    }
    this.twin.tool.value = { kind: "none" };
    if (shape === "section") this.twin.section.value = [...points];
    else if (shape === "measure") this.twin.measured.value = [...points];
    else void create(this.twin, shape, points);
  }
  cancel(): void {
    if (this.twin.tool.value.kind !== "none") this.twin.tool.value = { kind: "none" };
    else this.twin.selection.value = null;
  }
  /** Lays the barrier that is drawn across the flow path, where the pointer is nearest to it; else at the middle of the view. */
  snap(): void {
    const { twin, stage } = this;
    const path = twin.scene.flow_path;
    if (this.shape !== "barrier" || !path) return;
    const { target } = stage.rig.controls;
    const [ox, oy] = stage.relief.origin;
    const line = acrossPath(path, this.pointer.value ?? this.draft.value.at(-1) ?? [target.x + ox, target.y + oy], twin.newShape.barrier.height_m ?? 0, stage.reliefOf(twin.edited.value));
    if (!line) return;
    this.snapped = true;
    this.draft.value = line;
    this.redraw();
    // Enter finishes it, in place of pressing the button that began the drawing.
    stage.canvas.focus();
  }
  /** Corners set so far, and where the pointer would set the next one. */
  get outline(): readonly Point[] {
    const { value: draft } = this.draft;
    const { value: next } = this.pointer;
    return draft.length > 0 && next && !this.snapped ? [...draft, next] : draft;
  }
  removeLast(): void {
    this.snapped = false;
    this.lastClick = null;
    this.draft.value = this.draft.value.slice(0, -1);
    this.redraw();
  }
  addPoint(point: Point): void {
    this.draft.value = [...(this.snapped ? [] : this.draft.value), point];
    this.snapped = false;
    this.redraw();
    // A section and an inflow's line are straight: two points define them.
    const { shape } = this;
    if (shape !== null && this.draft.value.length === (shape === "section" ? 2 : shape === "measure" ? Infinity : mostPoints(shape, this.twin.inflowByLine.value))) this.finish();
  }

  private listen(): void {
    const { canvas } = this.stage;
    let down: { x: number; y: number } | null = null;
    canvas.addEventListener("pointerdown", (event) => {
      down = event.button === 0 ? { x: event.clientX, y: event.clientY } : null;
    });
    canvas.addEventListener("pointerup", (event) => {
      const still = down && Math.hypot(event.clientX - down.x, event.clientY - down.y) < 5;
      down = null;
      if (still) this.click(event);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (this.shape === null) return;
      if (!this.atLastClick(event)) this.wakeHandles();
      const hit = this.stage.hit(event.clientX, event.clientY);
      this.pointer.value = hit ? [hit.world[0], hit.world[1]] : null;
      if (this.draft.value.length > 0) this.redraw();
    });
    // Also of the handles, which lie over the canvas.
    const { element } = this.stage;
    element.addEventListener("dblclick", () => {
      if (this.shape !== null) this.finish();
    });
    canvas.addEventListener("focus", () => (this.crosshair.hidden = this.twin.tool.value.kind === "none" || !canvas.matches(":focus-visible")));
    canvas.addEventListener("blur", () => (this.crosshair.hidden = true));
    element.addEventListener("keydown", (event) => {
      if (this.twin.tool.value.kind === "none") return;
      if (event.key === " " && event.target === canvas) {
        // Without a pointer, a point is placed in the middle of the view.
        const middle = this.stage.pixelOf(this.twin.edited.value, 0, 0);
        this.crosshair.hidden = false;
        if (middle) this.put(this.stage.hit(middle.x, middle.y));
      } else if (event.key === "x" && !event.ctrlKey && !event.metaKey) this.snap();
      else if (event.key === "Enter") this.finish();
      else if (event.key === "Backspace") this.removeLast();
      else return;
      event.preventDefault();
      event.stopPropagation();
    });
  }
  private click(event: PointerEvent): void {
    const hit = this.stage.hit(event.clientX, event.clientY);
    const again = this.atLastClick(event);
    if (this.twin.tool.value.kind === "none") {
      // The second click of the pair whose first one has completed a line of two points selects nothing.
      if (!again || event.timeStamp - (this.lastClick?.at_ms ?? 0) > doubleClick_ms) this.select(event, hit);
      return;
    }
    // The second click of a double click sets no corner.
    if (again && this.shape !== null && this.draft.value.length > 0) return;
    const click = (this.lastClick = { x: event.clientX, y: event.clientY, at_ms: event.timeStamp });
    this.put(hit);
    // A finger does not hover: nothing else tells that no second tap follows.
    if (event.pointerType === "touch") setTimeout(() => this.lastClick === click && this.wakeHandles(), doubleClick_ms);
  }
  /** No second click of a pair comes any more: the newest corner can be dragged as well. */
  private wakeHandles(): void {
    if (this.lastClick === null) return;
    this.lastClick = null;
    if (this.shape !== null) this.dots();
  }
  private atLastClick(event: PointerEvent): boolean {
    const { lastClick } = this;
    return lastClick !== null && Math.hypot(event.clientX - lastClick.x, event.clientY - lastClick.y) < sameSpot_px;
  }
  private put(hit: Hit | null): void {
    if (!hit) return;
    const point: Point = [hit.world[0], hit.world[1]];
    if (this.shape !== null) this.addPoint(point);
    else if (this.twin.tool.value.kind === "pin") {
      const { what } = this.twin.tool.value;
      this.twin.tool.value = { kind: "none" };
      this.twin.pinned.value = { what, at: point };
    } else if (this.twin.tool.value.kind === "probe") {
      const used = this.twin.probes.value.length;
      this.twin.probes.value = [...this.twin.probes.value, { at: point, colour: probeColours[used % probeColours.length], series: {} }].slice(-6);
    }
  }
  /** A click without a tool selects the house, barrier or release under it, else the inflow, bed or zone. */
  private select(event: PointerEvent, hit: Hit | null): void {
    const at = this.stage.viewAt(event.clientX, event.clientY);
    const view = at && this.stage.views.get(at.name);
    if (!at || !view) return;
    const { name } = at;
    const ray = new Raycaster();
    ray.setFromCamera(new Vector2(at.x, at.y), this.stage.rig.camera);
    const id = view.solidUnder(ray);
    const setup = this.twin.cells[name].setup.value;
    let selection: Selection | null = null;
    if (id !== null) selection = { shape: setup?.barriers.some((b) => b.id === id) ? "barrier" : "building", id };
    else if (hit && setup) {
      const [x, y] = hit.world;
      const release = setup.releases.find((r) => r.polygons.some(([outer]) => inside(outer, x, y)));
      const { relief, metresPerPixel } = this.stage;
      selection = release ? { shape: "release", id: release.id } : groundUnder(setup, [x, y], 8 * metresPerPixel, relief.width * relief.height);
    }
    if (selection && this.twin.shown.value.length > 1) this.twin.edited.value = name;
    this.twin.selection.value = selection;
  }

  private reselect(): void {
    if (this.handles.busy) return;
    const { twin } = this;
    const item = itemOf(twin.now.setup.value, twin.selection.value);
    if (this.shape === null) {
      this.draft.value = [];
      this.redraw();
    }
    if (!item || !hasOutline(item) || twin.hindrance !== null || twin.tool.value.kind !== "none") {
      this.handles.clear();
      return;
    }
    const points = pointsOf(item);
    // A scar traced from a survey has dozens of corners, and one outline cannot describe several parts: those move as a
    // whole.
    const whole = !canReshape(item) || points.length > 40;
    const isLine = lineOf(item) !== null;
    this.handles.show(item.name, points, twin.edited.value, whole ? "whole" : "all", {
      move: (moved) => {
        this.draft.value = moved;
        this.redraw(!isLine);
      },
      drop: (moved, by) => {
        if (by === null) this.reselect();
        else void change(twin, item, whole && !isLine ? { move_m: by } : { points: moved }).then((fine) => {
          if (!fine) this.reselect();
        });
      },
    });
  }

  private redraw(closed = false): void {
    this.lines.forEach(disposeLine);
    this.lines = [];
    const points = [...this.draft.value];
    const { shape } = this;
    if (shape !== null && this.pointer.value && points.length > 0 && !this.snapped) points.push(this.pointer.value);
    const view = this.stage.views.get(this.twin.edited.value);
    if (view && points.length > 1) {
      const byLine = this.twin.inflowByLine.value;
      const ring = closed || (shape !== null && !isRuled(shape) && !drawnAsLine(shape, byLine) && points.length > 2);
      const strokes = [view.relief.drape(points, 0.4, ring)];
      const flows = shape === null ? this.twin.selection.value?.shape === "inflow" && !closed : shape === "inflow" && byLine;
      if (flows) for (const arrow of arrowsOf(points)) strokes.push(view.relief.drape(arrow, 0.4));
      this.lines = strokes.map((stroke) => pixelLine(stroke, { colour: drawColour, width_px: 2.5, onTop: true }));
      view.overlay.add(...this.lines);
    }
    this.dots();
    this.stage.invalidate();
  }
  private dots(): void {
    if (this.shape === null) {
      if (!this.twin.selection.value) this.handles.clear();
      return;
    }
    this.handles.show("the drawing", this.draft.value, this.twin.edited.value, "corners", {
      move: (moved) => {
        this.draft.value = moved;
      },
      drop: (moved, by) => {
        // A handle that was only clicked stays: the second click of a pair, and Enter, reach it.
        if (by === null) return;
        this.draft.value = moved;
        this.redraw();
      },
      // The newest corner lies under the pointer: its handle would take the second click of a double click, and the focus.
    }, this.lastClick === null ? null : this.draft.value.length - 1);
  }
}
