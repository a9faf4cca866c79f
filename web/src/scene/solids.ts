// Houses and barriers as solids with shadows.
import {
  BufferGeometry, EdgesGeometry, ExtrudeGeometry, Float32BufferAttribute, Group, LineBasicMaterial, LineSegments, Mesh, MeshLambertMaterial,
  Path, Shape, Vector2,
} from "three";
import type { Barrier, Building, Point } from "../protocol/messages";
import type { Relief } from "./relief";

export const plainHouse = "#f4f1ea";
const edge = new LineBasicMaterial({ color: 0x3a3f45, transparent: true, opacity: 0.55 });

function solid(geometry: BufferGeometry, colour: string, id: string): Group {
  const group = new Group();
  const mesh = new Mesh(geometry, new MeshLambertMaterial({ color: colour }));
  mesh.castShadow = true;
  mesh.receiveShadow = true;
  group.add(mesh, new LineSegments(new EdgesGeometry(geometry, 25), edge));
  group.userData["id"] = id;
  return group;
}

export function houseSolid(building: Building, relief: Relief, colour: string): Group {
  const [ox, oy, oz] = relief.origin;
  const shapes = building.footprint.map((polygon) => {
    const [outer = [], ...holes] = polygon.map((ring) => ring.map(([x, y]) => new Vector2(x - ox, y - oy)));
    const shape = new Shape(outer);
    shape.holes = holes.map((ring) => new Path(ring));
    return shape;
  });
  // Walls go a little into the ground, so that no gap shows on a slope.
  const base = Math.min(building.base_m, ...building.footprint.flatMap((polygon) => polygon[0] ?? []).map(([x, y]) => relief.at(x, y))) - 0.5;
  const geometry = new ExtrudeGeometry(shapes, { depth: building.roof_m - base, bevelEnabled: false });
  geometry.translate(0, 0, base - oz);
  return solid(geometry, colour, building.id);
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

/** A wall whose crest is `height_m` above the ground along its line. */
export function barrierSolid(barrier: Pick<Barrier, "id" | "line" | "height_m" | "thickness_m">, relief: Relief, colour: string): Group {
  const line: Point[] = [];
  barrier.line.forEach((p, k) => {
    if (k > 0) {
      const q = barrier.line[k - 1];
      const parts = Math.max(1, Math.ceil(Math.hypot(p[0] - q[0], p[1] - q[1]) / Math.max(1, relief.grid.cell)));
      for (let s = 1; s < parts; ++s) line.push([q[0] + ((p[0] - q[0]) * s) / parts, q[1] + ((p[1] - q[1]) * s) / parts]);
    }
    line.push(p);
  });
  const [left, right] = band(line, Math.max(barrier.thickness_m, 0.3));
  const corner: number[] = [];
  line.forEach(([x, y], k) => {
    const z = relief.at(x, y) - relief.origin[2];
    for (const [px, py] of [left[k], right[k]]) {
      const foot = Math.min(z, relief.at(px, py) - relief.origin[2]) - 0.5;
      corner.push(px - relief.origin[0], py - relief.origin[1], foot, px - relief.origin[0], py - relief.origin[1], z + barrier.height_m);
    }
  });
  // Corners of a cross-section: 0 left foot, 1 left crest, 2 right foot, 3 right crest.
  const index: number[] = [];
  const face = (a: number, b: number, c: number, d: number): void => void index.push(a, b, c, a, c, d);
  for (let k = 0; k + 1 < line.length; ++k) {
    const a = 4 * k;
    const b = a + 4;
    face(a, a + 1, b + 1, b);
    face(a + 1, a + 3, b + 3, b + 1);
    face(a + 3, a + 2, b + 2, b + 3);
  }
  const end = 4 * (line.length - 1);
  face(0, 2, 3, 1);
  face(end, end + 1, end + 3, end + 2);
  const joined = new BufferGeometry();
  joined.setAttribute("position", new Float32BufferAttribute(corner, 3));
  joined.setIndex(index);
  const geometry = joined.toNonIndexed();
  geometry.computeVertexNormals();
  return solid(geometry, colour, barrier.id);
}

export function disposeSolid(group: Group): void {
  group.traverse((child) => {
    if (child instanceof Mesh || child instanceof LineSegments) (child.geometry as BufferGeometry).dispose();
    if (child instanceof Mesh) (child.material as MeshLambertMaterial).dispose();
  });
  group.removeFromParent();
}
