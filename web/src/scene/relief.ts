// The ground as heights on a regular grid: elevation, intersection with rays, and visible share of the sky.
import type { Grid } from "../protocol/grid";
import type { Place, Point } from "../protocol/messages";

export class Relief {
  readonly lowest: number;
  readonly highest: number;

  /** origin: world position of the local frame that everything is drawn in. */
  constructor(readonly grid: Grid, readonly origin: Place) {
    let lowest = Infinity;
    let highest = -Infinity;
    for (const z of grid.values) {
      if (z < lowest) lowest = z;
      if (z > highest) highest = z;
    }
    this.lowest = Number.isFinite(lowest) ? lowest : 0;
    this.highest = Number.isFinite(highest) ? highest : 0;
  }

  get width(): number {
    return this.grid.columns * this.grid.cell;
  }
  get height(): number {
    return this.grid.rows * this.grid.cell;
  }
  get middle(): Point {
    return [this.grid.west + this.width / 2, this.grid.south + this.height / 2];
  }

  /** World height at a world place, held constant beyond the edges and where there are no data. */
  at(x: number, y: number): number {
    const { west, south, cell, columns, rows, values } = this.grid;
    const u = Math.min(Math.max((x - west) / cell - 0.5, 0), columns - 1);
    const v = Math.min(Math.max((y - south) / cell - 0.5, 0), rows - 1);
    const i = Math.min(Math.floor(u), columns - 2);
    const j = Math.min(Math.floor(v), rows - 2);
    const a = u - i;
    const b = v - j;
    const k = j * columns + i;
    const z = (1 - b) * ((1 - a) * values[k] + a * values[k + 1]) + b * ((1 - a) * values[k + columns] + a * values[k + columns + 1]);
    return Number.isNaN(z) ? this.lowest : z;
  }
  contains(x: number, y: number): boolean {
    const { west, south } = this.grid;
    return x >= west && y >= south && x <= west + this.width && y <= south + this.height;
  }
  /** Whether a place lies on the terrain, where it has data. */
  hasGround(x: number, y: number): boolean {
    const { west, south, cell, columns, rows, values } = this.grid;
    const column = Math.min(columns - 1, Math.floor((x - west) / cell));
    const row = Math.min(rows - 1, Math.floor((y - south) / cell));
    return this.contains(x, y) && !Number.isNaN(values[row * columns + column]);
  }
  local(x: number, y: number, above = 0): Place {
    return [x - this.origin[0], y - this.origin[1], this.at(x, y) + above - this.origin[2]];
  }

  /** This ground lowered by a depth, NaN: none. Each height uses the depth of its cell. */
  lowered(depth: Grid): Relief {
    const { west, south, cell, columns, rows } = this.grid;
    const values = this.grid.values.slice();
    const first = (from: number, edge: number): number => Math.max(0, Math.ceil((from - edge) / cell - 0.5));
    for (let j = first(depth.south, south); j < rows; ++j) {
      const row = Math.floor((south + (j + 0.5) * cell - depth.south) / depth.cell);
      if (row >= depth.rows) break;
      for (let i = first(depth.west, west); i < columns; ++i) {
        const column = Math.floor((west + (i + 0.5) * cell - depth.west) / depth.cell);
        if (column >= depth.columns) break;
        const less = depth.values[row * depth.columns + column];
        if (less > 0) values[j * columns + i] -= less;
      }
    }
    return new Relief({ ...this.grid, values }, this.origin);
  }

  /** Intersection of a ray in the local frame with the ground, as a world place; null if there is none. */
  meet(from: Place, direction: Place): Place | null {
    const [ox, oy, oz] = this.origin;
    const gap = (t: number): number =>
      from[2] + t * direction[2] + oz - this.at(from[0] + t * direction[0] + ox, from[1] + t * direction[1] + oy);
    const inside = (t: number): boolean => this.contains(from[0] + t * direction[0] + ox, from[1] + t * direction[1] + oy);
    // Steps grow with the height above ground: far above it nothing can be missed.
    const farthest = 4 * (this.width + this.height + this.highest - this.lowest) + Math.hypot(...from);
    let before = 0;
    for (let t = 0; t < farthest; ) {
      const above = gap(t);
      if (above < 0 && inside(t)) {
        let [low, high] = [before, t];
        for (let k = 0; k < 24; ++k) {
          const half = (low + high) / 2;
          if (gap(half) < 0) high = half;
          else low = half;
        }
        const x = from[0] + high * direction[0] + ox;
        const y = from[1] + high * direction[1] + oy;
        return [x, y, this.at(x, y)];
      }
      before = t;
      t += Math.max(0.4 * this.grid.cell, 0.25 * Math.abs(above));
    }
    return null;
  }

  /**
   * Share of the sky that each cell sees (0 to 1): 1 less the sine of the steepest upward angle, averaged over
   * `directions` directions.
   */
  skyView(directions = 8, reach = 9): Float32Array {
    const { columns, rows, cell, values } = this.grid;
    const out = new Float32Array(columns * rows);
    // It changes slowly from cell to cell: on large grids every second one is enough, and the rest are interpolated.
    const every = columns * rows > 50_000 ? 2 : 1;
    const steps: { dx: number; dy: number; run: number }[][] = [];
    for (let d = 0; d < directions; ++d) {
      const angle = (2 * Math.PI * (d + 0.35)) / directions;
      const list: { dx: number; dy: number; run: number }[] = [];
      for (let k = 0, length = 1.5; k < reach; ++k, length *= 1.55) {
        const dx = Math.round(length * Math.cos(angle));
        const dy = Math.round(length * Math.sin(angle));
        list.push({ dx, dy, run: Math.hypot(dx, dy) * cell });
      }
      steps.push(list);
    }
    for (let j = 0; j < rows; j += every) {
      for (let i = 0; i < columns; i += every) {
        const z = values[j * columns + i];
        let open = 0;
        for (const list of steps) {
          let steepest = 0;
          for (const { dx, dy, run } of list) {
            const c = i + dx;
            const r = j + dy;
            if (c < 0 || r < 0 || c >= columns || r >= rows) break;
            const slope = (values[r * columns + c] - z) / run;
            if (slope > steepest) steepest = slope;
          }
          open += 1 - steepest / Math.hypot(1, steepest);
        }
        out[j * columns + i] = open / directions;
      }
    }
    if (every === 1) return out;
    const last = (count: number, k: number): number => (k + 1 < count ? k + 1 : k - 1);
    for (let j = 0; j < rows; j += 2) {
      for (let i = 1; i < columns; i += 2) out[j * columns + i] = (out[j * columns + i - 1] + out[j * columns + last(columns, i)]) / 2;
    }
    for (let j = 1; j < rows; j += 2) {
      for (let i = 0; i < columns; ++i) out[j * columns + i] = (out[(j - 1) * columns + i] + out[last(rows, j) * columns + i]) / 2;
    }
    return out;
  }

  /** A line in world coordinates as local points on the ground, no farther apart than a cell. */
  drape(line: readonly Point[], above: number, closed = false): number[] {
    const out: number[] = [];
    const points = closed && line.length > 0 ? [...line, line[0]] : line;
    points.forEach(([x, y], k) => {
      if (k > 0) {
        const [px, py] = points[k - 1];
        const parts = Math.min(400, Math.max(1, Math.ceil(Math.hypot(x - px, y - py) / this.grid.cell)));
        for (let s = 1; s < parts; ++s) {
          out.push(...this.local(px + ((x - px) * s) / parts, py + ((y - py) * s) / parts, above));
        }
      }
      out.push(...this.local(x, y, above));
    });
    return out;
  }
}
