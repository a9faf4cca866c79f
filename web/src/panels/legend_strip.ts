// Legends of a picture, in rows below it, so that they hide nothing.
import { css, roundStep } from "../scene/colour";
import { tick, unitText } from "../state/format";
import type { Legend } from "./legends";

export const font = "system-ui, 'Segoe UI', 'DejaVu Sans', sans-serif";
const wide = 208;
const gap = 8;
const inner = wide - 20;

const heightOf = (legend: Legend): number => (legend.categories ? 22 + 16 * legend.categories.length : 50) + (legend.from ? 15 : 0);

export class LegendStrip {
  readonly height: number;
  private readonly placed: { legend: Legend; x: number; y: number }[] = [];

  constructor(legends: readonly Legend[], width: number) {
    const perRow = Math.max(1, Math.floor(width / (wide + gap)));
    let y = 0;
    for (let first = 0; first < legends.length; first += perRow) {
      const row = legends.slice(first, first + perRow);
      row.forEach((legend, i) => this.placed.push({ legend, x: i * (wide + gap), y }));
      y += Math.max(...row.map(heightOf));
    }
    this.height = y;
  }
  draw(c: CanvasRenderingContext2D, top: number): void {
    for (const { legend, x, y } of this.placed) drawLegend(c, legend, x + 10, top + y);
  }
}

function drawLegend(c: CanvasRenderingContext2D, legend: Legend, x: number, y: number): void {
  c.fillStyle = "#1c2126";
  c.font = `600 12px ${font}`;
  c.fillText(legend.categories ? legend.title : `${legend.title}, ${unitText(legend.unit)}`, x, y + 12, inner);
  c.font = `11px ${font}`;
  if (legend.categories) {
    const last = legend.categories.length - 1;
    legend.categories.forEach((category, k) => {
      const at = y + 22 + 16 * (last - k);
      c.fillStyle = category.colour;
      c.fillRect(x, at, 11, 11);
      c.fillStyle = "#48525b";
      c.fillText(category.name, x + 18, at + 6, inner - 18);
    });
  } else {
    for (let i = 0; i < inner; ++i) {
      c.fillStyle = css(legend.at(i / (inner - 1)));
      c.fillRect(x + i, y + 21, 1.5, 9);
    }
    c.fillStyle = "#48525b";
    c.textAlign = "center";
    const step = roundStep((legend.high - legend.low) / 4.5);
    for (let v = Math.ceil(legend.low / step) * step; v <= legend.high + 1e-9; v += step) {
      c.fillText(tick(v), x + (inner * (v - legend.low)) / (legend.high - legend.low), y + 39);
    }
    c.textAlign = "left";
  }
  if (legend.from) c.fillText(legend.from, x, y + heightOf(legend) - 9, inner);
}
