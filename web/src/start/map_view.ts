// What a map shows: between places on the ground and pixels of its canvas, from zooming and panning.
import type { Grid } from "../protocol/grid";
import type { Point } from "../protocol/messages";

/** The place in the middle, and pixels per metre. */
export interface MapView { x: number; y: number; scale: number }
export interface Size { width: number; height: number }

/** Largest size of a cell on the screen, px: zooming in farther shows nothing more. */
const largest_cell_px = 80;

export const groundAt = (view: MapView, size: Size, [u, v]: Point): Point => [view.x + (u - size.width / 2) / view.scale, view.y - (v - size.height / 2) / view.scale];
export const pixelAt = (view: MapView, size: Size, [x, y]: Point): Point => [(x - view.x) * view.scale + size.width / 2, (view.y - y) * view.scale + size.height / 2];

/** The whole terrain; without size: scale 0. */
export function fitted(grid: Grid, size: Size): MapView {
  const scale = Math.min(size.width / (grid.columns * grid.cell), size.height / (grid.rows * grid.cell));
  return { x: grid.west + (grid.columns * grid.cell) / 2, y: grid.south + (grid.rows * grid.cell) / 2, scale };
}

/** By a factor, around a pixel below which the ground stays; between the whole terrain and a few cells. */
export function zoomed(view: MapView, size: Size, grid: Grid, factor: number, around: Point): MapView {
  const least = fitted(grid, size).scale;
  const scale = Math.min(Math.max(view.scale * factor, least), Math.max(least, largest_cell_px / grid.cell));
  const [x, y] = groundAt(view, size, around);
  return kept({ x: x - (around[0] - size.width / 2) / scale, y: y + (around[1] - size.height / 2) / scale, scale }, grid);
}
/** The ground moves by so many pixels to the right and down. */
export const panned = (view: MapView, grid: Grid, right: number, down: number): MapView => kept({ ...view, x: view.x - right / view.scale, y: view.y + down / view.scale }, grid);

/** The middle stays on the terrain, so that the map is not lost. */
function kept({ x, y, scale }: MapView, { west, south, cell, columns, rows }: Grid): MapView {
  return { x: Math.min(Math.max(x, west), west + columns * cell), y: Math.min(Math.max(y, south), south + rows * cell), scale };
}

/** The largest of 1, 2 and 5 times a power of ten that is not above `most`. */
export function roundBelow(most: number): number {
  const power = 10 ** Math.floor(Math.log10(most) + 1e-9);
  return ([5, 2].find((m) => m * power <= most * (1 + 1e-9)) ?? 1) * power;
}
/** Length of the scale bar, m: at most so many pixels. */
export const barLength = (view: MapView, most_px: number): number => roundBelow(most_px / view.scale);
