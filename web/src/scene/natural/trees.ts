// Trees of forest zones: two meshes, of broadleaved trees and of conifers, whose places change with the setup only.
import { Box3, Color, InstancedBufferAttribute, InstancedMesh, Matrix4, MeshLambertMaterial, Vector3, type BufferGeometry, type IUniform } from "three";
import type { Place } from "../../protocol/messages";
import type { Relief } from "../relief";
import { mostTrees, treesOf, type Planted, type Tree } from "./forest";
import { lit } from "./lit";
import { scattered } from "./noise";
import { broadleaf, conifer } from "./tree_shapes";
import { hidesDebris, type Behind } from "./veil";

/** Trees that are looked at per picture: all of them at once would take longer than a picture may. */
const lookedAt = 800;

/** Stems stand the flow, in the model too; crowns over deep debris would hide it. */
const shader = {
  vertexHead: /* glsl */ `
    attribute float aCrown, aVeil;
    uniform sampler2D uTrail;
    uniform vec4 uTrailPlacing;
    varying vec4 vLeaf;
    varying float vVeil;
  `,
  place: /* glsl */ `
    vVeil = aVeil * aCrown;
    vLeaf = vec4(position + instanceMatrix[3].xyz * 0.37, aCrown);
    vec2 trailAt = (instanceMatrix[3].xy - uTrailPlacing.xy) * uTrailPlacing.zw;
    bool mapped = uTrailPlacing.z > 0.0 && all(greaterThan(trailAt, vec2(0.0))) && all(lessThan(trailAt, vec2(1.0)));
    if (mapped && 5.0 * texture2D(uTrail, trailAt).r > 1.0) transformed *= aCrown > 0.5 ? vec3(0.0) : vec3(1.0, 1.0, 0.6);
  `,
  head: "varying vec4 vLeaf; varying float vVeil;",
  colour: /* glsl */ `
    // Pixels are left out, in an even pattern (Jimenez 2014, interleaved gradient noise): nothing needs to be sorted.
    if (vVeil > 0.01 && fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715)))) < 0.8 * vVeil) discard;
    float leaves = texture2D(uNoise, vec2(vLeaf.x + 0.6 * vLeaf.y, vLeaf.z * 2.0 - 0.5 * vLeaf.y) * 0.7).b;
    diffuseColor.rgb *= mix(1.0, 0.25 + 1.5 * leaves, vLeaf.w);
  `,
};

type TreeMesh = InstancedMesh<BufferGeometry, MeshLambertMaterial>;

export class Trees {
  readonly meshes: readonly TreeMesh[];
  /** What they fill; empty: there are none. */
  readonly extent = new Box3();
  private planted: Tree[][] = [[], []];
  private readonly veils: readonly InstancedBufferAttribute[];
  /** Of all trees, the next to be looked at, and how many are still to be. */
  private next = 0;
  private left = 0;

  /** conifers: their share. uniforms: of the ground, with its trail. */
  constructor(uniforms: Record<string, IUniform>, private readonly conifers: number) {
    this.meshes = [broadleaf(), conifer()].map((shape) => {
      const mesh = new InstancedMesh(shape, lit(new MeshLambertMaterial({ vertexColors: true }), uniforms, shader), mostTrees);
      mesh.castShadow = true;
      mesh.frustumCulled = false;
      mesh.visible = false;
      return mesh;
    });
    this.veils = this.meshes.map(({ geometry }) => {
      const veil = new InstancedBufferAttribute(new Float32Array(mostTrees), 1);
      geometry.setAttribute("aVeil", veil);
      return veil;
    });
  }
  /** Trees of the next picture. */
  get shown(): number {
    let count = 0;
    for (const mesh of this.meshes) if (mesh.visible) count += mesh.count;
    return count;
  }
  /** Places on the ground of time 0; `stand` gives their heights. */
  plant(setup: Planted, relief: Relief): void {
    // In no order, so that a part of them is spread over all of the forest.
    const trees = treesOf(setup, relief).map((tree) => ({ tree, at: scattered(tree.number, 13) })).sort((a, b) => a.at - b.at).map(({ tree }) => tree);
    const isConifer = ({ number }: Tree): boolean => scattered(number, 12) < this.conifers;
    this.planted = [trees.filter((tree) => !isConifer(tree)), trees.filter(isConifer)];
    const matrix = new Matrix4();
    const turned = new Matrix4();
    const tint = new Color();
    this.planted.forEach((list, which) => list.forEach(({ height, crown, number }, k) => {
      const wide = which === 1 ? 0.75 * crown : crown;
      this.meshes[which].setMatrixAt(k, matrix.makeScale(wide, wide, (which === 1 ? 1.1 : 0.85) * height).multiply(turned.makeRotationZ(number)));
      const [pale, warm] = [scattered(number, 11), scattered(number, 14)];
      this.meshes[which].setColorAt(k, tint.setRGB((0.6 + 0.75 * pale) * (0.8 + 0.45 * warm), 0.7 + 0.5 * pale, (0.7 + 0.4 * pale) * (1.15 - 0.4 * warm)));
    }));
    this.left = trees.length;
    for (const { instanceColor } of this.meshes) if (instanceColor) instanceColor.needsUpdate = true;
  }
  /** Puts the trees on a ground: that of time 0, or one that erosion has lowered. */
  stand(relief: Relief): void {
    this.extent.makeEmpty();
    const at = new Vector3();
    this.planted.forEach((list, which) => {
      const { instanceMatrix } = this.meshes[which];
      list.forEach(({ x, y, height }, k) => {
        at.set(...relief.local(x, y, -0.2)).toArray(instanceMatrix.array, 16 * k + 12);
        this.extent.expandByPoint(at);
        at.z += height;
        this.extent.expandByPoint(at);
      });
      instanceMatrix.needsUpdate = true;
    });
  }
  /**
   * Thins the crowns that hide debris, of some trees per picture; true while there are more. eye: null: none is hidden, as in a plan.
   * moved: the eye or the debris, since the last picture.
   */
  veil(eye: Place | null, behind: Behind, moved: boolean): boolean {
    const total = this.planted[0].length + this.planted[1].length;
    if (moved) this.left = total;  // also while they are not drawn: they are looked at once they are
    if (total === 0 || !this.meshes.some((mesh) => mesh.visible)) return false;
    const now = Math.min(this.left, lookedAt);
    for (let n = 0; n < now; ++n) {
      const at = (this.next + n) % total;
      const [which, k] = at < this.planted[0].length ? [0, at] : [1, at - this.planted[0].length];
      const matrix = this.meshes[which].instanceMatrix.array;
      const foot: Place = [matrix[16 * k + 12], matrix[16 * k + 13], matrix[16 * k + 14]];
      const veil = eye !== null && hidesDebris({ foot, height: this.planted[which][k].height }, eye, behind) ? 1 : 0;
      if (this.veils[which].array[k] === veil) continue;
      this.veils[which].array[k] = veil;
      this.veils[which].needsUpdate = true;
    }
    this.next = (this.next + now) % total;
    this.left -= now;
    return this.left > 0;
  }
  /** detail: of slow graphics 1 and 0. */
  show(shown: boolean, detail: number): void {
    for (let which = 0; which < this.meshes.length; ++which) {
      const { length } = this.planted[which];
      this.meshes[which].visible = shown && length > 0;
      this.meshes[which].count = detail > 0 ? length : Math.ceil(length / 3);
    }
  }
  dispose(): void {
    for (const mesh of this.meshes) {
      mesh.geometry.dispose();
      mesh.material.dispose();
      mesh.dispose();
    }
  }
}
