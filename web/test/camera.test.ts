import { PerspectiveCamera, Vector3 } from "three";
import { describe, expect, it } from "vitest";
import type { Place } from "../src/protocol/messages";
import { frameOf } from "../src/scene/framing";
import { glide } from "../src/scene/glide";

const fov = 38;
const tall = Math.tan((fov * Math.PI) / 360);
/** Where places are in a view, -1 to 1. */
function seen(places: Place[], aspect: number, covered = 0): { x: number[]; y: number[] } {
  const { position, target } = frameOf(places, -1.9, 0.62, { tall, wide: tall * aspect, covered });
  const camera = new PerspectiveCamera(fov, aspect, 0.5, 1e5);
  camera.up.set(0, 0, 1);
  camera.position.set(...position);
  camera.lookAt(...target);
  camera.updateMatrixWorld();
  const points = places.map((place) => new Vector3(...place).project(camera));
  return { x: points.map((p) => p.x), y: points.map((p) => p.y) };
}

describe("the first view", () => {
  const slope: Place[] = [[150, 190, 120], [160, 170, 118], [80, 120, 80], [20, 40, 40], [-10, -60, 10], [-40, -150, 0]];

  it.each([[16 / 10, 0], [0.46, 0], [1.6, 0.2]])("has the release and the whole valley in it, and fills it: aspect %f, %f of it covered", (aspect, covered) => {
    const { x, y } = seen(slope, aspect, covered);
    expect(Math.max(...x.map(Math.abs))).toBeLessThan(0.9);
    expect(Math.min(...y)).toBeGreaterThan(-0.9);
    expect(Math.max(...y)).toBeLessThan(0.9 - 2 * covered);
    const filled = Math.max((Math.max(...x) - Math.min(...x)) / 1.72, (Math.max(...y) - Math.min(...y)) / (1.72 - 2 * covered));
    expect(filled).toBeGreaterThan(0.93);
  });
  it("is no nearer than a house needs, also of a single place", () => {
    const { position, target } = frameOf([[3, 4, 5]], 0, 0.6, { tall, wide: tall, covered: 0 });
    expect(Math.hypot(...position.map((v, k) => v - target[k]))).toBeCloseTo(60, 3);
    expect(position.every(Number.isFinite)).toBe(true);
  });
});

describe("a camera that follows", () => {
  const run = (steps: number[], to: (time_s: number) => Place): { places: number[]; speeds: number[]; moving: boolean } => {
    const [at, speed] = [new Vector3(), new Vector3()];
    const [places, speeds] = [[] as number[], [] as number[]];
    let [moving, time] = [true, 0];
    for (const step of steps) {
      time += step;
      moving = glide(at, to(time), speed, step);
      places.push(at.x);
      speeds.push(speed.x);
    }
    return { places, speeds, moving };
  };
  const sixtieths = (seconds: number): number[] => Array.from({ length: 60 * seconds }, () => 1 / 60);

  it("comes to its place without overshooting, and is at rest there", () => {
    const { places, moving } = run(sixtieths(12), () => [100, 0, 0]);
    expect(Math.max(...places)).toBeLessThanOrEqual(100);
    expect(places.at(-1)).toBeCloseTo(100, 1);
    expect(moving).toBe(false);
  });
  it("is where it would be at any rate of pictures", () => {
    const often = run(sixtieths(2), () => [100, 0, 0]).places.at(-1);
    expect(run([0.5, 1, 0.5], () => [100, 0, 0]).places.at(-1)).toBeCloseTo(often ?? NaN, 6);
  });
  it("never jerks: from rest, behind a front that is told five times a second and stops at once", () => {
    const { speeds } = run(sixtieths(20), (t) => [Math.min(100, 10 * Math.floor(5 * t) / 5), 0, 0]);
    const jumps = speeds.map((v, k) => Math.abs(v - (speeds[k - 1] ?? 0)));
    expect(Math.max(...jumps)).toBeLessThan(0.3); // m/s from one picture to the next
    expect(Math.max(...speeds)).toBeLessThan(11.5);
  });
});
