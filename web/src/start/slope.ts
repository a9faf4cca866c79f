// Slope of a terrain, its classes, and the picture of the terrain from above, lit from the north-west.
import type { Grid } from "../protocol/grid";

/** Light from 315 degrees, 45 degrees high. */
const light = { east: -0.5, north: 0.5, up: Math.SQRT1_2 };

type Rgb = readonly [number, number, number];
export interface SlopeClass { from_deg: number; name: string; colour: Rgb }
/** Classes of slope in which landslides start: few below 25 degrees; soil is rare above 45. */
export const slopeClasses: readonly SlopeClass[] = [
  { from_deg: 0, name: "below 25°", colour: [246, 246, 240] },
  { from_deg: 25, name: "25–35°", colour: [250, 219, 92] },
  { from_deg: 35, name: "35–45°", colour: [240, 140, 50] },
  { from_deg: 45, name: "above 45°", colour: [176, 42, 120] },
];
export const slopeClass = (slope_deg: number): SlopeClass => slopeClasses.reduce((found, one) => (slope_deg >= one.from_deg ? one : found));

/** Rise per metre to the east and to the north, from the neighbours that have data; NaN: the cell has none. */
export function gradient({ columns, rows, cell, values }: Grid, column: number, row: number): [number, number] {
  const at = (c: number, r: number): number => (c < 0 || r < 0 || c >= columns || r >= rows ? NaN : values[r * columns + c]);
  const here = at(column, row);
  if (Number.isNaN(here)) return [NaN, NaN];
  const rise = (before: number, after: number): number => {
    if (Number.isNaN(before)) return Number.isNaN(after) ? 0 : (after - here) / cell;
    return Number.isNaN(after) ? (here - before) / cell : (after - before) / (2 * cell);
  };
  return [rise(at(column - 1, row), at(column + 1, row)), rise(at(column, row - 1), at(column, row + 1))];
}
const degrees = (east: number, north: number): number => (Math.atan(Math.hypot(east, north)) * 180) / Math.PI;

/** Slope of the cell at a place, degrees; NaN: no data. */
export function slopeAt(grid: Grid, x: number, y: number): number {
  return degrees(...gradient(grid, Math.floor((x - grid.west) / grid.cell), Math.floor((y - grid.south) / grid.cell)));
}

/** A pixel per cell, transparent where there are no data. */
export function shaded(grid: Grid, bySlope: boolean): HTMLCanvasElement {
  const { columns, rows } = grid;
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [columns, rows];
  const paint = canvas.getContext("2d");
  if (!paint) return canvas;
  const image = paint.createImageData(columns, rows);
  for (let row = 0; row < rows; ++row) {
    for (let column = 0; column < columns; ++column) {
      const [east, north] = gradient(grid, column, row);
      if (Number.isNaN(east)) continue;
      const lit = (light.up - east * light.east - north * light.north) / Math.sqrt(1 + east * east + north * north);
      const bright = Math.max(0, Math.min(1, lit));
      // Classes keep most of their colour in the shade.
      const [share, colour] = bySlope ? [0.72 + 0.28 * bright, slopeClass(degrees(east, north)).colour] : [(60 + 190 * bright) / 255, [255, 255, 245] as const];
      image.data.set([share * colour[0], share * colour[1], share * colour[2], 255], 4 * ((rows - 1 - row) * columns + column));
    }
  }
  paint.putImageData(image, 0, 0);
  return canvas;
}
