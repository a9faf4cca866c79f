// The nearest view that has some places in it.
import { Vector3 } from "three";
import type { Place } from "../protocol/messages";
import type { Viewpoint } from "./rig";

/** No view is nearer, m. */
const nearest_m = 60;
/** What is left free along the edges, of half the view. */
const margin = 0.14;

/** tall, wide: half the view's height and width at a distance of 1; covered: share of its height, from its upper edge, that is not seen. */
export interface Lens { tall: number; wide: number; covered: number }

/** Seen from `heading` (from east, in the plan) and `tilt` (above the horizon), in radians. */
export function frameOf(places: readonly Place[], heading: number, tilt: number, { tall, wide, covered }: Lens): Viewpoint {
  const away = new Vector3(Math.cos(heading) * Math.cos(tilt), Math.sin(heading) * Math.cos(tilt), Math.sin(tilt));
  const right = new Vector3(-Math.sin(heading), Math.cos(heading), 0);
  const up = new Vector3().crossVectors(away, right);
  const points = places.map((place) => new Vector3(...place));
  const target = points.reduce((sum, p) => sum.add(p), new Vector3()).divideScalar(Math.max(1, points.length));
  const [lowest, highest, side] = [margin - 1, 1 - margin - 2 * covered, 1 - margin];
  let distance = 2 * Math.max(...points.map((p) => target.distanceTo(p)), nearest_m);
  const d = new Vector3();
  // What is nearer to the camera is larger: the extent in the picture depends on the distance, so that it is found step by step.
  for (let k = 0; k < 40; ++k) {
    let [left, far, low, high] = [Infinity, -Infinity, Infinity, -Infinity];
    for (const p of points) {
      d.copy(p).sub(target);
      const depth = Math.max(0.1 * distance, distance - d.dot(away));
      const [x, y] = [d.dot(right) / depth / wide, d.dot(up) / depth / tall];
      [left, far, low, high] = [Math.min(left, x), Math.max(far, x), Math.min(low, y), Math.max(high, y)];
    }
    if (!Number.isFinite(left)) break;
    target.addScaledVector(right, ((left + far) / 2) * wide * distance).addScaledVector(up, ((low + high) / 2 - (lowest + highest) / 2) * tall * distance);
    distance = Math.max(nearest_m, distance * Math.max((far - left) / (2 * side), (high - low) / (highest - lowest)));
  }
  return { position: target.clone().addScaledVector(away, distance).toArray(), target: target.toArray() };
}
