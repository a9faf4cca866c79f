// The motion of a camera that follows.
import type { Vector3 } from "three";
import type { Place } from "../protocol/messages";

/** How hard it is drawn to its place, 1/s: it comes to rest in some four seconds. */
const pull_hz = 1.3;
/** Nearer and slower than this it is there, m and m/s. */
const rest = 0.02;

/**
 * Moves `at` towards `to` as a critically damped spring does, exactly for any duration: without overshooting, and without a jerk when its
 * goal changes pace. False once it is there.
 */
export function glide(at: Vector3, to: Place, speed: Vector3, seconds: number): boolean {
  const fade = Math.exp(-pull_hz * seconds);
  let moving = false;
  for (let axis = 0; axis < 3; ++axis) {
    const gap = at.getComponent(axis) - to[axis];
    const v = speed.getComponent(axis);
    if (Math.abs(gap) < rest && Math.abs(v) < rest) continue;
    moving = true;
    const both = v + pull_hz * gap;
    at.setComponent(axis, to[axis] + (gap + both * seconds) * fade);
    speed.setComponent(axis, (v - pull_hz * both * seconds) * fade);
  }
  return moving;
}
