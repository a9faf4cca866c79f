// Houses of the natural look: walls with windows, roofs over them, all in one mesh. A roof stands on the walls, whose upper edge is
// the top of the solid that debris meets: above it nothing is computed.
import { BufferGeometry, Color, Float32BufferAttribute, Mesh, MeshLambertMaterial, ShapeUtils, Vector2, type IUniform } from "three";
import type { Building, Place, Point } from "../../protocol/messages";
import type { Relief } from "../relief";
import { lit } from "./lit";
import { scattered } from "./noise";

const plaster = ["#e9e2d3", "#dfd3bd", "#e6dccb", "#d8d4cc", "#e3d2b4"];
const tiles = ["#8a4a33", "#6f4230", "#7d5140", "#5b5552", "#8f5a40"];
const flatRoof = "#8d8a84";

/** aWall: distance along a wall and its length, height above the ground, 1 on walls; of roofs 0. */
const shader = {
  vertexHead: "attribute vec4 aWall; varying vec4 vWall;",
  place: "vWall = aWall;",
  head: /* glsl */ `
    varying vec4 vWall;
    float pane = 0.0;
    float between(float low, float high, float x) {
      float soft = max(fwidth(x), 0.004);
      return smoothstep(low - soft, low + soft, x) * (1.0 - smoothstep(high - soft, high + soft, x));
    }
  `,
  colour: /* glsl */ `
    vec2 grainAt = vWall.w > 0.5 ? vWall.xz : vWall.xy;
    float grain = texture2D(uNoise, grainAt / 5.0).b;
    if (vWall.w > 0.5) {
      float bays = max(1.0, floor(vWall.y / 2.7));
      vec2 at = vec2(fract(vWall.x / vWall.y * bays), fract(vWall.z / 3.0));
      float there = step(1.6, vWall.y / bays) * step(0.2, vWall.z);
      float frame = between(0.27, 0.73, at.x) * between(0.30, 0.80, at.y) * there;
      float cross = between(0.485, 0.515, at.x);
      pane = between(0.30, 0.70, at.x) * between(0.34, 0.77, at.y) * there * (1.0 - cross);
      diffuseColor.rgb *= 0.82 + 0.3 * grain;
      // Rain splashes the foot of a wall.
      diffuseColor.rgb *= 0.72 + 0.28 * smoothstep(-0.3, 0.9, vWall.z + 0.6 * (grain - 0.5));
      diffuseColor.rgb = mix(diffuseColor.rgb, vec3(0.42, 0.40, 0.37), 0.8 * frame * (1.0 - pane));
      diffuseColor.rgb = mix(diffuseColor.rgb, vec3(0.020, 0.024, 0.028), pane);
    } else {
      float course = between(0.12, 1.0, fract(vWall.y / 0.42));
      diffuseColor.rgb *= (0.72 + 0.4 * grain) * mix(1.0, 0.8 + 0.2 * course, step(0.01, vWall.z));
    }
  `,
  light: /* glsl */ `
    if (pane > 0.0) {
      vec3 worldNormal = normalize((vec4(normal, 0.0) * viewMatrix).xyz);
      vec3 from = normalize(sight);
      float mirror = 0.06 + 0.6 * pow(1.0 - max(dot(worldNormal, -from), 0.0), 4.0);
      outgoingLight += pane * mirror * skyTowards(reflect(from, worldNormal));
    }
  `,
};

class Builder {
  readonly position: number[] = [];
  readonly normal: number[] = [];
  readonly wall: number[] = [];

  get count(): number {
    return this.position.length / 3;
  }
  /** A flat face from its corners, counter-clockwise seen from outside; `wall` of each corner. */
  face(corners: readonly Place[], wall: readonly (readonly [number, number, number, number])[]): void {
    const [a, b, c] = corners;
    const u = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
    const v = [c[0] - a[0], c[1] - a[1], c[2] - a[2]];
    const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    const length = Math.hypot(n[0], n[1], n[2]) || 1;
    for (let k = 1; k + 1 < corners.length; ++k) {
      for (const corner of [0, k, k + 1]) {
        this.position.push(...corners[corner]);
        this.normal.push(n[0] / length, n[1] / length, n[2] / length);
        this.wall.push(...wall[corner]);
      }
    }
  }
  /** Of a roof: distances along the eaves and up the slope, for its tiles. */
  slope(corners: readonly Place[], tiled: boolean): void {
    const [a, b] = corners;
    const length = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
    const along = [(b[0] - a[0]) / length, (b[1] - a[1]) / length];
    this.face(corners, corners.map((p) => {
      const [x, y] = [p[0] - a[0], p[1] - a[1]];
      return [x * along[0] + y * along[1], Math.hypot(y * along[0] - x * along[1], p[2] - a[2]), tiled ? 1 : 0, 0];
    }));
  }
}

/** Counter-clockwise, without a repeated last point. */
function ringOf(ring: readonly Point[], clockwise = false): Point[] {
  const open = ring.length > 1 && ring[0][0] === ring[ring.length - 1][0] && ring[0][1] === ring[ring.length - 1][1] ? ring.slice(0, -1) : [...ring];
  const area = ShapeUtils.area(open.map(([x, y]) => new Vector2(x, y)));
  return area < 0 !== clockwise ? open.reverse() : open;
}

/** A hipped roof over four corners that are nearly a rectangle: its ridge runs along the longer sides. */
function hipped(into: Builder, ring: readonly Point[], eaves: number): boolean {
  if (ring.length !== 4) return false;
  const side = (k: number): number => Math.hypot(ring[(k + 1) % 4][0] - ring[k][0], ring[(k + 1) % 4][1] - ring[k][1]);
  const even = (a: number, b: number): boolean => Math.min(a, b) > 0.6 * Math.max(a, b);
  if (!even(side(0), side(2)) || !even(side(1), side(3)) || Math.min(side(0), side(1)) < 2) return false;
  const long = side(0) + side(2) >= side(1) + side(3) ? 0 : 1;
  const middle: Point = [(ring[0][0] + ring[1][0] + ring[2][0] + ring[3][0]) / 4, (ring[0][1] + ring[1][1] + ring[2][1] + ring[3][1]) / 4];
  const broad = (side(long + 1) + side((long + 3) % 4)) / 2;
  const corners = [0, 1, 2, 3].map((k): Place => {
    const [x, y] = ring[(k + long) % 4];
    const away = Math.hypot(x - middle[0], y - middle[1]) || 1;
    return [x + (0.45 * (x - middle[0])) / away, y + (0.45 * (y - middle[1])) / away, eaves - 0.08];
  });
  const top = eaves + Math.min(2.6, 0.3 * broad);
  // Corners 0-1 and 2-3 are the long sides.
  const end = (a: Place, b: Place, towards: Place, other: Place): Place => {
    const [x, y] = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
    const [tx, ty] = [(towards[0] + other[0]) / 2, (towards[1] + other[1]) / 2];
    const length = Math.hypot(tx - x, ty - y) || 1;
    const inset = Math.min(0.45 * length, 0.42 * broad);
    return [x + ((tx - x) / length) * inset, y + ((ty - y) / length) * inset, top];
  };
  const first = end(corners[3], corners[0], corners[1], corners[2]);
  const second = end(corners[1], corners[2], corners[3], corners[0]);
  into.slope([corners[0], corners[1], second, first], true);
  into.slope([corners[2], corners[3], first, second], true);
  into.slope([corners[1], corners[2], second], true);
  into.slope([corners[3], corners[0], first], true);
  return true;
}

export class Houses {
  readonly mesh: Mesh<BufferGeometry, MeshLambertMaterial>;
  /** First and last vertex of walls, of walls and roofs, and own colours, by id. */
  private readonly parts = new Map<string, { from: number; roof: number; to: number; wall: Color; tile: Color }>();

  constructor(uniforms: Record<string, IUniform>) {
    this.mesh = new Mesh(new BufferGeometry(), lit(new MeshLambertMaterial({ vertexColors: true }), uniforms, shader));
    this.mesh.castShadow = this.mesh.receiveShadow = true;
    this.mesh.visible = false;
  }
  build(buildings: readonly Building[], relief: Relief): void {
    const into = new Builder();
    this.parts.clear();
    const [ox, oy, oz] = relief.origin;
    buildings.forEach((building, number) => {
      const { base_m, roof_m } = building;
      if (base_m === null || roof_m === null) return;  // it stands on no known ground
      const from = into.count;
      const roofs: (() => boolean)[] = [];
      const eaves = roof_m - oz;
      for (const polygon of building.polygons) {
        const rings = polygon.map((ring, k) => ringOf(ring.map(([x, y]): Point => [x - ox, y - oy]), k > 0));
        if (rings.length === 0 || rings[0].length < 3) continue;
        const base = Math.min(base_m, ...rings[0].map(([x, y]) => relief.at(x + ox, y + oy))) - 0.5 - oz;
        const ground = base_m - oz;
        for (const ring of rings) {
          ring.forEach((a, k) => {
            const b = ring[(k + 1) % ring.length];
            const length = Math.hypot(b[0] - a[0], b[1] - a[1]);
            into.face([[a[0], a[1], base], [b[0], b[1], base], [b[0], b[1], eaves], [a[0], a[1], eaves]],
              [[0, length, base - ground, 1], [length, length, base - ground, 1], [length, length, eaves - ground, 1], [0, length, eaves - ground, 1]]);
          });
        }
        roofs.push(() => {
          if (rings.length === 1 && hipped(into, rings[0], eaves)) return true;
          const all = rings.flat();
          const flat = ShapeUtils.triangulateShape(rings[0].map(([x, y]) => new Vector2(x, y)), rings.slice(1).map((r) => r.map(([x, y]) => new Vector2(x, y))));
          for (const triangle of flat) into.slope(triangle.map((k): Place => [...all[k], eaves]), false);
          return false;
        });
      }
      const roof = into.count;
      const tiled = roofs.map((lay) => lay()).some((is) => is);
      const pick = (list: readonly string[], seed: number): Color => new Color(list[Math.floor(scattered(number, building.id.length, seed) * list.length)]);
      this.parts.set(building.id, { from, roof, to: into.count, wall: pick(plaster, 3), tile: tiled ? pick(tiles, 5) : new Color(flatRoof) });
    });
    this.mesh.geometry.dispose();
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new Float32BufferAttribute(into.position, 3));
    geometry.setAttribute("normal", new Float32BufferAttribute(into.normal, 3));
    geometry.setAttribute("aWall", new Float32BufferAttribute(into.wall, 4));
    geometry.setAttribute("color", new Float32BufferAttribute(new Float32Array(into.position.length), 3));
    this.mesh.geometry = geometry;
    this.mesh.frustumCulled = false;
    for (const id of this.parts.keys()) this.colour(id, null, false);
  }
  /** Walls of a house that was hit in the colour of its intensity or pressure; null: its own. */
  colour(id: string, impact: string | null, selected: boolean): void {
    const part = this.parts.get(id);
    const colours = this.mesh.geometry.getAttribute("color");
    if (!part || !colours) return;
    const wall = impact === null ? part.wall.clone() : new Color(impact);
    const tile = part.tile.clone();
    if (selected) for (const colour of [wall, tile]) colour.lerp(new Color("#1d86ab"), 0.6);
    for (let k = part.from; k < part.to; ++k) {
      const { r, g, b } = k < part.roof ? wall : tile;
      colours.setXYZ(k, r, g, b);
    }
    colours.needsUpdate = true;
  }
  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }
}
