// What lies over the picture of the terrain: contours with their heights, the outline of the release, the flow path, marks.
import type { Point } from "../protocol/messages";
import { quantity, tick } from "../state/format";
import type { Contour } from "./contours";
import { barLength, pixelAt, type MapView, type Size } from "./map_view";

/** Longest scale bar, and least distance of two heights on contours, px. */
const bar_px = 120;
const label_apart_px = 110;
/** A contour shorter than this bears no height, px. */
const labelled_px = 70;

const white = "rgb(255 255 255 / 0.85)";
const contour_ink = "rgb(92 58 20 / 0.9)";
const font = (px: number, bold = false): string => `${bold ? "600 " : ""}${px}px system-ui, sans-serif`;

export class MapPaint {
  constructor(private readonly paint: CanvasRenderingContext2D, private readonly view: MapView, private readonly size: Size) {}

  private pixels(points: readonly Point[]): Point[] {
    return points.map((point) => pixelAt(this.view, this.size, point));
  }
  private trace(pixels: readonly Point[], closed = false): void {
    this.paint.beginPath();
    for (const [u, v] of pixels) this.paint.lineTo(u, v);
    if (closed) this.paint.closePath();
  }
  private stroke(colour: string, width: number): void {
    this.paint.strokeStyle = colour;
    this.paint.lineWidth = width;
    this.paint.stroke();
  }
  private write(text: string, u: number, v: number): void {
    this.paint.textAlign = "center";
    this.paint.textBaseline = "middle";
    this.paint.lineJoin = "round";
    this.paint.lineWidth = 3;
    this.paint.strokeStyle = white;
    this.paint.strokeText(text, u, v);
    this.paint.fillText(text, u, v);
  }

  contours(lines: readonly Contour[]): void {
    const labels: Point[] = [];
    const bearers: { at: Point; turn: number; text: string }[] = [];
    for (const { points, index, level_m } of lines) {
      const pixels = this.pixels(points);
      this.trace(pixels);
      this.stroke(index ? contour_ink : "rgb(92 58 20 / 0.75)", index ? 1.6 : 0.8);
      const place = index ? this.labelPlace(pixels, labels) : null;
      if (place) {
        labels.push(place.at);
        bearers.push({ ...place, text: tick(level_m) });
      }
    }
    this.paint.font = font(11);
    this.paint.fillStyle = contour_ink;
    for (const { at, turn, text } of bearers) {
      this.paint.save();
      this.paint.translate(...at);
      this.paint.rotate(turn);
      this.write(text, 0, 0);
      this.paint.restore();
    }
  }
  /** In the map, away from other heights, upright along the line. */
  private labelPlace(line: readonly Point[], others: readonly Point[]): { at: Point; turn: number } | null {
    const { width, height } = this.size;
    let length = 0;
    for (let i = 1; i < line.length; ++i) length += Math.hypot(line[i][0] - line[i - 1][0], line[i][1] - line[i - 1][1]);
    if (length < labelled_px) return null;
    for (const share of [0.5, 0.3, 0.7, 0.15, 0.85]) {
      const i = Math.floor(share * (line.length - 1));
      const at = line[i];
      if (at[0] < 24 || at[1] < 16 || at[0] > width - 24 || at[1] > height - 16 || others.some(([u, v]) => Math.hypot(u - at[0], v - at[1]) < label_apart_px)) continue;
      const [from, to] = [line[Math.max(0, i - 2)], line[Math.min(line.length - 1, i + 2)]];
      const turn = Math.atan2(to[1] - from[1], to[0] - from[0]);
      return { at, turn: Math.abs(turn) > Math.PI / 2 ? turn - Math.sign(turn) * Math.PI : turn };
    }
    return null;
  }

  outline(corners: readonly Point[], closed: boolean): void {
    const { paint } = this;
    const pixels = this.pixels(corners);
    this.trace(pixels, closed);
    if (closed) {
      paint.fillStyle = "rgb(196 61 20 / 0.3)";
      paint.fill();
    }
    this.stroke(white, 4);
    this.stroke("#b8330f", 2);
    for (const [u, v] of pixels) {
      paint.beginPath();
      paint.arc(u, v, 4.5, 0, 2 * Math.PI);
      paint.fillStyle = "#fff";
      paint.fill();
      this.stroke("#b8330f", 2);
    }
  }
  path(points: readonly Point[]): void {
    this.trace(this.pixels(points));
    this.stroke(white, 4.5);
    this.paint.setLineDash([8, 5]);
    this.stroke("#1550b0", 2.2);
    this.paint.setLineDash([]);
  }
  cross([u, v]: Point): void {
    this.paint.beginPath();
    for (const [du, dv] of [[12, 0], [0, 12]] as const) {
      this.paint.moveTo(u - du, v - dv);
      this.paint.lineTo(u + du, v + dv);
    }
    this.stroke(white, 4.5);
    this.stroke("#1c2126", 1.8);
  }

  /** Scale bar and north arrow. */
  marks(): void {
    const { paint, view, size } = this;
    const length = barLength(view, bar_px);
    const [left, low, right] = [14, size.height - 14, 14 + length * view.scale];
    this.trace([[left, low - 6], [left, low], [right, low], [right, low - 6]]);
    this.stroke(white, 5);
    this.stroke("#1c2126", 2);
    paint.fillStyle = "#1c2126";
    paint.font = font(12, true);
    this.write(length >= 1000 ? quantity(length / 1000, "km", 1) : `${tick(length)}\u202fm`, (left + right) / 2, low - 13);
    const east = size.width - 20;
    this.trace([[east, 24], [east - 6, 42], [east, 38], [east + 6, 42]], true);
    this.stroke(white, 3);
    paint.fill();
    this.write("N", east, 15);
  }
}
