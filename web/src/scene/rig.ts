// The camera: orbit by mouse, touch and keys; fly; follow the front; the plan, which has one scale everywhere; saved views. z is up.
import { MOUSE, OrthographicCamera, PerspectiveCamera, Spherical, TOUCH, Vector3 } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import type { Place } from "../protocol/messages";
import { frameOf } from "./framing";
import { glide } from "./glide";
import type { Relief } from "./relief";

export type CameraMode = "orbit" | "fly" | "follow" | "plan";
/** plan_m: of a plan, from its lower to its upper edge. */
export interface Viewpoint { position: Place; target: Place; plan_m?: number }

/** Of a view of a house, above the horizon. */
const visitTilt = (35 * Math.PI) / 180;

/** Less is a click of a hand that is not quite still, px. */
const dragged_px = 5;
const flyKeys = new Set(["KeyW", "KeyA", "KeyS", "KeyD", "KeyQ", "KeyE"]);

export class Rig {
  readonly controls: OrbitControls;
  mode: CameraMode = "orbit";
  /** Share of the view's height, from its top, that bars cover. */
  covered = 0;
  /** Nobody has moved it yet. */
  untouched = true;
  /** Where motion on screens makes people ill, the camera moves in cuts, and never by itself. */
  readonly still = matchMedia("(prefers-reduced-motion: reduce)").matches;
  private readonly perspective = new PerspectiveCamera(38, 1, 0.5, 20000);
  /** Its zoom is 1 / (metres from the lower to the upper edge). */
  private readonly flat = new OrthographicCamera(-0.5, 0.5, 0.5, -0.5);
  private readonly held = new Set<string>();
  private flight: { from: Viewpoint; to: Viewpoint; begun_ms: number; lasts_ms: number } | null = null;
  /** Where it is to be while it follows, and how fast its place and its target move, m/s. */
  private wanted: Viewpoint | null = null;
  private readonly drift = { position: new Vector3(), target: new Vector3() };
  private readonly modeReaders: ((mode: CameraMode) => void)[] = [];
  /** What the perspective looked at before the plan. */
  private readonly before = new Vector3();
  private last_ms = 0;
  private readonly changed: () => void;

  constructor(canvas: HTMLElement, private readonly relief: Relief, changed: () => void) {
    this.changed = () => {
      // Clicks and keys need screen positions before the next picture is drawn, which may take long.
      this.camera.updateMatrixWorld();
      changed();
    };
    for (const camera of [this.perspective, this.flat]) camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.perspective, canvas);
    this.controls.enableDamping = !this.still;
    this.controls.dampingFactor = 0.14;
    this.controls.zoomToCursor = true;
    this.controls.maxPolarAngle = 0.49 * Math.PI;
    this.controls.minDistance = 4;
    this.controls.maxDistance = 6 * Math.max(relief.width, relief.height);
    this.controls.minZoom = 1 / this.controls.maxDistance;
    this.controls.maxZoom = 0.25;
    this.controls.mouseButtons = { LEFT: MOUSE.ROTATE, MIDDLE: MOUSE.DOLLY, RIGHT: MOUSE.PAN };
    this.controls.addEventListener("change", this.changed);
    this.controls.addEventListener("start", () => (this.flight = null));
    canvas.addEventListener("keydown", (event) => this.key(event));
    canvas.addEventListener("keyup", (event) => void this.held.delete(event.code));
    canvas.addEventListener("blur", () => this.held.clear());
    canvas.addEventListener("wheel", () => this.touch(), { passive: true });
    // A click on a house is no movement; a drag is.
    let pressed: PointerEvent | null = null;
    canvas.addEventListener("pointerdown", (event) => (pressed = event));
    canvas.addEventListener("pointermove", (event) => {
      if (pressed && event.buttons > 0 && Math.hypot(event.clientX - pressed.clientX, event.clientY - pressed.clientY) > dragged_px) this.touch();
    });
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => (pressed = null));
    const reach = 2.2 * (relief.width + relief.height);
    this.perspective.far = this.flat.far = 12 * reach;
    this.flat.near = -this.flat.far;
    this.fit(false);
  }

  get camera(): PerspectiveCamera | OrthographicCamera {
    return this.mode === "plan" ? this.flat : this.perspective;
  }
  get aspect(): number {
    return this.perspective.aspect;
  }
  set aspect(ratio: number) {
    this.perspective.aspect = ratio;
    this.flat.left = -ratio / 2;
    this.flat.right = ratio / 2;
    this.perspective.updateProjectionMatrix();
    this.flat.updateProjectionMatrix();
  }
  get viewpoint(): Viewpoint {
    return { position: this.camera.position.toArray(), target: this.controls.target.toArray(), ...(this.mode === "plan" ? { plan_m: this.visible_m } : {}) };
  }
  /** Metres from the lower to the upper edge of the view, at its middle. */
  get visible_m(): number {
    return this.mode === "plan" ? 1 / this.flat.zoom : 2 * this.perspective.position.distanceTo(this.controls.target) * this.halfTangent;
  }
  /** Share of the view's height that a metre takes; in a perspective one at a distance of 1 m. */
  get magnification(): number {
    return this.mode === "plan" ? this.flat.zoom : 1 / (2 * this.halfTangent);
  }
  /** Distance from which a perspective shows as much. */
  distanceTo(at: Vector3): number {
    return this.mode === "plan" ? this.visible_m / (2 * this.halfTangent) : this.perspective.position.distanceTo(at);
  }
  /** How far north is turned from the upper edge, in radians. */
  get turn(): number {
    const away = this.camera.position.clone().sub(this.controls.target);
    return Math.atan2(away.x, -away.y);
  }
  /** The line of sight through a place of the view, -1 to 1 to the right and upwards. */
  sight(x: number, y: number): { from: Place; direction: Place } {
    const { camera } = this;
    if (this.mode === "plan") return { from: new Vector3(x, y, 0).unproject(camera).toArray(), direction: [0, 0, -1] };
    return { from: camera.position.toArray(), direction: new Vector3(x, y, 0.5).unproject(camera).sub(camera.position).normalize().toArray() };
  }
  private get halfTangent(): number {
    return Math.tan((this.perspective.fov * Math.PI) / 360);
  }
  /** Calls `reader` now and whenever the mode changes, also by itself, as by a saved view. */
  watchMode(reader: (mode: CameraMode) => void): void {
    this.modeReaders.push(reader);
    reader(this.mode);
  }
  /** Somebody moves the camera, or works on what it shows: it follows no longer. */
  touch(): void {
    this.untouched = false;
    if (this.mode === "follow") this.setMode("orbit");
  }
  /** The whole ground in view, seen from its lower side. */
  fit(animated = true, towards = 0.15): void {
    const [x, y] = this.relief.middle;
    const target = new Vector3(...this.relief.local(x, y));
    const size = Math.hypot(this.relief.width, this.relief.height);
    const distance = (0.40 * size) / this.halfTangent / Math.min(1.3, Math.max(0.6, this.perspective.aspect));
    const { down } = this;
    const angle = Math.atan2(down[1], down[0]) + towards;
    const offset = new Vector3().setFromSpherical(new Spherical(distance, 1, 0));
    const position: Place = [
      target.x + Math.cos(angle) * Math.hypot(offset.x, offset.z),
      target.y + Math.sin(angle) * Math.hypot(offset.x, offset.z),
      target.z + offset.y,
    ];
    if (animated) this.go({ position, target: target.toArray() }, true);
    else this.put({ position, target: target.toArray() });
  }
  /** Angle of the overall downhill direction, from east. */
  get downhill(): number {
    return Math.atan2(this.down[1], this.down[0]);
  }
  /** Overall downhill direction of the ground. */
  private get down(): [number, number] {
    const { relief } = this;
    const { west, south } = relief.grid;
    let [u, v] = [0, 0];
    for (let j = 0; j < 12; ++j) {
      for (let i = 0; i < 12; ++i) {
        const a = (i + 0.5) / 12 - 0.5;
        const b = (j + 0.5) / 12 - 0.5;
        const z = relief.at(west + (a + 0.5) * relief.width, south + (b + 0.5) * relief.height);
        u -= a * z;
        v -= b * z;
      }
    }
    return u === 0 && v === 0 ? [0, -1] : [u, v];
  }
  /** The whole ground as a plan, north up. */
  top(): void {
    const [x, y, z] = this.relief.local(...this.relief.middle);
    const { width, height } = this.relief;
    const visible = Math.max((1.04 * height) / (1 - this.covered), (1.08 * width) / this.perspective.aspect);
    this.plan([x, y + (this.covered / 2) * visible, z], visible);
  }
  private plan(target: Place, visible_m: number): void {
    this.setMode("plan");
    const height = this.relief.highest - this.relief.origin[2] + 100;
    // Looking straight down, "up" is undefined: a slight offset to the south keeps north at the top.
    this.flat.position.set(target[0], target[1] - 1e-5 * (height - target[2]), height);
    this.flat.zoom = 1 / visible_m;
    this.flat.updateProjectionMatrix();
    this.controls.target.set(...target);
    this.controls.update();
    this.changed();
  }
  /** Brings a local place near the centre, seen from `side`, a direction in the plan, or from the current direction. */
  visit(place: Place, distance: number, side: readonly [number, number] | null = null): void {
    if (this.mode === "plan") return this.plan(place, 2 * distance * this.halfTangent);
    const away = side === null ? this.camera.position.clone().sub(this.controls.target) : new Vector3(side[0], side[1], Math.tan(visitTilt));
    away.setLength(distance);
    const position: Place = [place[0] + away.x, place[1] + away.y, place[2] + away.z];
    const [ox, oy, oz] = this.relief.origin;
    // A slope behind the camera does not hide the view.
    position[2] = Math.max(position[2], this.relief.at(position[0] + ox, position[1] + oy) - oz + 0.2 * distance);
    this.go({ position, target: place }, true);
  }
  go(to: Viewpoint, animated: boolean): void {
    this.untouched = false;
    if (to.plan_m !== undefined) return this.plan(to.target, to.plan_m);
    if (this.mode === "plan" || this.mode === "follow") this.setMode("orbit");
    if (!animated || this.still) return this.put(to);
    this.flight = { from: this.viewpoint, to, begun_ms: performance.now(), lasts_ms: 700 };
    this.changed();
  }
  /** There at once. */
  put(to: Viewpoint): void {
    this.flight = null;
    this.drift.position.set(0, 0, 0);
    this.drift.target.set(0, 0, 0);
    this.perspective.position.set(...to.position);
    this.controls.target.set(...to.target);
    this.controls.update();
    this.changed();
  }
  setMode(mode: CameraMode): void {
    if (this.mode === "fly") this.setPivot(false);
    if ((mode === "plan") !== (this.mode === "plan")) this.flatten(mode === "plan");
    this.mode = mode;
    if (mode !== "follow") this.untouched = false;
    if (mode === "fly") this.setPivot(true);
    this.wanted = null;
    this.drift.position.set(0, 0, 0);
    this.drift.target.set(0, 0, 0);
    for (const reader of this.modeReaders) reader(mode);
    this.held.clear();
    this.changed();
  }
  /** A plan is moved by a drag; what follows it shows the same place from the direction before. */
  private flatten(on: boolean): void {
    const { controls, perspective, relief } = this;
    this.flight = null;
    if (!on) {
      const away = perspective.position.clone().sub(this.before);
      const distance = this.distanceTo(perspective.position);
      controls.target.set(...relief.local(controls.target.x + relief.origin[0], controls.target.y + relief.origin[1]));
      perspective.position.copy(controls.target).add(away.setLength(distance));
    } else this.before.copy(controls.target);
    controls.object = on ? this.flat : perspective;
    controls.enableRotate = !on;
    controls.mouseButtons.LEFT = on ? MOUSE.PAN : MOUSE.ROTATE;
    controls.touches.ONE = on ? TOUCH.PAN : TOUCH.ROTATE;
  }
  /** While flying, a drag turns the camera on the spot: the pivot is close ahead. Otherwise it is on the ground. */
  private setPivot(close: boolean): void {
    const { camera, controls, relief } = this;
    const ahead = controls.target.clone().sub(camera.position).normalize();
    const met = relief.meet(camera.position.toArray(), ahead.toArray());
    const distance = met ? camera.position.distanceTo(new Vector3(met[0] - relief.origin[0], met[1] - relief.origin[1], met[2] - relief.origin[2])) : 200;
    controls.minDistance = close ? 0.5 : 4;
    controls.target.copy(camera.position).addScaledVector(ahead, close ? 1 : Math.max(5, distance));
  }
  /** Where it is to be while it follows. It glides there; in cuts where motion is unwanted, once what it looks at nears the edge of the view. */
  aim(to: Viewpoint): void {
    if (this.mode !== "follow") return;
    this.wanted = to;
    if (this.still && this.controls.target.distanceTo(new Vector3(...to.target)) > 0.3 * this.visible_m) this.put(to);
    this.changed();
  }
  /** The nearest view from a direction that has all places in it, below what covers its upper edge. */
  frame(places: readonly Place[], heading: number, tilt: number): Viewpoint {
    return frameOf(places, heading, tilt, { tall: this.halfTangent, wide: this.halfTangent * this.perspective.aspect, covered: this.covered });
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (this.mode === "fly" && flyKeys.has(event.code)) {
      this.held.add(event.code);
      event.preventDefault();
      this.changed();
      return;
    }
    const away = this.camera.position.clone().sub(this.controls.target);
    const angle = 0.09;
    if (event.key.startsWith("Arrow") && (event.shiftKey || this.mode === "plan")) {
      const step = 0.09 * this.visible_m;
      const ahead = this.mode === "plan" ? new Vector3(0, 1, 0) : new Vector3(-away.x, -away.y, 0).normalize();
      const side = new Vector3(ahead.y, -ahead.x, 0);
      const sign = event.key === "ArrowUp" || event.key === "ArrowRight" ? 1 : -1;
      const move = (event.key === "ArrowUp" || event.key === "ArrowDown" ? ahead : side).multiplyScalar(sign * step);
      this.camera.position.add(move);
      this.controls.target.add(move);
    } else if (event.key === "ArrowLeft" || event.key === "ArrowRight") {
      away.applyAxisAngle(this.camera.up, event.key === "ArrowLeft" ? -angle : angle);
      this.camera.position.copy(this.controls.target).add(away);
    } else if (event.key === "ArrowUp" || event.key === "ArrowDown") {
      const level = Math.hypot(away.x, away.y);
      const tilt = Math.min(1.55, Math.max(0.05, Math.atan2(away.z, level) + (event.key === "ArrowUp" ? angle : -angle)));
      const length = away.length();
      const turn = Math.atan2(away.y, away.x);
      away.set(Math.cos(turn) * Math.cos(tilt), Math.sin(turn) * Math.cos(tilt), Math.sin(tilt)).multiplyScalar(length);
      this.camera.position.copy(this.controls.target).add(away);
    } else if (event.key === "+" || event.key === "=" || event.key === "-") {
      const by = event.key === "-" ? 1.12 : 1 / 1.12;
      this.camera.position.copy(this.controls.target).add(this.mode === "plan" ? away : away.multiplyScalar(by));
      if (this.mode === "plan") this.flat.zoom /= by;
      this.flat.updateProjectionMatrix();
    } else return;
    event.preventDefault();
    this.flight = null;
    this.touch();
    this.controls.update();
    this.changed();
  }

  /** Moves the camera to `now`; true while it is still moving. */
  update(now_ms: number): boolean {
    const passed = (now_ms - this.last_ms) / 1000;
    // One who flies on a slow computer must not shoot past; what glides is where it is due.
    const seconds = Math.min(0.1, passed);
    this.last_ms = now_ms;
    let busy = false;
    if (this.flight) {
      const { from, to, begun_ms, lasts_ms } = this.flight;
      const t = Math.min(1, (now_ms - begun_ms) / lasts_ms);
      const eased = t * t * (3 - 2 * t);
      this.camera.position.set(...from.position).lerp(new Vector3(...to.position), eased);
      this.controls.target.set(...from.target).lerp(new Vector3(...to.target), eased);
      if (t >= 1) this.flight = null;
      busy = true;
    } else if (this.wanted && !this.still) busy = this.glide(this.wanted, Math.min(1, passed));
    if (this.held.size > 0) {
      this.fly(seconds);
      busy = true;
    }
    // True while damping still moves the camera.
    return this.controls.update() || busy;
  }
  /** Both ends of the line of sight are drawn to their places as by damped springs: no jerk when the front changes its pace. False once there. */
  private glide(to: Viewpoint, seconds: number): boolean {
    const moving = glide(this.perspective.position, to.position, this.drift.position, seconds);
    return glide(this.controls.target, to.target, this.drift.target, seconds) || moving;
  }
  private fly(seconds: number): void {
    const ahead = this.controls.target.clone().sub(this.camera.position);
    const [ox, oy, oz] = this.relief.origin;
    const { x, y, z } = this.camera.position;
    // Faster high above the ground, slower among houses.
    const speed = Math.max(8, 0.7 * (z + oz - this.relief.at(x + ox, y + oy))) * seconds;
    ahead.normalize();
    const side = new Vector3().crossVectors(ahead, this.camera.up).normalize();
    const move = new Vector3();
    if (this.held.has("KeyW")) move.add(ahead);
    if (this.held.has("KeyS")) move.sub(ahead);
    if (this.held.has("KeyD")) move.add(side);
    if (this.held.has("KeyA")) move.sub(side);
    if (this.held.has("KeyE")) move.add(this.camera.up);
    if (this.held.has("KeyQ")) move.sub(this.camera.up);
    move.setLength(speed);
    this.camera.position.add(move);
    this.controls.target.add(move);
    const floor = this.relief.at(this.camera.position.x + ox, this.camera.position.y + oy) - oz + 1.7;
    if (this.camera.position.z < floor) this.camera.position.z = floor;
  }
}
