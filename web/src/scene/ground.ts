// The ground: a mesh with side walls like a relief model, elevation colours, contour lines, draped layers, and the
// debris as a surface that lifts the same mesh.
import {
  BufferAttribute, BufferGeometry, DataTexture, FloatType, LinearFilter, Mesh, MeshLambertMaterial, RedFormat, RGBAFormat, SRGBColorSpace, Vector2, Vector4,
  type IUniform, type Texture,
} from "three";
import type { Grid } from "../protocol/grid";
import { rampAt, roundStep, table, type Rgb } from "./colour";
import type { Relief } from "./relief";
import { groundFragment, groundNormal, groundVertex, sharedHead } from "./ground_shader";
import { forLook } from "./natural/daylight";
import { naturalGround } from "./natural/ground_natural";

export function rampTexture(at: (share: number) => Rgb): DataTexture {
  const texture = new DataTexture(table(at), 256, 1, RGBAFormat);
  texture.colorSpace = SRGBColorSpace;
  texture.minFilter = texture.magFilter = LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

/** Muted, so that debris and layers stand out: moss to straw to pale stone. */
function groundColour(share: number): Rgb {
  const stops: [number, Rgb][] = [
    [0, [190, 206, 178]], [0.25, [212, 216, 186]], [0.5, [229, 222, 197]], [0.75, [235, 227, 212]], [1, [246, 243, 238]],
  ];
  const k = Math.min(stops.length - 2, Math.floor(share * (stops.length - 1)));
  const [s0, c0] = stops[k];
  const [s1, c1] = stops[k + 1];
  const t = (share - s0) / (s1 - s0);
  return c0.map((v, i) => Math.round(v + (c1[i] - v) * t)) as Rgb;
}

export function groundGeometry(relief: Relief): BufferGeometry {
  const { grid, origin } = relief;
  const { columns, rows, cell, values } = grid;
  const sky = relief.skyView();
  const n = columns * rows;
  const border = 2 * (columns + rows - 2);
  const position = new Float32Array(3 * (n + 2 * border));
  const normal = new Float32Array(3 * (n + 2 * border));
  const shade = new Float32Array(n + 2 * border);
  const height = (i: number, j: number): number => {
    const z = values[Math.min(Math.max(j, 0), rows - 1) * columns + Math.min(Math.max(i, 0), columns - 1)];
    return Number.isNaN(z) ? relief.lowest : z;
  };
  for (let j = 0, k = 0; j < rows; ++j) {
    for (let i = 0; i < columns; ++i, ++k) {
      position[3 * k] = grid.west + (i + 0.5) * cell - origin[0];
      position[3 * k + 1] = grid.south + (j + 0.5) * cell - origin[1];
      position[3 * k + 2] = height(i, j) - origin[2];
      const dx = (height(i + 1, j) - height(i - 1, j)) / (2 * cell);
      const dy = (height(i, j + 1) - height(i, j - 1)) / (2 * cell);
      const length = Math.hypot(dx, dy, 1);
      normal[3 * k] = -dx / length;
      normal[3 * k + 1] = -dy / length;
      normal[3 * k + 2] = 1 / length;
      shade[k] = sky[k];
    }
  }
  const index = new Uint32Array(6 * (columns - 1) * (rows - 1) + 6 * border);
  let corners = 0;
  const triangles = (...of: [number, number, number, number, number, number]): void => {
    for (let c = 0; c < 6; ++c) index[corners++] = of[c];
  };
  for (let j = 0; j + 1 < rows; ++j) {
    for (let i = 0; i + 1 < columns; ++i) {
      const k = j * columns + i;
      if (Number.isNaN(values[k] + values[k + 1] + values[k + columns] + values[k + columns + 1])) continue;
      triangles(k, k + 1, k + columns + 1, k, k + columns + 1, k + columns);
    }
  }
  // Side walls go down to a common floor.
  const floor = relief.lowest - origin[2] - 0.06 * Math.max(relief.width, relief.height);
  const ring: [number, number, number, number][] = [];
  for (let i = 0; i + 1 < columns; ++i) ring.push([i, 0, 0, -1]);
  for (let j = 0; j + 1 < rows; ++j) ring.push([columns - 1, j, 1, 0]);
  for (let i = columns - 1; i > 0; --i) ring.push([i, rows - 1, 0, 1]);
  for (let j = rows - 1; j > 0; --j) ring.push([0, j, -1, 0]);
  ring.forEach(([i, j, nx, ny], r) => {
    const from = 3 * (j * columns + i);
    for (const low of [0, 1]) {
      const k = n + 2 * r + low;
      position.set([position[from], position[from + 1], low ? floor : position[from + 2]], 3 * k);
      normal.set([nx, ny, 0], 3 * k);
      shade[k] = -1;
    }
    const a = n + 2 * r;
    const b = n + 2 * ((r + 1) % ring.length);
    triangles(a, a + 1, b, b, a + 1, b + 1);
  });
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(position, 3));
  geometry.setAttribute("normal", new BufferAttribute(normal, 3));
  geometry.setAttribute("shade", new BufferAttribute(shade, 1));
  geometry.setIndex(new BufferAttribute(index.subarray(0, corners), 1));
  geometry.computeBoundingSphere();
  return geometry;
}

/** A map drawn over the ground: local west, local south, 1 / width, 1 / height in metres. */
export interface Draped {
  texture: Texture;
  placing: Vector4;
}
/** gain: makes its mean as bright as ground is in the mean. */
export interface Photo extends Draped { gain: number }

const groundRamp = rampTexture(groundColour);
const nothing = new DataTexture(new Uint8Array(4), 1, 1, RGBAFormat);
nothing.needsUpdate = true;

/** Filtered, so that the ground changes smoothly from cell to cell. */
function sunkTexture(depth: Grid): DataTexture {
  const texture = new DataTexture(depth.values.map((v) => (v > 0 ? v : 0)) as Float32Array<ArrayBuffer>, depth.columns, depth.rows, RedFormat, FloatType);
  texture.internalFormat = "R16F";
  texture.minFilter = texture.magFilter = LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

/** Contour interval for about 30 lines over the relief; every fifth is an index contour. */
export function contourInterval(relief: Relief): number {
  return roundStep((relief.highest - relief.lowest) / 40);
}

export class Ground {
  readonly mesh: Mesh;
  readonly uniforms: Record<string, IUniform> & {
    uSurface: IUniform<number>; uFlowTime: IUniform<number>; uContour: IUniform<number>; uLayerOpacity: IUniform<number>;
  };

  /** onEarth: heights are those of a place on Earth, so that level ground at 0 m is the sea, and not the floor of a laboratory. */
  constructor(geometry: BufferGeometry, private readonly relief: Relief, further: Record<string, IUniform>, onEarth: boolean) {
    const low = relief.lowest - relief.origin[2];
    this.uniforms = {
      ...further,
      uGroundRamp: { value: groundRamp },
      uElevation: { value: new Vector2(low, Math.max(1, relief.highest - relief.lowest)) },
      uOriginZ: { value: relief.origin[2] },
      uContourInterval: { value: contourInterval(relief) },
      uContour: { value: 1 },
      uSurface: { value: 0 },
      uSurfaceBySpeed: { value: 0 },
      uSurfaceRamp: { value: nothing },
      uSurfaceTop: { value: 1 },
      uLayer: { value: nothing },
      uLayerPlacing: { value: new Vector4() },
      uLayerRamp: { value: nothing },
      uLayerRange: { value: new Vector2(0, 1) },
      uLayerOpacity: { value: 0 },
      uPhoto: { value: nothing },
      uPhotoPlacing: { value: new Vector4() },
      uPhotoShown: { value: 0 },
      uOver: { value: nothing },
      uOverPlacing: { value: new Vector4() },
      uSunk: { value: nothing },
      uSunkPlacing: { value: new Vector4() },
      uCell: { value: relief.grid.cell },
      uDrawn: { value: nothing },
      uDrawnPlacing: { value: new Vector4() },
      uWide: { value: nothing },
      uWidePlacing: { value: new Vector4() },
      uTrail: { value: nothing },
      uTrailPlacing: { value: new Vector4() },
      uShade: { value: nothing },
      uShadePlacing: { value: new Vector4() },
      uFlowTime: { value: 0 },
      uPhotoGain: { value: 1 },
      uSea: { value: onEarth ? 1 : 0 },
    };
    const material = forLook(new MeshLambertMaterial(), further["uNatural"]);
    material.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, this.uniforms);
      shader.vertexShader = shader.vertexShader
        .replace("#include <common>", `#include <common>\n${sharedHead}\n${groundVertex.head}`)
        .replace("#include <beginnormal_vertex>", `#include <beginnormal_vertex>\n${groundVertex.normal}`)
        .replace("#include <begin_vertex>", `#include <begin_vertex>\n${groundVertex.place}`);
      shader.fragmentShader = shader.fragmentShader
        .replace("#include <common>", `#include <common>\n${sharedHead}\n${groundFragment.head}\n${naturalGround.head}`)
        .replace("#include <color_fragment>", `${groundFragment.colour}\n${naturalGround.colour}`)
        .replace("#include <normal_fragment_begin>", `#include <normal_fragment_begin>\n${groundNormal}\n${naturalGround.normal}`)
        .replace("#include <opaque_fragment>", `${naturalGround.light}\n#include <opaque_fragment>`);
    };
    this.mesh = new Mesh(geometry, material);
    this.mesh.receiveShadow = true;
    this.mesh.frustumCulled = false;
  }

  set<T>(name: string, value: T): void {
    const uniform = this.uniforms[name];
    if (uniform) uniform.value = value;
  }
  /** wide: areas that may cover all of the ground; below `drawn`, whose own picture stays sharp beside them. */
  drape(drawn: Draped, wide: Draped): void {
    this.set("uDrawn", drawn.texture);
    this.set("uDrawnPlacing", drawn.placing);
    this.set("uWide", wide.texture);
    this.set("uWidePlacing", wide.placing);
  }
  /** An orthophoto instead of the elevation colours; null: none. */
  showPhoto(photo: Photo | null): void {
    this.set("uPhoto", photo?.texture ?? nothing);
    if (photo) {
      this.set("uPhotoPlacing", photo.placing);
      this.set("uPhotoGain", photo.gain);
    }
    this.set("uPhotoShown", photo ? 1 : 0);
  }
  /** Layers of people, above the ground and its photo; null: none. */
  cover(layers: Draped | null): void {
    this.set("uOver", layers?.texture ?? nothing);
    this.set("uOverPlacing", layers?.placing ?? new Vector4());
  }
  /** Where debris has been. */
  layTrail({ texture, placing }: Draped): void {
    this.set("uTrail", texture);
    this.set("uTrailPlacing", placing);
  }
  /** Shade of hills. */
  shadeBy({ texture, placing }: Draped): void {
    this.set("uShade", texture);
    this.set("uShadePlacing", placing);
  }
  /** Lowers the ground by `depth`, NaN: unchanged; null: the scene's ground. */
  sink(depth: Grid | null): void {
    if (this.uniforms["uSunk"].value !== nothing) (this.uniforms["uSunk"].value as Texture).dispose();
    const { west, south, cell, columns, rows } = depth ?? { west: 0, south: 0, cell: 1, columns: 0, rows: 0 };
    this.set("uSunk", depth ? sunkTexture(depth) : nothing);
    this.set("uSunkPlacing", depth ? new Vector4(west - this.relief.origin[0], south - this.relief.origin[1], 1 / (columns * cell), 1 / (rows * cell)) : new Vector4());
  }
  /** range: values at the ends of the ramp; `opacity` 0 hides the layer. */
  showLayer(layer: Draped | null, ramp: Texture | null, range: [number, number], opacity: number): void {
    this.set("uLayer", layer?.texture ?? nothing);
    if (layer) this.set("uLayerPlacing", layer.placing);
    this.set("uLayerRamp", ramp ?? nothing);
    this.set("uLayerRange", new Vector2(...range));
    this.uniforms.uLayerOpacity.value = layer ? opacity : 0;
  }
  /** The debris as a surface, coloured by depth or speed up to `top`. */
  showSurface(shown: boolean, bySpeed: boolean, ramp: Texture, top: number): void {
    this.uniforms.uSurface.value = shown ? 1 : 0;
    this.set("uSurfaceBySpeed", bySpeed ? 1 : 0);
    this.set("uSurfaceRamp", ramp);
    this.set("uSurfaceTop", top);
  }
  dispose(): void {
    this.sink(null);
    (this.mesh.material as MeshLambertMaterial).dispose();
  }
}

export const rampTextureOf = (ramp: Parameters<typeof rampAt>[0]): DataTexture => rampTexture((share) => rampAt(ramp, share));
