// Shade that hills cast on the ground, soft at its edges: which share of the sun each cell sees.
import { DataTexture, LinearFilter, RedFormat, Vector4, type Vector3 } from "three";
import type { Relief } from "../relief";

/** Tangents of elevation over which light fades: wider than the sun, as haze makes it. */
const fade = 0.05;
const mostCells = 90_000;

export function hillShade(relief: Relief, towards: Vector3): { texture: DataTexture; placing: Vector4 } {
  const { grid, origin } = relief;
  const every = Math.max(1, Math.ceil(Math.sqrt((grid.columns * grid.rows) / mostCells)));
  const columns = Math.ceil(grid.columns / every);
  const rows = Math.ceil(grid.rows / every);
  const bytes = new Uint8Array(columns * rows).fill(255);
  const level = Math.hypot(towards.x, towards.y);
  const tangent = towards.z / Math.max(level, 1e-6);
  const [du, dv] = [towards.x / Math.max(level, 1e-6), towards.y / Math.max(level, 1e-6)];
  for (let j = 0; j < rows; ++j) {
    for (let i = 0; i < columns; ++i) {
      const [c, r] = [i * every, j * every];
      const z = grid.values[Math.min(r, grid.rows - 1) * grid.columns + Math.min(c, grid.columns - 1)];
      let steepest = -1;
      for (let run = 2; z + run * grid.cell * (tangent - fade) < relief.highest; run *= 1.12) {
        const u = Math.round(c + run * du);
        const v = Math.round(r + run * dv);
        if (u < 0 || v < 0 || u >= grid.columns || v >= grid.rows) break;
        const slope = (grid.values[v * grid.columns + u] - z) / (run * grid.cell);
        if (slope > steepest) steepest = slope;
      }
      bytes[j * columns + i] = 255 * Math.min(1, Math.max(0, 0.5 + (tangent - steepest) / fade));
    }
  }
  const texture = new DataTexture(bytes, columns, rows, RedFormat);
  texture.minFilter = texture.magFilter = LinearFilter;
  texture.unpackAlignment = 1;
  texture.needsUpdate = true;
  const cell = every * grid.cell;
  // The value of a texel is that of the first of its cells.
  const shift = (every - 1) * grid.cell * 0.5;
  return { texture, placing: new Vector4(grid.west - origin[0] - shift, grid.south - origin[1] - shift, 1 / (columns * cell), 1 / (rows * cell)) };
}
