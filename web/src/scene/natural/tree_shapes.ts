// Shapes of trees: of height and crown radius 1, with few triangles, darker below and inside.
import { BufferAttribute, BufferGeometry, ConeGeometry, CylinderGeometry, IcosahedronGeometry, Vector3 } from "three";
import { mergeVertices } from "three/examples/jsm/utils/BufferGeometryUtils.js";
import { scattered } from "./noise";

type Rgb = readonly [number, number, number];
const bark: Rgb = [0.11, 0.08, 0.055];

class Shape {
  private readonly position: number[] = [];
  private readonly normal: number[] = [];
  private readonly colour: number[] = [];
  /** 0 of the stem, 1 of the crown. */
  private readonly crown: number[] = [];
  private readonly index: number[] = [];

  /** `change` moves each corner; normals point away from `middle`, so that few faces look round. */
  add(solid: BufferGeometry, middle: Vector3, crown: 0 | 1, colour: (at: Vector3) => Rgb, change: (at: Vector3) => void = () => {}): this {
    for (const name of ["normal", "uv"]) solid.deleteAttribute(name);
    const merged = mergeVertices(solid, 1e-4);
    const first = this.position.length / 3;
    const corners = merged.getAttribute("position");
    const at = new Vector3();
    for (let k = 0; k < corners.count; ++k) {
      change(at.fromBufferAttribute(corners, k));
      this.position.push(at.x, at.y, at.z);
      this.colour.push(...colour(at));
      this.crown.push(crown);
      at.sub(middle).normalize();
      this.normal.push(at.x, at.y, at.z);
    }
    for (const k of merged.getIndex()?.array ?? []) this.index.push(first + k);
    return this;
  }
  made(): BufferGeometry {
    const geometry = new BufferGeometry();
    for (const [name, values, size] of [["position", this.position, 3], ["normal", this.normal, 3], ["color", this.colour, 3], ["aCrown", this.crown, 1]] as const) {
      geometry.setAttribute(name, new BufferAttribute(new Float32Array(values), size));
    }
    return geometry.setIndex(this.index);
  }
}

function stem(high: number): Shape {
  const solid = new CylinderGeometry(0.03, 0.06, high, 5, 1, true).rotateX(Math.PI / 2).translate(0, 0, high / 2);
  return new Shape().add(solid, new Vector3(0, 0, high / 2), 0, () => bark);
}

/** A crown of several rounded parts. */
export function broadleaf(): BufferGeometry {
  const shape = stem(0.5);
  const middle = new Vector3(0, 0, 0.5);
  const lit = ({ x, y, z }: Vector3): Rgb => {
    const light = 0.42 + 0.75 * Math.min(1, Math.max(0, (z - 0.3) / 0.65)) * Math.min(1, 0.55 + 0.5 * Math.hypot(x, y));
    return [0.050 * light, 0.085 * light, 0.028 * light];
  };
  const parts: [number, number, number, number, number][] = [[0.06, -0.03, 0.76, 0.78, 0.24], [-0.50, 0.26, 0.60, 0.62, 0.20], [0.42, 0.46, 0.63, 0.58, 0.19], [0.22, -0.54, 0.58, 0.62, 0.19]];
  parts.forEach(([x, y, z, wide, high], part) => {
    shape.add(new IcosahedronGeometry(1, 0), middle, 1, lit, (at) => {
      const bump = 0.88 + 0.24 * scattered(Math.round(40 * at.x), Math.round(40 * at.y), Math.round(40 * at.z) + part);
      at.set(x + wide * bump * at.x, y + wide * bump * at.y, z + high * bump * at.z);
    });
  });
  return shape.made();
}

/** Whorls of branches, narrower towards the top. */
export function conifer(): BufferGeometry {
  const shape = stem(0.3);
  const whorls: [number, number, number][] = [[0.14, 0.58, 0.80], [0.36, 0.80, 0.60], [0.58, 1.0, 0.40]];
  whorls.forEach(([foot, top, wide], whorl) => {
    const cone = new ConeGeometry(wide, top - foot, 7, 1, true).rotateX(Math.PI / 2).rotateZ(whorl).translate(0, 0, (foot + top) / 2);
    const lit = ({ x, y, z }: Vector3): Rgb => {
      const light = 0.5 + 0.45 * z + 0.25 * Math.min(1, Math.hypot(x, y) / wide);
      return [0.030 * light, 0.060 * light, 0.026 * light];
    };
    shape.add(cone, new Vector3(0, 0, foot - 0.05), 1, lit, (at) => {
      if (at.z < foot + 0.01) at.z += 0.07 * (scattered(Math.round(40 * at.x), Math.round(40 * at.y), whorl) - 0.5);
    });
  });
  return shape.made();
}
