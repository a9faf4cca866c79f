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
const version = 2;
/** Values as they are; differences (src/core/byte_planes.hpp); values in byte planes. */
const codings = { values: 0, differences: 1, planes: 2 } as const;

export async function decodeGrid(data: ArrayBuffer): Promise<Grid> {
  const bytes = new Uint8Array(data);
  if (data.byteLength < headBytes || tag(bytes) !== "TLSG") throw new MalformedMessage("no grid");
  const head = new DataView(data);
  if (head.getUint8(4) !== version) throw new MalformedMessage(`grid of version ${head.getUint8(4)}; this page reads version ${version}`);
  const coding = head.getUint8(5);
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
    values: valuesOf(body, coding, columns),
  };
}

function valuesOf(body: Uint8Array, coding: number, columns: number): Float32Array {
  if (coding === codings.values) return new Float32Array(body.buffer, 0, body.length / 4);
  if (coding !== codings.differences && coding !== codings.planes) throw new MalformedMessage(`grid of coding ${coding}; this page reads codings 0 to 2`);
  const count = body.length / 4;
  const bits = new Int32Array(count);
  for (let i = 0; i < count; ++i) bits[i] = body[i]! | (body[count + i]! << 8) | (body[2 * count + i]! << 16) | (body[3 * count + i]! << 24);
  if (coding === codings.differences) undoDifferences(bits, columns);
  return new Float32Array(bits.buffer);
}

/** From folded differences to the plane through the western, southern and south-western neighbours; along the first row and column to the one before. */
function undoDifferences(bits: Int32Array, columns: number): void {
  for (let i = 0, column = 0; i < bits.length; ++i) {
    const folded = bits[i]!;
    let predicted = 0;
    if (column > 0) predicted = i < columns ? bits[i - 1]! : bits[i - 1]! + bits[i - columns]! - bits[i - columns - 1]!;
    else if (i > 0) predicted = bits[i - columns]!;
    bits[i] = (((folded >>> 1) ^ -(folded & 1)) + predicted) | 0;
    column = column + 1 === columns ? 0 : column + 1;
  }
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
