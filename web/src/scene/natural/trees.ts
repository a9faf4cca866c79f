// Trees in forest zones: as many stems as the zone has, as thick as they are, at places that are always the same. One mesh, one call.
import { BufferAttribute, BufferGeometry, Color, CylinderGeometry, IcosahedronGeometry, InstancedMesh, Matrix4, MeshLambertMaterial, type IUniform } from "three";
import type { Point, Zone } from "../../protocol/messages";
import type { Relief } from "../relief";
import { lit } from "./lit";
import { scattered } from "./noise";

/** Of one view: beyond it trees are farther apart than the zone has them. */
export const mostTrees = 4000;
/** Height over stem diameter. */
const slenderness = 45;

export interface Tree { x: number; y: number; height: number; crown: number; number: number }

function inside(polygon: readonly (readonly Point[])[], x: number, y: number): boolean {
  let within = false;
  for (const ring of polygon) {
    for (let k = 0, last = ring.length - 1; k < ring.length; last = k++) {
      const [ax, ay] = ring[k];
      const [bx, by] = ring[last];
      if (ay > y !== by > y && x < ((bx - ax) * (y - ay)) / (by - ay) + ax) within = !within;
    }
  }
  return within;
}

/** Stems on a jittered grid whose cells are as large as the ground that a tree has. */
export function treesOf(zones: readonly Zone[], most = mostTrees): Tree[] {
  const forests = zones.filter((zone) => (zone.stem_density_pm2 ?? 0) > 0 && zone.polygons.length > 0);
  const wanted = forests.reduce((sum, zone) => sum + zone.area_m2 * (zone.stem_density_pm2 ?? 0), 0);
  const thinned = Math.min(1, most / Math.max(1, wanted));
  const trees: Tree[] = [];
  for (const zone of forests) {
    const step = 1 / Math.sqrt((zone.stem_density_pm2 ?? 1) * thinned);
    const height = Math.min(28, Math.max(3, slenderness * (zone.stem_diameter_m ?? 0.25)));
    for (const polygon of zone.polygons) {
      const xs = polygon[0].map((p) => p[0]);
      const ys = polygon[0].map((p) => p[1]);
      for (let j = Math.floor(Math.min(...ys) / step); j <= Math.max(...ys) / step; ++j) {
        for (let i = Math.floor(Math.min(...xs) / step); i <= Math.max(...xs) / step; ++i) {
          const x = (i + scattered(i, j, 1)) * step;
          const y = (j + scattered(i, j, 2)) * step;
          if (!inside(polygon, x, y) || trees.length >= most) continue;
          const grown = 0.65 + 0.5 * scattered(i, j, 3);
          trees.push({ x, y, height: grown * height, crown: Math.min(0.26 * height, 0.62 / Math.sqrt(zone.stem_density_pm2 ?? 1)) * (0.8 + 0.5 * scattered(i, j, 4)), number: i * 7919 + j });
        }
      }
    }
  }
  return trees;
}

/** A tree of height and crown radius 1: a stem, and a crown of uneven height that is darker below. */
function shape(): BufferGeometry {
  const stem = new CylinderGeometry(0.035, 0.06, 0.5, 5, 1, true).toNonIndexed().rotateX(Math.PI / 2).translate(0, 0, 0.25);
  const crown = new IcosahedronGeometry(1, 1);
  const position: number[] = [...(stem.getAttribute("position").array as Float32Array)];
  const normal: number[] = [...(stem.getAttribute("normal").array as Float32Array)];
  const colour: number[] = position.map((_, k) => [0.11, 0.08, 0.055][k % 3]);
  const at = crown.getAttribute("position").array as Float32Array;
  for (let k = 0; k < at.length; k += 3) {
    const [x, y, z] = [at[k], at[k + 1], at[k + 2]];
    const bump = 0.86 + 0.28 * scattered(Math.round(40 * x), Math.round(40 * y), Math.round(40 * z));
    position.push(x * bump, y * bump, 0.62 + 0.38 * z * bump);
    normal.push(x, y, z);
    const light = 0.5 + 0.5 * Math.max(0, 0.5 + 0.5 * z);
    colour.push(0.050 * light, 0.085 * light, 0.028 * light);
  }
  const geometry = new BufferGeometry();
  for (const [name, values] of [["position", position], ["normal", normal], ["color", colour]] as const) geometry.setAttribute(name, new BufferAttribute(new Float32Array(values), 3));
  return geometry;
}

export class Trees {
  readonly mesh: InstancedMesh<BufferGeometry, MeshLambertMaterial>;
  private count = 0;

  constructor(uniforms: Record<string, IUniform>) {
    this.mesh = new InstancedMesh(shape(), lit(new MeshLambertMaterial({ vertexColors: true }), uniforms, { colour: "diffuseColor.rgb *= 1.0;" }), mostTrees);
    this.mesh.castShadow = true;
    this.mesh.frustumCulled = false;
    this.mesh.visible = false;
    this.mesh.count = 0;
  }
  plant(zones: readonly Zone[], relief: Relief): void {
    const matrix = new Matrix4();
    const turned = new Matrix4();
    const tint = new Color();
    const trees = treesOf(zones);
    trees.forEach(({ x, y, height, crown, number }, k) => {
      matrix.makeScale(crown, crown, height).multiply(turned.makeRotationZ(number));
      const [lx, ly, lz] = relief.local(x, y, -0.2);
      this.mesh.setMatrixAt(k, matrix.setPosition(lx, ly, lz));
      const pale = scattered(number, 11);
      this.mesh.setColorAt(k, tint.setRGB(0.75 + 0.6 * pale, 0.8 + 0.35 * pale, 0.8));
    });
    this.count = trees.length;
    this.mesh.instanceMatrix.needsUpdate = true;
    if (this.mesh.instanceColor) this.mesh.instanceColor.needsUpdate = true;
  }
  /** detail: of slow graphics 1 and 0. */
  show(shown: boolean, detail: number): void {
    this.mesh.visible = shown && this.count > 0;
    this.mesh.count = detail > 0 ? this.count : Math.ceil(this.count / 3);
  }
  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
    this.mesh.dispose();
  }
}
