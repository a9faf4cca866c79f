// A frame between two of a recording: each particle on the straight line from where it was to where it will be.
import { absent, type Frame } from "./frame";

const most = 65534;

/** `from` and `to` are not changed; both are of one scenario, `from` is not later. Depth and speed of the flow are those of the nearer one. */
export function between(from: Frame, to: Frame, time_s: number): Frame {
  const span = to.time_s - from.time_s;
  const share = span > 0 ? Math.min(1, Math.max(0, (time_s - from.time_s) / span)) : 0;
  if (share === 0 || from.stride !== to.stride) return from;
  const nearer = share < 0.5 ? from : to;
  const origin: [number, number, number] = [0, 0, 0];
  const scale: [number, number, number] = [1, 1, 1];
  for (let axis = 0; axis < 3; ++axis) {
    origin[axis] = Math.min(from.origin[axis], to.origin[axis]);
    const high = Math.max(from.origin[axis] + most * from.scale[axis], to.origin[axis] + most * to.scale[axis]);
    scale[axis] = Math.max(1e-6, (high - origin[axis]) / most);
  }
  const speedUnit_mps = Math.max(from.speedUnit_mps, to.speedUnit_mps);
  // One that enters between the two is there from the later one on; one that leaves stays until then.
  const particles = new Uint16Array(4 * from.count).fill(absent);
  for (let i = 0; i < 4 * from.count; i += 4) {
    if (from.particles[i] === absent) continue;
    const other = i < to.particles.length && to.particles[i] !== absent;
    for (let axis = 0; axis < 3; ++axis) {
      const here = from.origin[axis] + from.particles[i + axis] * from.scale[axis];
      const there = other ? to.origin[axis] + to.particles[i + axis] * to.scale[axis] : here;
      particles[i + axis] = Math.min(most, Math.round((here + share * (there - here) - origin[axis]) / scale[axis]));
    }
    const speed = from.particles[i + 3] * from.speedUnit_mps;
    const later = other ? to.particles[i + 3] * to.speedUnit_mps : speed;
    particles[i + 3] = Math.min(255, Math.round((speed + share * (later - speed)) / speedUnit_mps));
  }
  return { ...nearer, flags: from.flags, time_s, step: from.step, stride: from.stride, count: from.count, particles, origin, scale, speedUnit_mps };
}
