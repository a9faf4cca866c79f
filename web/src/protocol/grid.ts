// Grid messages of docs/protocol.md: elevation and map layers.
import { inflate, MalformedMessage, tag } from "./frame";

export interface Grid {
  /** West and south edge, m. */
  west: number;
  south: number;
  /** Edge of a cell, m. */
  cell: number;
  columns: number;
  rows: number;
  /** By rows from the south; NaN: no value. */
  values: Float32Array;
}

const headBytes = 44;

export async function decodeGrid(data: ArrayBuffer): Promise<Grid> {
  const bytes = new Uint8Array(data);
  if (data.byteLength < headBytes || tag(bytes) !== "TLSG") throw new MalformedMessage("no grid");
  const head = new DataView(data);
  if (head.getUint8(4) !== 1) throw new MalformedMessage(`grid of version ${head.getUint8(4)}; this page reads version 1`);
  const columns = head.getUint32(32, true);
  const rows = head.getUint32(36, true);
  const size = head.getUint32(40, true);
  if (size !== 4 * columns * rows) throw new MalformedMessage(`body of ${size} bytes for ${columns} x ${rows} cells`);
  const body = await inflate(bytes.subarray(headBytes), size);
  return {
    west: head.getFloat64(8, true),
    south: head.getFloat64(16, true),
    cell: head.getFloat64(24, true),
    columns,
    rows,
    values: new Float32Array(body.buffer, 0, columns * rows),
  };
}

/** Bilinear value at a place; NaN outside, and where none of the four surrounding cells has a value. */
export function gridAt(grid: Grid, x: number, y: number): number {
  const u = (x - grid.west) / grid.cell - 0.5;
  const v = (y - grid.south) / grid.cell - 0.5;
  if (u < -0.5 || v < -0.5 || u > grid.columns - 0.5 || v > grid.rows - 0.5) return NaN;
  const i = Math.min(Math.max(Math.floor(u), 0), Math.max(grid.columns - 2, 0));
  const j = Math.min(Math.max(Math.floor(v), 0), Math.max(grid.rows - 2, 0));
  const a = Math.min(Math.max(u - i, 0), 1);
  const b = Math.min(Math.max(v - j, 0), 1);
  let sum = 0;
  let weight = 0;
  for (let dj = 0; dj < 2; ++dj) {
    for (let di = 0; di < 2; ++di) {
      const w = (di ? a : 1 - a) * (dj ? b : 1 - b);
      const value = grid.values[(j + dj) * grid.columns + i + di];
      if (value !== undefined && !Number.isNaN(value)) {
        sum += w * value;
        weight += w;
      }
    }
  }
  return weight > 0 ? sum / weight : NaN;
}
