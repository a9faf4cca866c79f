// Map tiles in Web Mercator, loaded by this browser, warped to the terrain's reference system.
import type { Point, Tiles } from "../protocol/messages";
import { mercator, tileRange, tileUrl } from "../state/overlays";

const tile_px = 256;
/** 8 x 8: two thousand pixels along an edge. */
const mostTiles = 64;

function load(url: string): Promise<HTMLImageElement | null> {
  return new Promise((resolve) => {
    const image = new Image();
    // Without it the canvas that it is painted on could not be read by the graphics card.
    image.crossOrigin = "anonymous";
    image.onload = () => resolve(image);
    image.onerror = () => resolve(null);
    image.src = url;
  });
}

/** The three corners of a triangle on a picture and where they are on a canvas: paints that part. */
function paintTriangle(context: CanvasRenderingContext2D, picture: HTMLCanvasElement, from: readonly Point[], to: readonly Point[]): void {
  const [[u0, v0], [u1, v1], [u2, v2]] = from;
  const [[x0, y0], [x1, y1], [x2, y2]] = to;
  const d = (u1 - u0) * (v2 - v0) - (u2 - u0) * (v1 - v0);
  if (Math.abs(d) < 1e-12) return;
  const a = ((x1 - x0) * (v2 - v0) - (x2 - x0) * (v1 - v0)) / d;
  const b = ((y1 - y0) * (v2 - v0) - (y2 - y0) * (v1 - v0)) / d;
  const c = ((u1 - u0) * (x2 - x0) - (u2 - u0) * (x1 - x0)) / d;
  const e = ((u1 - u0) * (y2 - y0) - (u2 - u0) * (y1 - y0)) / d;
  context.save();
  // A little larger than the triangle, so that no seam shows.
  const [mx, my] = [(x0 + x1 + x2) / 3, (y0 + y1 + y2) / 3];
  context.beginPath();
  for (const [x, y] of to) {
    const far = Math.hypot(x - mx, y - my) || 1;
    context.lineTo(x + (0.8 * (x - mx)) / far, y + (0.8 * (y - my)) / far);
  }
  context.closePath();
  context.clip();
  context.transform(a, b, c, e, x0 - a * u0 - c * v0, y0 - b * u0 - e * v0);
  context.drawImage(picture, 0, 0);
  context.restore();
}

/** A picture over the whole terrain, north up; null: no tile came. */
export async function tileBackground(tiles: Tiles, address: string, width_px: number, height_px: number): Promise<HTMLCanvasElement | null> {
  const { steps, degrees } = tiles;
  const corners: Point[] = [];
  for (let k = 0; k + 1 < degrees.length; k += 2) corners.push(mercator(degrees[k], degrees[k + 1]));
  if (corners.length !== (steps + 1) ** 2) return null;
  const { zoom, west, north, columns, rows } = tileRange(corners, mostTiles);
  const mosaic = document.createElement("canvas");
  mosaic.width = columns * tile_px;
  mosaic.height = rows * tile_px;
  const pieces = mosaic.getContext("2d");
  const picture = document.createElement("canvas");
  picture.width = width_px;
  picture.height = height_px;
  const context = picture.getContext("2d");
  if (!pieces || !context) return null;
  const all = await Promise.all(Array.from({ length: columns * rows }, async (_, k) => {
    const [i, j] = [k % columns, Math.floor(k / columns)];
    const image = await load(tileUrl(address, zoom, west + i, north + j));
    if (image) pieces.drawImage(image, i * tile_px, j * tile_px, tile_px, tile_px);
    return image !== null;
  }));
  if (!all.includes(true)) return null;
  const n = 2 ** zoom * tile_px;
  const from = (i: number, j: number): Point => {
    const [x, y] = corners[j * (steps + 1) + i];
    return [x * n - west * tile_px, y * n - north * tile_px];
  };
  const to = (i: number, j: number): Point => [(i / steps) * width_px, (1 - j / steps) * height_px];
  for (let j = 0; j < steps; ++j) {
    for (let i = 0; i < steps; ++i) {
      for (const corner of [[[i, j], [i + 1, j], [i + 1, j + 1]], [[i, j], [i + 1, j + 1], [i, j + 1]]] as const) {
        paintTriangle(context, mosaic, corner.map(([a, b]) => from(a, b)), corner.map(([a, b]) => to(a, b)));
      }
    }
  }
  return picture;
}
