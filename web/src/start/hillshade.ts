// A terrain from above, lit from the north-west, on which the outline of a release is drawn.
import { gridAt, type Grid } from "../protocol/grid";
import { fixed, quantity } from "../state/format";
import { button, h } from "../ui/dom";

type Place = [number, number];

/** Pixels within which a corner is meant. */
const near_px = 10;
/** Light from 315 degrees, 45 degrees high. */
const light = { east: -0.5, north: 0.5, up: Math.SQRT1_2 };

export class Hillshade {
  private readonly canvas = h("canvas", { class: "hillshade", tabindex: 0, "aria-label": "Hillshade of the terrain: click the corners of the release" });
  private readonly place = h("output", { class: "muted hillshade-place" });
  private readonly told = h("p", { class: "hint" });
  private readonly back = button("Undo corner", { icon: "undo", class: "small", onclick: () => this.undo() });
  private readonly again = button("Draw again", { class: "small", onclick: () => this.clear() });
  readonly element = h("div", { class: "hillshade-box" }, this.canvas,
    h("div", { class: "row hillshade-tools" }, this.back, this.again,
      button("Zoom in", { icon: "plus", bare: true, class: "bare small", onclick: () => this.zoom(1.6) }),
      button("Fit to terrain", { icon: "fit", bare: true, class: "bare small", onclick: () => this.fit() }), this.place), this.told);
  private grid: Grid | null = null;
  private picture: HTMLCanvasElement | null = null;
  private corners: Place[] = [];
  private closed = false;
  /** The place in the middle, and pixels per metre. */
  private view = { x: 0, y: 0, scale: 1 };
  private held: { corner: number | null; x: number; y: number; moved: boolean } | null = null;

  /** `onchange`: the outline is another one, closed or none. */
  constructor(private readonly onchange: () => void) {
    new ResizeObserver(() => this.draw()).observe(this.canvas);
    this.canvas.addEventListener("pointerdown", (event) => this.press(event));
    this.canvas.addEventListener("pointermove", (event) => this.move(event));
    this.canvas.addEventListener("pointerup", (event) => this.release(event));
    this.canvas.addEventListener("pointercancel", () => (this.held = null));
    this.canvas.addEventListener("dblclick", () => this.close());
    this.canvas.addEventListener("keydown", (event) => {
      if (event.key === "Enter") this.close();
      else if (event.key === "Backspace" || event.key === "Delete") this.undo();
      else return;
      event.preventDefault();
    });
    this.canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(Math.exp(-event.deltaY / 400), event.offsetX, event.offsetY);
    }, { passive: false });
  }

  /** The outline, once it is closed. */
  get scar(): Place[] | null {
    return this.closed ? this.corners : null;
  }
  show(grid: Grid | null): void {
    const other = grid === null || this.grid === null || grid.west !== this.grid.west || grid.south !== this.grid.south || grid.columns !== this.grid.columns;
    this.grid = grid;
    this.element.hidden = grid === null;
    this.picture = grid === null ? null : shaded(grid);
    if (other) {
      this.corners = [];
      this.closed = false;
      this.fit();
    } else this.draw();
    this.say();
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
    if (last && before && this.distance(last, before) < near_px / 2) this.corners.pop();
    if (this.closed || this.corners.length < 3) return this.draw();
    this.changed(true);
  }
  private changed(closed: boolean): void {
    const told = this.closed || closed;
    this.closed = closed;
    this.say();
    this.draw();
    if (told) this.onchange();
  }
  private say(): void {
    this.back.disabled = this.again.disabled = this.corners.length === 0;
    this.told.textContent = this.closed ? `The release is ${quantity(area(this.corners), "m2")} in plan. Drag a corner to move it.`
      : this.corners.length === 0 ? "Draw the release: click its corners, and the first one again. Drag to move the map, turn the wheel to zoom."
      : this.corners.length < 3 ? "Click the next corner." : "Click the first corner again, or press Enter, to close it.";
  }

  private fit(): void {
    if (!this.grid) return;
    const { west, south, cell, columns, rows } = this.grid;
    const scale = Math.min(this.canvas.clientWidth / (columns * cell), this.canvas.clientHeight / (rows * cell));
    this.view = { x: west + columns * cell / 2, y: south + rows * cell / 2, scale: scale > 0 ? scale : 0 };
    this.draw();
  }
  private zoom(factor: number, x = this.canvas.clientWidth / 2, y = this.canvas.clientHeight / 2): void {
    if (!this.grid) return;
    const [east, north] = this.world(x, y);
    const least = Math.min(this.canvas.clientWidth / (this.grid.columns * this.grid.cell), this.canvas.clientHeight / (this.grid.rows * this.grid.cell));
    this.view.scale = Math.min(Math.max(this.view.scale * factor, least), Math.max(least, 40 / this.grid.cell));
    const [nowEast, nowNorth] = this.world(x, y);
    this.view.x += east - nowEast;
    this.view.y += north - nowNorth;
    this.draw();
  }
  private world(x: number, y: number): Place {
    return [this.view.x + (x - this.canvas.clientWidth / 2) / this.view.scale, this.view.y - (y - this.canvas.clientHeight / 2) / this.view.scale];
  }
  private screen([east, north]: Place): Place {
    return [(east - this.view.x) * this.view.scale + this.canvas.clientWidth / 2, (this.view.y - north) * this.view.scale + this.canvas.clientHeight / 2];
  }
  private distance(a: Place, b: Place): number {
    return Math.hypot(a[0] - b[0], a[1] - b[1]) * this.view.scale;
  }
  private cornerAt(x: number, y: number): number | null {
    const found = this.corners.findIndex((corner) => {
      const [u, v] = this.screen(corner);
      return Math.hypot(u - x, v - y) <= near_px;
    });
    return found < 0 ? null : found;
  }

  private press(event: PointerEvent): void {
    if (event.button !== 0 || !this.grid) return;
    this.canvas.setPointerCapture(event.pointerId);
    this.held = { corner: this.cornerAt(event.offsetX, event.offsetY), x: event.offsetX, y: event.offsetY, moved: false };
  }
  private move(event: PointerEvent): void {
    if (!this.grid) return;
    const [east, north] = this.world(event.offsetX, event.offsetY);
    const height = gridAt(this.grid, east, north);
    this.place.textContent = Number.isNaN(height) ? "" : `${fixed(east, 1)}, ${fixed(north, 1)} · ${fixed(height, 1)} m`;
    if (!this.held) return;
    const [dx, dy] = [event.offsetX - this.held.x, event.offsetY - this.held.y];
    if (!this.held.moved && Math.hypot(dx, dy) < 4) return;
    this.held.moved = true;
    if (this.closed && this.held.corner !== null) this.corners[this.held.corner] = [east, north];
    else {
      this.view.x -= dx / this.view.scale;
      this.view.y += dy / this.view.scale;
    }
    [this.held.x, this.held.y] = [event.offsetX, event.offsetY];
    this.draw();
  }
  private release(event: PointerEvent): void {
    const held = this.held;
    this.held = null;
    if (!held || !this.grid) return;
    if (held.moved) return void (this.closed && held.corner !== null && this.changed(true));
    if (this.closed) return;
    if (held.corner === 0 && this.corners.length >= 3) return this.close();
    if (held.corner !== null) return;
    this.corners.push(this.world(event.offsetX, event.offsetY));
    this.changed(false);
  }

  private draw(): void {
    const { canvas, grid, picture } = this;
    const ratio = devicePixelRatio;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (!grid || !picture || width === 0) return;
    if (this.view.scale === 0) return this.fit();
    if (canvas.width !== Math.round(width * ratio)) canvas.width = Math.round(width * ratio);
    if (canvas.height !== Math.round(height * ratio)) canvas.height = Math.round(height * ratio);
    const paint = canvas.getContext("2d");
    if (!paint) return;
    paint.setTransform(ratio, 0, 0, ratio, 0, 0);
    paint.clearRect(0, 0, width, height);
    const [x, y] = this.screen([grid.west, grid.south + grid.rows * grid.cell]);
    paint.imageSmoothingEnabled = this.view.scale * grid.cell < 4;
    paint.drawImage(picture, x, y, grid.columns * grid.cell * this.view.scale, grid.rows * grid.cell * this.view.scale);
    if (this.corners.length === 0) return;
    const points = this.corners.map((corner) => this.screen(corner));
    paint.beginPath();
    for (const [u, v] of points) paint.lineTo(u, v);
    if (this.closed) {
      paint.closePath();
      paint.fillStyle = "rgb(196 61 20 / 0.35)";
      paint.fill();
    }
    paint.lineWidth = 4;
    paint.strokeStyle = "rgb(255 255 255 / 0.8)";
    paint.stroke();
    paint.lineWidth = 2;
    paint.strokeStyle = "#b8330f";
    paint.stroke();
    for (const [u, v] of points) {
      paint.beginPath();
      paint.arc(u, v, 4.5, 0, 2 * Math.PI);
      paint.fillStyle = "#fff";
      paint.fill();
      paint.stroke();
    }
  }
}

/** Plan area of an outline, m2. */
export function area(corners: readonly Place[]): number {
  let twice = 0;
  corners.forEach(([x, y], i) => {
    const [u, v] = corners[(i + 1) % corners.length] as Place;
    twice += x * v - u * y;
  });
  return Math.abs(twice) / 2;
}

/** A pixel per cell, from the north; what has no data is transparent. */
function shaded(grid: Grid): HTMLCanvasElement {
  const { columns, rows, cell, values } = grid;
  const canvas = h("canvas", { width: columns, height: rows });
  const paint = canvas.getContext("2d");
  if (!paint) return canvas;
  const image = paint.createImageData(columns, rows);
  const at = (column: number, row: number): number => values[Math.min(Math.max(row, 0), rows - 1) * columns + Math.min(Math.max(column, 0), columns - 1)] as number;
  for (let row = 0; row < rows; ++row) {
    for (let column = 0; column < columns; ++column) {
      const here = at(column, row);
      if (Number.isNaN(here)) continue;
      const or = (value: number): number => (Number.isNaN(value) ? here : value);
      const east = (or(at(column + 1, row)) - or(at(column - 1, row))) / (2 * cell);
      const north = (or(at(column, row + 1)) - or(at(column, row - 1))) / (2 * cell);
      const lit = (light.up - east * light.east - north * light.north) / Math.sqrt(1 + east * east + north * north);
      const grey = 60 + 190 * Math.max(0, Math.min(1, lit));
      const i = 4 * ((rows - 1 - row) * columns + column);
      image.data.set([grey, grey, grey * 0.96, 255], i);
    }
  }
  paint.putImageData(image, 0, 0);
  return canvas;
}
