// Which trees stand between the eye and debris: their crowns are drawn thin, so that a forest does not hide the flow behind it.
import type { Place } from "../../protocol/messages";

/** In the local frame. foot, height: of a tree, m. */
export interface Standing { foot: Place; height: number }
/** Local height of the ground, and depth of debris, at a local place. */
export interface Behind { ground(x: number, y: number): number; depth(x: number, y: number): number }

/** Behind a tree, m. */
const farthest = 64;
const step = 4;
/** m; thinner debris hardly shows. */
const leastDepth = 0.1;
/** Of the height of a tree: below it is the stem. */
const crownBase = 0.25;

/** Whether debris behind a tree, seen from an eye, lies behind its crown. */
export function hidesDebris({ foot, height }: Standing, eye: Place, behind: Behind): boolean {
  const [dx, dy] = [foot[0] - eye[0], foot[1] - eye[1]];
  const away = Math.hypot(dx, dy);
  if (away < 1) return false;
  for (let s = step; s <= farthest; s += step) {
    const x = foot[0] + (dx / away) * s;
    const y = foot[1] + (dy / away) * s;
    if (behind.depth(x, y) < leastDepth) continue;
    const z = behind.ground(x, y);
    const passing = z + ((eye[2] - z) * s) / (away + s) - foot[2];
    if (passing < height && passing > crownBase * height) return true;
  }
  return false;
}
