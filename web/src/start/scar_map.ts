// A terrain from above on which the outline of a release is drawn: contours, slope, scale, and the way downhill from the outline.
import type { Grid } from "../protocol/grid";
import { gridAt } from "../protocol/grid";
import type { Point } from "../protocol/messages";
import { Relief } from "../scene/relief";
import { fixed, quantity, tick } from "../state/format";
import { groundMeasures, within } from "../state/measures";
import { area, length } from "../state/shapes";
import { button, h } from "../ui/dom";
import { contourInterval, contours, partOf, type Contour } from "./contours";
import { descent, type Descent } from "./descent";
import { MapPaint } from "./map_paint";
import { fitted, groundAt, panned, pixelAt, zoomed, type MapView, type Size } from "./map_view";
import { shaded, slopeAt, slopeClasses } from "./slope";

/** Pixels within which a corner is meant, by a pointer and by a finger. */
const near_px = 10;
const finger_px = 22;
/** A pointer that moves less is held still. */
const still_px = 4;
/** Distance on the screen of the heights from which contours are drawn. */
const contour_px = 3;
/** A key press moves the cross so far; with Shift for placing it. */
const step_px = 16;
const fine_px = 2;
/** The cross stays so far from the edge: the map moves instead. */
const edge_px = 20;
const button_zoom = 1.6;

interface Held { at: Point; corner: number | null; moved: boolean }

export class ScarMap {
  private readonly keys = h("p", { class: "hint scar-keys", id: "scar-keys" }, "Arrows move the cross (Shift: finely). Space sets a corner, takes one up and puts it down; Enter closes the outline; Backspace removes the last corner. + and − zoom, Home shows the whole terrain.");
  private readonly canvas = h("canvas", { class: "scar-map", tabindex: 0, role: "application", "aria-label": "Map of the terrain: set the corners of the release", "aria-describedby": this.keys.id });
  private readonly place = h("output", { class: "muted scar-place" });
  private readonly told = h("p", { class: "hint", role: "status" });
  private readonly facts = h("p", { class: "scar-facts", "aria-live": "polite" });
  private readonly about = h("p", { class: "hint" });
  private readonly back = button("Undo corner", { icon: "undo", class: "small", onclick: () => this.undo() });
  private readonly again = button("Draw again", { class: "small", onclick: () => this.clear() });
  private readonly slope = h("input", { type: "checkbox", onchange: () => this.shade() });
  private readonly legend = h("div", { class: "row scar-legend", hidden: true }, ...slopeClasses.map(({ name, colour }) => {
    const swatch = h("i", {});
    swatch.style.background = `rgb(${colour.join(" ")})`;
    return h("span", {}, swatch, name);
  }));
  readonly element = h("div", { class: "scar-box" }, this.canvas, this.keys,
    h("div", { class: "row scar-tools" }, this.back, this.again,
      button("Zoom in", { icon: "plus", bare: true, class: "bare small", onclick: () => this.zoom(button_zoom) }),
      button("Zoom out", { icon: "minus", bare: true, class: "bare small", onclick: () => this.zoom(1 / button_zoom) }),
      button("Fit to terrain", { icon: "fit", bare: true, class: "bare small", onclick: () => this.fit() }),
      h("label", { class: "check" }, this.slope, "Slope"), this.place),
    this.legend, this.about, this.told, this.facts);
  private grid: Grid | null = null;
  private relief: Relief | null = null;
  private picture: HTMLCanvasElement | null = null;
  private corners: Point[] = [];
  private closed = false;
  private downhill: Descent | null = null;
  private view: MapView = { x: 0, y: 0, scale: 0 };
  /** Contours of `linesOf`, the view that they were made for. */
  private lines: Contour[] = [];
  private linesOf = "";
  private readonly held = new Map<number, Held>();
  /** Where keys act, px, once they are used. */
  private cross: Point | null = null;
  /** The corner that the cross has taken up. */
  private carried: number | null = null;
  private drawing = false;

  /** `onchange`: the outline is another one, closed or none. */
  constructor(private readonly onchange: () => void) {
    const { canvas } = this;
    new ResizeObserver(() => this.draw()).observe(canvas);
    canvas.addEventListener("pointerdown", (event) => this.press(event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    canvas.addEventListener("pointerup", (event) => this.release(event));
    canvas.addEventListener("pointercancel", (event) => void this.held.delete(event.pointerId));
    canvas.addEventListener("dblclick", () => this.close());
    canvas.addEventListener("blur", () => this.showCross(null));
    canvas.addEventListener("keydown", (event) => {
      if (!event.ctrlKey && !event.altKey && !event.metaKey && this.key(event.key, event.shiftKey)) event.preventDefault();
    });
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      // Wheels that count in lines turn as far as those that count in pixels.
      this.zoom(Math.exp(-event.deltaY * (event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 30 : 1) / 400), [event.offsetX, event.offsetY]);
    }, { passive: false });
  }

  /** The outline, once it is closed. */
  get scar(): Point[] | null {
    return this.closed ? this.corners : null;
  }
  /** `cell_m`: of the terrain, of which the grid may hold every so many cells. */
  show(grid: Grid | null, cell_m: number | null): void {
    const other = grid === null || this.grid === null || grid.west !== this.grid.west || grid.south !== this.grid.south || grid.columns !== this.grid.columns;
    this.grid = grid;
    this.relief = grid === null ? null : new Relief(grid, [0, 0, 0]);
    this.element.hidden = grid === null;
    this.about.textContent = grid !== null && cell_m !== null && grid.cell > 1.5 * cell_m ? `The map has a height every ${tick(grid.cell)}\u202fm, the scene every ${tick(cell_m)}\u202fm.` : "";
    this.linesOf = "";
    if (other) {
      this.corners = [];
      this.closed = false;
      this.fit();
    }
    this.shade();
    this.changed(this.closed, false);
  }
  private shade(): void {
    this.legend.hidden = !this.slope.checked;
    this.picture = this.grid === null ? null : shaded(this.grid, this.slope.checked);
    this.draw();
  }

  private clear(): void {
    this.corners = [];
    this.changed(false);
  }
  private undo(): void {
    if (this.corners.length === 0) return;
    if (!this.closed) this.corners.pop();
    this.changed(false);
  }
  private close(): void {
    // A double click sets its corner twice.
    const [last, before] = [this.corners.at(-1), this.corners.at(-2)];
    if (!this.closed && last && before && Math.hypot(last[0] - before[0], last[1] - before[1]) * this.view.scale < near_px / 2) this.corners.pop();
    if (this.closed || this.corners.length < 3) return this.draw();
    this.changed(true);
  }
  private add(pixel: Point): void {
    this.corners.push(groundAt(this.view, this.size, pixel));
    this.changed(false);
  }
  private changed(closed: boolean, tell = true): void {
    const told = tell && (this.closed || closed);
    this.closed = closed;
    this.carried = null;
    this.measure();
    this.say();
    this.draw();
    if (told) this.onchange();
  }
  /** Area, slope and flow path of a closed outline. */
  private measure(): void {
    const { grid, relief, corners } = this;
    this.downhill = null;
    if (!this.closed || !grid || !relief) return this.facts.replaceChildren();
    const places = within(corners).filter(([x, y]) => !Number.isNaN(gridAt(grid, x, y)));
    const lowest = places.reduce<Point | null>((low, p) => (low === null || gridAt(grid, ...p) < gridAt(grid, ...low) ? p : low), null);
    this.downhill = lowest === null ? null : descent(grid, lowest);
    this.facts.replaceChildren(h("span", {}, `Release: ${quantity(area(corners), "m2")} in plan, ${groundMeasures(corners, true, relief, null)}.`), " ",
      this.downhill === null ? "" : h("span", {}, pathText(grid, this.downhill)));
  }
  private say(): void {
    this.back.disabled = this.again.disabled = this.corners.length === 0;
    this.told.textContent = this.closed ? "Drag a corner to move it."
      : this.corners.length === 0 ? "Draw the release: click its corners, and the first one again. Drag to move the map; turn the wheel or spread two fingers to zoom."
      : this.corners.length < 3 ? "Click the next corner." : "Click the first corner again, or press Enter, to close it.";
  }

  private get size(): Size {
    return { width: this.canvas.clientWidth, height: this.canvas.clientHeight };
  }
  private fit(): void {
    if (this.grid) this.look(fitted(this.grid, this.size));
  }
  private zoom(factor: number, around: Point = this.cross ?? [this.size.width / 2, this.size.height / 2]): void {
    if (this.grid) this.look(zoomed(this.view, this.size, this.grid, factor, around));
  }
  private pan(right: number, down: number): void {
    if (this.grid) this.look(panned(this.view, this.grid, right, down));
  }
  private look(view: MapView): void {
    this.view = view;
    this.draw();
  }
  private cornerAt([u, v]: Point, reach: number): number | null {
    const away = this.corners.map((corner) => {
      const [x, y] = pixelAt(this.view, this.size, corner);
      return Math.hypot(x - u, y - v);
    });
    const least = Math.min(...away);
    return least <= reach ? away.indexOf(least) : null;
  }
  private read(pixel: Point): void {
    if (!this.grid) return;
    const [east, north] = groundAt(this.view, this.size, pixel);
    const height = gridAt(this.grid, east, north);
    const slope = slopeAt(this.grid, east, north);
    this.place.textContent = Number.isNaN(height) ? "no data" : `${fixed(east, 1)}, ${fixed(north, 1)} · ${fixed(height, 1)}\u202fm${Number.isNaN(slope) ? "" : ` · slope ${fixed(slope, 0)}°`}`;
  }

  private press(event: PointerEvent): void {
    if (event.button !== 0 || !this.grid) return;
    this.canvas.setPointerCapture(event.pointerId);
    const at: Point = [event.offsetX, event.offsetY];
    this.held.set(event.pointerId, { at, corner: this.cornerAt(at, event.pointerType === "touch" ? finger_px : near_px), moved: false });
    // A second finger zooms: neither sets a corner.
    if (this.held.size > 1) for (const held of this.held.values()) [held.corner, held.moved] = [null, true];
    this.showCross(null);
  }
  private move(event: PointerEvent): void {
    if (!this.grid) return;
    const at: Point = [event.offsetX, event.offsetY];
    if (this.cross === null || event.movementX !== 0 || event.movementY !== 0) {
      this.showCross(null);
      this.read(at);
    }
    const held = this.held.get(event.pointerId);
    if (!held) return;
    const [dx, dy] = [at[0] - held.at[0], at[1] - held.at[1]];
    if (!held.moved && Math.hypot(dx, dy) < still_px) return;
    const other = [...this.held.values()].find((one) => one !== held);
    if (other) {
      const apart = (p: Point): number => Math.max(1, Math.hypot(p[0] - other.at[0], p[1] - other.at[1]));
      this.pan(dx / 2, dy / 2);
      this.zoom(apart(at) / apart(held.at), [(at[0] + other.at[0]) / 2, (at[1] + other.at[1]) / 2]);
    } else if (held.corner !== null) {
      this.corners[held.corner] = groundAt(this.view, this.size, at);
      this.downhill = null;
    } else this.pan(dx, dy);
    held.moved = true;
    held.at = at;
    this.draw();
  }
  private release(event: PointerEvent): void {
    const held = this.held.get(event.pointerId);
    this.held.delete(event.pointerId);
    if (!held || !this.grid) return;
    if (held.moved) return void (held.corner !== null && this.changed(this.closed));
    if (this.closed) return;
    if (held.corner === 0 && this.corners.length >= 3) return this.close();
    if (held.corner === null) this.add([event.offsetX, event.offsetY]);
  }

  /** Whether the key means something here. */
  private key(key: string, fine: boolean): boolean {
    const step = fine ? fine_px : step_px;
    const arrows: Record<string, Point> = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] };
    if (!this.grid) return false;
    if (arrows[key]) this.step(arrows[key]);
    else if (key === " ") this.act();
    else if (key === "Enter") this.close();
    else if (key === "Backspace" || key === "Delete") this.undo();
    else if (key === "+" || key === "=") this.zoom(button_zoom);
    else if (key === "-") this.zoom(1 / button_zoom);
    else if (key === "Home") this.fit();
    else return false;
    return true;
  }
  private step([du, dv]: Point): void {
    const { width, height } = this.size;
    // The first press shows the cross.
    const [u, v] = this.cross === null ? [width / 2, height / 2] : [this.cross[0] + du, this.cross[1] + dv];
    const kept: Point = [Math.min(Math.max(u, edge_px), width - edge_px), Math.min(Math.max(v, edge_px), height - edge_px)];
    this.pan(kept[0] - u, kept[1] - v);
    this.showCross(kept);
    if (this.carried === null) return;
    this.corners[this.carried] = groundAt(this.view, this.size, kept);
    this.downhill = null;
  }
  private act(): void {
    if (this.cross === null) return this.step([0, 0]);
    if (this.carried !== null) return this.changed(this.closed);
    const corner = this.cornerAt(this.cross, near_px);
    if (this.closed) {
      this.carried = corner;
      if (corner !== null) this.told.textContent = "Arrows move this corner; Space puts it down.";
    } else if (corner === 0 && this.corners.length >= 3) this.close();
    else if (corner === null) this.add(this.cross);
  }
  private showCross(cross: Point | null): void {
    if (cross === null && this.cross === null) return;
    if (cross === null && this.carried !== null) this.changed(this.closed);
    this.cross = cross;
    if (cross !== null) this.read(cross);
    this.draw();
  }

  /** With the next picture of the screen. */
  private draw(): void {
    if (this.drawing) return;
    this.drawing = true;
    requestAnimationFrame(() => {
      this.drawing = false;
      this.drawNow();
    });
  }
  private drawNow(): void {
    const { canvas, grid, picture, size } = this;
    const ratio = devicePixelRatio;
    const { width, height } = size;
    if (!grid || !picture || width === 0) return;
    if (this.view.scale === 0) this.view = fitted(grid, size);
    if (canvas.width !== Math.round(width * ratio)) canvas.width = Math.round(width * ratio);
    if (canvas.height !== Math.round(height * ratio)) canvas.height = Math.round(height * ratio);
    const paint = canvas.getContext("2d");
    if (!paint) return;
    paint.setTransform(ratio, 0, 0, ratio, 0, 0);
    paint.clearRect(0, 0, width, height);
    const { scale } = this.view;
    const [x, y] = pixelAt(this.view, size, [grid.west, grid.south + grid.rows * grid.cell]);
    paint.imageSmoothingEnabled = true;
    paint.drawImage(picture, x, y, grid.columns * grid.cell * scale, grid.rows * grid.cell * scale);
    const over = new MapPaint(paint, this.view, size);
    over.contours(this.contoursNow(grid));
    if (this.downhill) over.path(this.downhill.points);
    if (this.corners.length > 0) over.outline(this.corners, this.closed);
    over.marks();
    if (this.cross) over.cross(this.cross);
  }
  private contoursNow(grid: Grid): Contour[] {
    const { view, size, relief } = this;
    const now = JSON.stringify([view, size]);
    if (now === this.linesOf || !relief) return this.lines;
    this.linesOf = now;
    const [west, north] = groundAt(view, size, [0, 0]);
    const [east, south] = groundAt(view, size, [size.width, size.height]);
    const part = partOf(grid, west, south, east, north, contour_px / view.scale);
    this.lines = contours(part, contourInterval(relief.highest - relief.lowest, view.scale / fitted(grid, size).scale));
    return this.lines;
  }
}

/** "Flow path from its lowest point: 410 m in plan, falls 139 m (mean 18.7°), to the edge of the terrain." */
function pathText(grid: Grid, { points, end, hollow_m }: Descent): string {
  const plan = length(points);
  const fall = gridAt(grid, ...points[0]) - gridAt(grid, ...points[points.length - 1]);
  const mean = plan > 0 ? ` (mean ${fixed((Math.atan2(fall, plan) * 180) / Math.PI, 1)}°)` : "";
  const hollow = hollow_m >= 1 ? ` It crosses a hollow ${quantity(hollow_m, "m", 2)} deep.` : "";
  return `Flow path from its lowest point: ${quantity(plan, "m")} in plan, falls ${quantity(fall, "m")}${mean}, to ${end === "edge" ? "the edge of the terrain" : "the lowest ground it reaches"}.${hollow}`;
}
