// The line of steepest descent over a terrain: the way that debris would take.
import type { Grid } from "../protocol/grid";
import type { Point } from "../protocol/messages";

export interface Descent {
  /** From its start. */
  points: Point[];
  /** The edge of the data, or the lowest ground that can be reached. */
  end: "edge" | "lowest";
  /** Depth of the deepest hollow on the way, m; 0: none. */
  hollow_m: number;
}

/** Neighbours, by columns and rows. */
const around: readonly Point[] = [[1, 0], [0, 1], [-1, 0], [0, -1], [1, 1], [-1, 1], [-1, -1], [1, -1]];

/** From cell to cell (D8), out of each hollow where it would spill onto lower ground; null: no data at the start. As the program traces the flow path of a scene. */
export function descent(grid: Grid, start: Point): Descent | null {
  const { west, south, cell, columns, rows, values } = grid;
  const heightOf = (column: number, row: number): number => (column < 0 || row < 0 || column >= columns || row >= rows ? NaN : values[row * columns + column]);
  const neighbours = (k: number): number[] => {
    const [column, row] = [k % columns, Math.floor(k / columns)];
    return around.filter(([i, j]) => !Number.isNaN(heightOf(column + i, row + j))).map(([i, j]) => k + j * columns + i);
  };
  const [column, row] = [Math.floor((start[0] - west) / cell), Math.floor((start[1] - south) / cell)];
  if (Number.isNaN(heightOf(column, row))) return null;

  const flood = new Flood(values, neighbours);
  const cells = [row * columns + column];
  let hollow_m = 0;
  let end: Descent["end"] = "lowest";
  for (;;) {
    const here = cells[cells.length - 1];
    const beside = neighbours(here);
    const next = steepest(values, columns, here, beside);
    if (next !== null) {
      cells.push(next);
      continue;
    }
    if (beside.length < around.length) end = "edge";
    const spill = end === "edge" ? null : flood.lower(here);
    if (spill === null) break;
    hollow_m = Math.max(hollow_m, spill.depth_m);
    cells.push(...spill.way);
  }
  const centres = cells.map((k): Point => [west + ((k % columns) + 0.5) * cell, south + (Math.floor(k / columns) + 0.5) * cell]);
  return { points: smoothed([start, ...centres.slice(1)]), end, hollow_m };
}

function steepest(values: Float32Array, columns: number, here: number, beside: readonly number[]): number | null {
  let best = 0;
  let found: number | null = null;
  for (const k of beside) {
    const straight = Math.abs(k - here) === 1 || Math.abs(k - here) === columns;
    const fall = (values[here] - values[k]) / (straight ? 1 : Math.SQRT2);
    if (fall > best) [best, found] = [fall, k];
  }
  return found;
}

/** Fills a hollow from its bottom until it spills. */
class Flood {
  private readonly from: Int32Array;
  private readonly reached: Int32Array;
  private count = 0;

  constructor(private readonly values: Float32Array, private readonly neighbours: (k: number) => number[]) {
    this.from = new Int32Array(values.length);
    this.reached = new Int32Array(values.length);
  }

  /** The way to the first ground below the bottom, and how deep the hollow is; null: the edge of the data comes first. */
  lower(bottom: number): { way: number[]; depth_m: number } | null {
    const { values, from, reached } = this;
    const number = ++this.count;
    let level = values[bottom];
    reached[bottom] = number;
    const open = new Heap(values);
    for (let k: number | undefined = bottom; k !== undefined; k = open.pop()) {
      level = Math.max(level, values[k]);
      if (values[k] < values[bottom]) {
        const way = [k];
        for (let back = from[k]; back !== bottom; back = from[back]) way.push(back);
        return { way: way.reverse(), depth_m: level - values[bottom] };
      }
      const beside = this.neighbours(k);
      if (beside.length < around.length) return null;
      for (const next of beside) {
        if (reached[next] === number) continue;
        reached[next] = number;
        from[next] = k;
        open.push(next);
      }
    }
    return null;
  }
}

/** Cells, the lowest first; of equal ones that of the lower number. */
class Heap {
  private readonly cells: number[] = [];
  constructor(private readonly values: Float32Array) {}

  private before(a: number, b: number): boolean {
    const [k, l] = [this.cells[a], this.cells[b]];
    return this.values[k] < this.values[l] || (this.values[k] === this.values[l] && k < l);
  }
  private swap(a: number, b: number): void {
    [this.cells[a], this.cells[b]] = [this.cells[b], this.cells[a]];
  }
  push(cell: number): void {
    let at = this.cells.push(cell) - 1;
    for (let up = (at - 1) >> 1; at > 0 && this.before(at, up); at = up, up = (at - 1) >> 1) this.swap(at, up);
  }
  pop(): number | undefined {
    const { cells } = this;
    if (cells.length > 1) this.swap(0, cells.length - 1);
    const first = cells.pop();
    for (let at = 0; ; ) {
      let low = at;
      for (const down of [2 * at + 1, 2 * at + 2]) if (down < cells.length && this.before(down, low)) low = down;
      if (low === at) return first;
      this.swap(at, low);
      at = low;
    }
  }
}

/** Weights 1 4 6 4 1, the ends kept: the zigzag from cell to cell would add up to 8 % to the length. */
function smoothed(points: readonly Point[]): Point[] {
  const last = points.length - 1;
  return points.map((point, i) => {
    if (i === 0 || i === last) return point;
    const mean: Point = [0, 0];
    [1, 4, 6, 4, 1].forEach((weight, k) => {
      const [x, y] = points[Math.min(Math.max(i + k - 2, 0), last)];
      mean[0] += (weight * x) / 16;
      mean[1] += (weight * y) / 16;
    });
    return mean;
  });
}
