// A texture of noise that repeats without a seam: gradient (red, green) and value (blue) of a rough surface, distance to the
// nearest of scattered points (alpha). Its smaller copies fade with distance by themselves.
import { DataTexture, LinearFilter, LinearMipmapLinearFilter, RepeatWrapping, RGBAFormat } from "three";

const size = 256;

/** Evenly spread values of 0 to 1 for two integers. */
export function scattered(i: number, j: number, seed = 0): number {
  let h = Math.imul(i, 0x8da6b343) ^ Math.imul(j, 0xd8163841) ^ Math.imul(seed, 0xcb1ab31f);
  h = Math.imul(h ^ (h >>> 13), 0x85ebca6b);
  h = Math.imul(h ^ (h >>> 16), 0xc2b2ae35);
  return ((h ^ (h >>> 15)) >>> 8) / 0x1000000;
}

/** Smooth noise of `cells` random values per side. */
function smooth(x: number, y: number, cells: number): number {
  const u = (x / size) * cells;
  const v = (y / size) * cells;
  const [i, j] = [Math.floor(u), Math.floor(v)];
  const ease = (t: number): number => t * t * (3 - 2 * t);
  const [a, b] = [ease(u - i), ease(v - j)];
  const at = (di: number, dj: number): number => scattered((i + di) % cells, (j + dj) % cells, cells);
  return (1 - b) * ((1 - a) * at(0, 0) + a * at(1, 0)) + b * ((1 - a) * at(0, 1) + a * at(1, 1));
}

function nearest(x: number, y: number, cells: number): number {
  const u = (x / size) * cells;
  const v = (y / size) * cells;
  let least = 9;
  for (let dj = -1; dj <= 1; ++dj) {
    for (let di = -1; di <= 1; ++di) {
      const [i, j] = [Math.floor(u) + di, Math.floor(v) + dj];
      const [ci, cj] = [(i + cells) % cells, (j + cells) % cells];
      least = Math.min(least, Math.hypot(i + scattered(ci, cj, 91) - u, j + scattered(ci, cj, 92) - v));
    }
  }
  return least;
}

export function noiseTexture(): DataTexture {
  const height = new Float32Array(size * size);
  for (let y = 0, k = 0; y < size; ++y) {
    for (let x = 0; x < size; ++x, ++k) {
      let weight = 0.5;
      for (let cells = 4; cells <= 64; cells *= 2, weight *= 0.55) height[k] += weight * smooth(x, y, cells);
    }
  }
  const bytes = new Uint8Array(4 * size * size);
  const byte = (v: number): number => Math.max(0, Math.min(255, Math.round(255 * v)));
  for (let y = 0, k = 0; y < size; ++y) {
    for (let x = 0; x < size; ++x, ++k) {
      const at = (i: number, j: number): number => height[((j + size) % size) * size + ((i + size) % size)];
      bytes[4 * k] = byte(0.5 + 5 * (at(x + 1, y) - at(x - 1, y)));
      bytes[4 * k + 1] = byte(0.5 + 5 * (at(x, y + 1) - at(x, y - 1)));
      bytes[4 * k + 2] = byte(height[k] / 1.06);
      bytes[4 * k + 3] = byte(nearest(x, y, 16));
    }
  }
  const texture = new DataTexture(bytes, size, size, RGBAFormat);
  texture.wrapS = texture.wrapT = RepeatWrapping;
  texture.magFilter = LinearFilter;
  texture.minFilter = LinearMipmapLinearFilter;
  texture.generateMipmaps = true;
  texture.anisotropy = 4;
  texture.needsUpdate = true;
  return texture;
}
