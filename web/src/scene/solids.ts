// Houses and barriers as solids with shadows.
import {
  BufferGeometry, EdgesGeometry, ExtrudeGeometry, Float32BufferAttribute, Group, LineBasicMaterial, LineSegments, Mesh, MeshLambertMaterial,
  Path, Shape, Vector2,
} from "three";
import type { Barrier, BarrierOpening, Building, Point } from "../protocol/messages";
import type { Daylight } from "./natural/daylight";
import { lit } from "./natural/lit";
import type { Relief } from "./relief";

export const plainHouse = "#f4f1ea";
const edge = new LineBasicMaterial({ color: 0x3a3f45, transparent: true, opacity: 0.55 });

function solid(geometry: BufferGeometry, colour: string, id: string, daylight: Daylight | null, opacity = 1): Group {
  const group = new Group();
  const material = new MeshLambertMaterial({ color: colour, transparent: opacity < 1, opacity, depthWrite: opacity === 1 });
  const mesh = new Mesh(geometry, daylight ? lit(material, daylight.uniforms) : material);
  mesh.castShadow = opacity === 1;
  mesh.receiveShadow = true;
  group.add(mesh, new LineSegments(new EdgesGeometry(geometry, 25), edge));
  group.userData["id"] = id;
  return group;
}

export function houseSolid(building: Building & { base_m: number; roof_m: number }, relief: Relief, colour: string): Group {
  const [ox, oy, oz] = relief.origin;
  const shapes = building.polygons.map((polygon) => {
    const [outer = [], ...holes] = polygon.map((ring) => ring.map(([x, y]) => new Vector2(x - ox, y - oy)));
    const shape = new Shape(outer);
    shape.holes = holes.map((ring) => new Path(ring));
    return shape;
  });
  // Walls extend slightly into the ground, so that no gap is visible on a slope.
  const base = Math.min(building.base_m, ...building.polygons.flatMap((polygon) => polygon[0] ?? []).map(([x, y]) => relief.at(x, y))) - 0.5;
  const geometry = new ExtrudeGeometry(shapes, { depth: building.roof_m - base, bevelEnabled: false });
  geometry.translate(0, 0, base - oz);
  return solid(geometry, colour, building.id, null);
}

/** Left and right edge of a band along a line, joined at the corners. */
export function band(line: readonly Point[], thickness: number): [Point[], Point[]] {
  const left: Point[] = [];
  const right: Point[] = [];
  line.forEach(([x, y], k) => {
    const before = line[Math.max(0, k - 1)];
    const after = line[Math.min(line.length - 1, k + 1)];
    const along = (a: Point, b: Point): Point => {
      const length = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
      return [(b[0] - a[0]) / length, (b[1] - a[1]) / length];
    };
    const u = k === 0 ? along([x, y], after) : along(before, [x, y]);
    const v = k === line.length - 1 ? u : along([x, y], after);
    const nx = -(u[1] + v[1]);
    const ny = u[0] + v[0];
    const length = Math.hypot(nx, ny) || 1;
    const half = thickness / 2 / Math.max(0.35, length / 2);
    left.push([x + (nx / length) * half, y + (ny / length) * half]);
    right.push([x - (nx / length) * half, y - (ny / length) * half]);
  });
  return [left, right];
}

/** The places of a line, no farther apart than `step`, with the ends of openings; each with its distance along the line. */
function stations(line: Point[], openings: readonly BarrierOpening[], step: number): { at: Point; along: number }[] {
  const all: { at: Point; along: number }[] = [];
  let along = 0;
  line.forEach((p, k) => {
    if (k > 0) {
      const q = line[k - 1];
      const length = Math.hypot(p[0] - q[0], p[1] - q[1]);
      const shares: number[] = [];
      const parts = Math.max(1, Math.ceil(length / step));
      for (let s = 1; s < parts; ++s) shares.push(s / parts);
      for (const o of openings) for (const end of [o.position_m - o.width_m / 2, o.position_m + o.width_m / 2]) shares.push((end - along) / length);
      for (const s of shares.filter((share) => share > 0 && share < 1).sort((a, b) => a - b)) {
        all.push({ at: [q[0] + (p[0] - q[0]) * s, q[1] + (p[1] - q[1]) * s], along: along + s * length });
      }
      along += length;
    }
    all.push({ at: p, along });
  });
  return all;
}

type BarrierForm = Pick<Barrier, "id" | "line" | "height_m" | "thickness_m"> & Partial<Pick<Barrier, "crest_elevation_m" | "openings" | "passing_share" | "clearance_m">>;

/** Height of the crest at a distance along the line, over ground of height `z`; in an opening that of its sill. */
export function crestAt(barrier: Partial<Pick<Barrier, "crest_elevation_m" | "openings">> & Pick<Barrier, "height_m">, along_m: number, z: number): number {
  const crest = typeof barrier.crest_elevation_m === "number" ? barrier.crest_elevation_m : z + barrier.height_m;
  const opening = barrier.openings?.find((o) => Math.abs(along_m - o.position_m) < o.width_m / 2);
  return opening ? Math.min(crest, z + (opening.sill_height_m ?? 0)) : crest;
}

/**
 * A wall, or a translucent net, whose crest is `height_m` above the ground along its line, or level; openings are left
 * out down to their sills.
 */
export function barrierSolid(barrier: BarrierForm, relief: Relief, colour: string, daylight: Daylight): Group {
  const openings = barrier.openings ?? [];
  const places = stations(barrier.line, openings, Math.max(1, relief.grid.cell));
  const [left, right] = band(places.map((p) => p.at), Math.max(barrier.thickness_m, 0.3));
  const corner: number[] = [];
  const index: number[] = [];
  const face = (a: number, b: number, c: number, d: number): void => void index.push(a, b, c, a, c, d);
  for (let k = 0; k + 1 < places.length; ++k) {
    const middle = (places[k].along + places[k + 1].along) / 2;
    const opening = openings.find((o) => Math.abs(middle - o.position_m) < o.width_m / 2);
    if (opening && !(opening.sill_height_m > 0)) continue;
    // Corners of a cross-section: 0 left foot, 1 left crest, 2 right foot, 3 right crest.
    const a = corner.length / 3;
    const b = a + 4;
    for (const end of [k, k + 1]) {
      const [x, y] = places[end].at;
      const z = relief.at(x, y) - relief.origin[2];
      const top = crestAt(barrier, middle, z + relief.origin[2]) - relief.origin[2];
      for (const [px, py] of [left[end], right[end]]) {
        const foot = typeof barrier.clearance_m === "number" ? Math.min(z + barrier.clearance_m, top) : Math.min(z, relief.at(px, py) - relief.origin[2]) - 0.5;
        corner.push(px - relief.origin[0], py - relief.origin[1], foot, px - relief.origin[0], py - relief.origin[1], top);
      }
    }
    face(a, a + 1, b + 1, b);
    face(a + 1, a + 3, b + 3, b + 1);
    face(a + 3, a + 2, b + 2, b + 3);
    face(a, a + 2, a + 3, a + 1);
    face(b, b + 1, b + 3, b + 2);
  }
  const joined = new BufferGeometry();
  joined.setAttribute("position", new Float32BufferAttribute(corner, 3));
  joined.setIndex(index);
  const geometry = joined.toNonIndexed();
  geometry.computeVertexNormals();
  return solid(geometry, colour, barrier.id, daylight, typeof barrier.passing_share === "number" ? 0.4 : 1);
}

export function disposeSolid(group: Group): void {
  group.traverse((child) => {
    if (child instanceof Mesh || child instanceof LineSegments) (child.geometry as BufferGeometry).dispose();
    if (child instanceof Mesh) (child.material as MeshLambertMaterial).dispose();
  });
  group.removeFromParent();
}
