// Depth and depth-averaged speed of two frames as textures, each covering its own window of the map grid.
import { DataTexture, FloatType, LinearFilter, RGFormat, Vector4 } from "three";
import type { Frame } from "../protocol/frame";
import type { SceneInfo } from "../protocol/messages";

const block = 64;

class WindowTexture {
  texture = this.make(block, block);
  /** Local west, local south, and 1 / (width, height) of the texture in metres; width 0 shows nothing. */
  readonly placing = new Vector4(0, 0, 0, 0);

  private make(columns: number, rows: number): DataTexture {
    const texture = new DataTexture(new Float32Array(2 * columns * rows), columns, rows, RGFormat, FloatType);
    // Half precision is enough for depths and, unlike single precision, may be filtered everywhere.
    texture.internalFormat = "RG16F";
    texture.minFilter = texture.magFilter = LinearFilter;
    return texture;
  }

  fill(frame: Frame, scene: SceneInfo): void {
    const { column, row, columns, rows } = frame.window;
    const { cell_m, x_min_m, y_min_m } = scene.map;
    if (columns === 0 || rows === 0) {
      this.placing.set(0, 0, 0, 0);
      return;
    }
    // A border of one empty cell, so that filtering ends at zero.
    const image = this.texture.image;
    if (columns + 2 > image.width || rows + 2 > image.height) {
      this.texture.dispose();
      const fit = (n: number): number => block * Math.ceil((n + 2) / block);
      this.texture = this.make(Math.max(image.width, fit(columns)), Math.max(image.height, fit(rows)));
    }
    const { width, height, data } = this.texture.image as { width: number; height: number; data: Float32Array };
    data.fill(0);
    for (let j = 0; j < rows; ++j) {
      let to = 2 * ((j + 1) * width + 1);
      for (let k = j * columns; k < (j + 1) * columns; ++k, to += 2) {
        data[to] = frame.depth[k] * frame.depthUnit_m;
        data[to + 1] = frame.mapSpeed[k] * frame.mapSpeedUnit_mps;
      }
    }
    this.texture.needsUpdate = true;
    this.placing.set(
      x_min_m + (column - 1) * cell_m - scene.origin[0],
      y_min_m + (row - 1) * cell_m - scene.origin[1],
      1 / (width * cell_m),
      1 / (height * cell_m),
    );
  }
}

/** Two alternating windows: a new frame overwrites the older one. */
export class DepthField {
  private readonly windows = [new WindowTexture(), new WindowTexture()] as const;
  private newest = 0;
  readonly uniforms = {
    uDepth0: { value: this.windows[0].texture },
    uDepth1: { value: this.windows[1].texture },
    uPlacing0: { value: this.windows[0].placing },
    uPlacing1: { value: this.windows[1].placing },
    uDepthMix: { value: 1 },
  };

  constructor(private readonly scene: SceneInfo) {}

  push(frame: Frame, joins: boolean): void {
    this.newest = 1 - this.newest;
    this.windows[this.newest].fill(frame, this.scene);
    if (!joins) this.windows[1 - this.newest].fill(frame, this.scene);
    this.uniforms.uDepth0.value = this.windows[0].texture;
    this.uniforms.uDepth1.value = this.windows[1].texture;
  }
  /** Of the newest frame, m, in the cell that a local place lies in. */
  depthAt(x: number, y: number): number {
    const { placing, texture } = this.windows[this.newest];
    const { width, height, data } = texture.image as { width: number; height: number; data: Float32Array };
    const column = Math.floor((x - placing.x) * placing.z * width);
    const row = Math.floor((y - placing.y) * placing.w * height);
    return column >= 0 && row >= 0 && column < width && row < height && placing.z > 0 ? data[2 * (row * width + column)] : 0;
  }
  /** fraction: 0 the older frame, 1 the newest. */
  mix(fraction: number): void {
    this.uniforms.uDepthMix.value = this.newest === 1 ? fraction : 1 - fraction;
  }
  dispose(): void {
    for (const window of this.windows) window.texture.dispose();
  }
}
