// Lines of a fixed width in pixels that lie on the ground.
import { Color } from "three";
import { Line2 } from "three/examples/jsm/lines/Line2.js";
import { LineGeometry } from "three/examples/jsm/lines/LineGeometry.js";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";

export interface Look {
  colour: string;
  width_px: number;
  dashed?: boolean;
  opacity?: number;
  /** Drawn over everything instead of being hidden by ground and houses. */
  onTop?: boolean;
}

export function pixelLine(positions: number[], look: Look): Line2 {
  const geometry = new LineGeometry();
  geometry.setPositions(positions);
  const material = new LineMaterial({
    color: new Color(look.colour).getHex(),
    linewidth: look.width_px,
    dashed: look.dashed ?? false,
    dashSize: 2.5,
    gapSize: 2,
    transparent: true,
    opacity: look.opacity ?? 1,
    depthTest: !(look.onTop ?? false),
    polygonOffset: true,
    polygonOffsetFactor: -2,
    polygonOffsetUnits: -8,
  });
  const line = new Line2(geometry, material);
  if (look.dashed) line.computeLineDistances();
  line.renderOrder = look.onTop ? 20 : 5;
  line.frustumCulled = false;
  return line;
}

export function disposeLine(line: Line2): void {
  line.geometry.dispose();
  line.material.dispose();
  line.removeFromParent();
}
