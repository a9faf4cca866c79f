// Where debris has been, for the wet trail that stays: largest depth so far on the map grid.
import { DataTexture, LinearFilter, RedFormat, Vector4 } from "three";
import type { Frame } from "../../protocol/frame";
import type { Grid } from "../../protocol/grid";
import type { SceneInfo } from "../../protocol/messages";

/** Of a byte, m; a trail is as wet at 5 m as at more. */
const unit_m = 5 / 255;

export class Trail {
  readonly texture: DataTexture;
  readonly placing: Vector4;
  private readonly bytes: Uint8Array<ArrayBuffer>;

  constructor(private readonly map: SceneInfo["map"], origin: SceneInfo["origin"]) {
    const { columns, rows, cell_m } = map;
    this.bytes = new Uint8Array(columns * rows);
    this.texture = new DataTexture(this.bytes, columns, rows, RedFormat);
    this.texture.minFilter = this.texture.magFilter = LinearFilter;
    this.texture.unpackAlignment = 1;
    this.texture.needsUpdate = true;
    this.placing = new Vector4(map.x_min_m - origin[0], map.y_min_m - origin[1], 1 / (columns * cell_m), 1 / (rows * cell_m));
  }
  clear(): void {
    this.bytes.fill(0);
    this.texture.needsUpdate = true;
  }
  add(frame: Frame): void {
    const { column, row, columns, rows } = frame.window;
    const scale = frame.depthUnit_m / unit_m;
    let changed = false;
    for (let j = 0, k = 0; j < rows; ++j) {
      for (let i = 0, to = (row + j) * this.map.columns + column; i < columns; ++i, ++k, ++to) {
        const now = Math.min(255, frame.depth[k] * scale);
        if (now < this.bytes[to] + 1) continue;
        this.bytes[to] = now;
        changed = true;
      }
    }
    if (changed) this.texture.needsUpdate = true;
  }
  /** A map of the largest depth so far: what frames that were not seen have left. */
  addPeaks(peaks: Grid): void {
    const { map } = this;
    const left = Math.round((peaks.west - map.x_min_m) / map.cell_m);
    const low = Math.round((peaks.south - map.y_min_m) / map.cell_m);
    for (let j = 0, k = 0; j < peaks.rows; ++j) {
      for (let i = 0; i < peaks.columns; ++i, ++k) {
        const to = (low + j) * map.columns + left + i;
        const now = Math.min(255, peaks.values[k] / unit_m);
        if (now > this.bytes[to]) this.bytes[to] = now;
      }
    }
    this.texture.needsUpdate = true;
  }
  dispose(): void {
    this.texture.dispose();
  }
}
