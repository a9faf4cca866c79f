// Lines and points of a layer, as graphics that lie on the ground: one object for all that look alike.
import { BufferGeometry, CanvasTexture, Color, Float32BufferAttribute, Group, Points, PointsMaterial } from "three";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
import { LineSegments2 } from "three/examples/jsm/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/examples/jsm/lines/LineSegmentsGeometry.js";
import type { OverlayData, Point, SceneInfo } from "../protocol/messages";
import { styleOf } from "../state/overlays";
import type { Relief } from "./relief";

/** Above the ground, m: between its cells the drawn ground is a little higher than the line. */
const above_m = 0.3;
/** Coordinates of draped lines of a layer, at most. */
const mostNumbers = 9_000_000;

let disc: CanvasTexture | null = null;
function discTexture(): CanvasTexture {
  if (disc) return disc;
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 64;
  const context = canvas.getContext("2d");
  if (context) {
    context.beginPath();
    context.arc(32, 32, 30, 0, 2 * Math.PI);
    context.fillStyle = "#fff";
    context.fill();
  }
  return (disc = new CanvasTexture(canvas));
}

interface Alike { colour: string; opacity: number; width_px: number; positions: number[] }
const into = (kinds: Map<string, Alike>, colour: string, opacity: number, width_px: number): number[] => {
  const key = `${colour} ${opacity} ${width_px}`;
  const kind = kinds.get(key) ?? { colour, opacity, width_px, positions: [] };
  kinds.set(key, kind);
  return kind.positions;
};

/** `opacity` multiplies that of each style. */
export function overlayMarks(data: OverlayData, colour: string, opacity: number, relief: Relief, scene: SceneInfo): Group {
  const [west, south, east, north] = scene.extent_m;
  const [width, height] = [east - west, north - south];
  const tiny = 1e-3 * Math.min(width, height);
  // What is cut at the edge of the terrain has no outline there.
  const onEdge = (ax: number, ay: number, bx: number, by: number): boolean =>
    (ax < tiny && bx < tiny) || (ay < tiny && by < tiny) || (ax > width - tiny && bx > width - tiny) || (ay > height - tiny && by > height - tiny);
  const lines = new Map<string, Alike>();
  const points = new Map<string, Alike>();
  let numbers = 0;
  const draw = (to: number[], line: readonly Point[]): void => {
    const draped = numbers < mostNumbers ? relief.drape(line, above_m) : line.flatMap(([x, y]) => relief.local(x, y, above_m));
    for (let k = 0; k + 5 < draped.length; k += 3) for (let c = 0; c < 6; ++c) to.push(draped[k + c]);
    numbers += 2 * draped.length;
  };
  for (const feature of data.features) {
    const style = styleOf(data, feature, colour);
    if (feature.kind === "point") {
      const fill = into(points, style.fill || style.stroke || colour, style.fill_opacity * opacity, style.size_px);
      const rim = into(points, style.stroke && style.fill ? style.stroke : "#ffffff", style.stroke_opacity * opacity, style.size_px + 4);
      for (const part of feature.parts) {
        const [x, y, z] = relief.local(west + part[0], south + part[1], 2 * above_m);
        fill.push(x, y, z + 0.05);
        rim.push(x, y, z);
      }
      continue;
    }
    if (!style.stroke) continue;
    const to = into(lines, style.stroke, style.stroke_opacity * opacity, style.width_px);
    for (const part of feature.parts) {
      const n = part.length / 2;
      const at = (k: number): Point => [west + part[2 * k], south + part[2 * k + 1]];
      let run: Point[] = [at(0)];
      for (let k = 1; k <= (feature.kind === "area" ? n : n - 1); ++k) {
        const [a, b] = [k - 1, k % n];
        if (feature.kind === "area" && onEdge(part[2 * a], part[2 * a + 1], part[2 * b], part[2 * b + 1])) {
          if (run.length > 1) draw(to, run);
          run = [at(b)];
        } else run.push(at(b));
      }
      if (run.length > 1) draw(to, run);
    }
  }
  const group = new Group();
  for (const kind of lines.values()) {
    const geometry = new LineSegmentsGeometry();
    geometry.setPositions(kind.positions);
    const line = new LineSegments2(geometry, new LineMaterial({ color: new Color(kind.colour).getHex(), linewidth: kind.width_px, transparent: true, opacity: kind.opacity,
      polygonOffset: true, polygonOffsetFactor: -4, polygonOffsetUnits: -24 }));
    line.renderOrder = 4;
    line.frustumCulled = false;
    group.add(line);
  }
  // Rims before what they surround.
  for (const [k, kind] of [...points.values()].sort((a, b) => b.width_px - a.width_px).entries()) {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new Float32BufferAttribute(kind.positions, 3));
    const marks = new Points(geometry, new PointsMaterial({ color: new Color(kind.colour).getHex(), size: kind.width_px, sizeAttenuation: false, map: discTexture(), transparent: true,
      opacity: kind.opacity, alphaTest: 0.3 * kind.opacity, depthWrite: false }));
    marks.renderOrder = 6 + 0.01 * k;
    marks.frustumCulled = false;
    group.add(marks);
  }
  return group;
}

export function disposeMarks(group: Group): void {
  for (const child of [...group.children] as (LineSegments2 | Points)[]) {
    child.geometry.dispose();
    (child.material as LineMaterial | PointsMaterial).dispose();
  }
  group.removeFromParent();
}
