// Areas (releases; zones, beds, inflows) painted into one texture draped over the ground.
import { CanvasTexture, LinearFilter, SRGBColorSpace, Vector4 } from "three";
import type { Point } from "../protocol/messages";
import type { Draped } from "./ground";
import type { Relief } from "./relief";

export interface Area {
  rings: readonly (readonly Point[])[];
  colour: string;
  /** Share of the ground's colour that is covered, 0 to 1. */
  opacity: number;
  /** Distinguishable without colour: lines that rise or fall to the right, horizontal ones, dots. */
  pattern: "none" | "rising" | "falling" | "level" | "dots";
  /** Between lines or dots, m. */
  gap_m: number;
}

const longestSide_px = 1024;

export class DrawnAreas {
  private readonly canvas = document.createElement("canvas");
  private texture = new CanvasTexture(this.canvas);
  private readonly placing = new Vector4();

  constructor(private readonly relief: Relief) {}

  /** Repaints the areas; the texture covers only them, so that its pixels are small. */
  paint(areas: readonly Area[]): Draped {
    const points = areas.flatMap((a) => a.rings.flatMap((r) => [...r]));
    const context = this.canvas.getContext("2d");
    if (points.length === 0 || !context) {
      this.placing.set(0, 0, 0, 0);
      return { texture: this.texture, placing: this.placing };
    }
    const margin = 2;
    const west = Math.min(...points.map((p) => p[0])) - margin;
    const east = Math.max(...points.map((p) => p[0])) + margin;
    const south = Math.min(...points.map((p) => p[1])) - margin;
    const north = Math.max(...points.map((p) => p[1])) + margin;
    const scale = Math.min(16, longestSide_px / Math.max(east - west, north - south));
    this.canvas.width = Math.max(8, Math.round((east - west) * scale));
    this.canvas.height = Math.max(8, Math.round((north - south) * scale));
    context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    for (const area of areas) {
      const path = new Path2D();
      for (const ring of area.rings) {
        ring.forEach(([x, y], i) => {
          const px = (x - west) * scale;
          const py = (north - y) * scale;
          if (i === 0) path.moveTo(px, py);
          else path.lineTo(px, py);
        });
        path.closePath();
      }
      context.save();
      context.clip(path, "evenodd");
      context.fillStyle = area.colour;
      context.globalAlpha = area.opacity;
      context.fillRect(0, 0, this.canvas.width, this.canvas.height);
      context.globalAlpha = Math.min(1, area.opacity + 0.35);
      context.strokeStyle = area.colour;
      context.lineWidth = 0.14 * area.gap_m * scale;
      this.pattern(context, area.pattern, Math.max(4, area.gap_m * scale));
      context.restore();
    }
    this.texture.dispose();
    this.texture = new CanvasTexture(this.canvas);
    this.texture.colorSpace = SRGBColorSpace;
    this.texture.minFilter = LinearFilter;
    this.texture.generateMipmaps = false;
    const [ox, oy] = this.relief.origin;
    this.placing.set(west - ox, south - oy, 1 / (east - west), 1 / (north - south));
    return { texture: this.texture, placing: this.placing };
  }
  private pattern(context: CanvasRenderingContext2D, pattern: Area["pattern"], step: number): void {
    const { width, height } = this.canvas;
    const stroke = (x0: number, y0: number, x1: number, y1: number): void => {
      context.beginPath();
      context.moveTo(x0, y0);
      context.lineTo(x1, y1);
      context.stroke();
    };
    if (pattern === "rising") for (let d = -height; d < width; d += step) stroke(d, height, d + height, 0);
    if (pattern === "falling") for (let d = -height; d < width; d += step) stroke(d, 0, d + height, height);
    if (pattern === "level") for (let y = 0.5 * step; y < height; y += step) stroke(0, y, width, y);
    if (pattern !== "dots") return;
    for (let row = 0; row * step < height + step; ++row) {
      for (let x = row % 2 === 0 ? 0 : 0.5 * step; x < width + step; x += step) {
        context.beginPath();
        context.arc(x, row * step, 0.16 * step, 0, 2 * Math.PI);
        context.fill();
      }
    }
  }
  dispose(): void {
    this.texture.dispose();
  }
}
