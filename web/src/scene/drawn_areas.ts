// Areas (releases, fills of what is being drawn) painted into one picture that lies on the ground.
import { CanvasTexture, LinearFilter, SRGBColorSpace, Vector4 } from "three";
import type { Point } from "../protocol/messages";
import type { Draped } from "./ground";
import type { Relief } from "./relief";

export interface Area {
  rings: readonly (readonly Point[])[];
  colour: string;
  /** Share of the ground's colour that is covered, 0 to 1. */
  opacity: number;
  hatched: boolean;
}

const longestSide_px = 1024;

export class DrawnAreas {
  private readonly canvas = document.createElement("canvas");
  private texture = new CanvasTexture(this.canvas);
  private readonly placing = new Vector4();

  constructor(private readonly relief: Relief) {}

  /** Paints the areas anew; the picture covers just them, so that its pixels are small. */
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
      if (area.hatched) {
        context.globalAlpha = Math.min(1, area.opacity + 0.35);
        context.strokeStyle = area.colour;
        context.lineWidth = 0.35 * scale;
        const step = 2.5 * scale;
        for (let d = -this.canvas.height; d < this.canvas.width; d += step) {
          context.beginPath();
          context.moveTo(d, this.canvas.height);
          context.lineTo(d + this.canvas.height, 0);
          context.stroke();
        }
      }
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
  dispose(): void {
    this.texture.dispose();
  }
}
