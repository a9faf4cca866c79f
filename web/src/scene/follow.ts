// Where the camera is to be: at first a view of what is released and the valley below, then the front on its way down, until
// somebody moves the camera. It keeps one direction and glides: turning, zooming and jerks make people ill.
import type { ScenarioName } from "../protocol/frame";
import type { Place } from "../protocol/messages";
import { watchAll } from "../state/cell";
import type { Twin } from "../state/twin";
import type { Relief } from "./relief";
import type { Viewpoint } from "./rig";
import { placeOnPath } from "./scenario_view";
import type { Stage } from "./stage";

/** Above the horizon, of the first view and of the front. */
const tilt = { opening: 0.62, front: 0.68, steepest: 1.25 };
/** Debris is some twenty times as long on its way as a cube of its volume is wide: with some ground around it is in view. */
const bodyLengths = 24;
/** The nearest view of a front, and of a volume that is not known, m. */
const distance_m = { least: 80, unknown: 200 };
/** Of depths from which on a cell has debris in it, m. */
const debris_m = 0.05;

export class Follow {
  private heading: number;
  private begun = false;
  private placed = false;

  constructor(private readonly twin: Twin, private readonly stage: Stage) {
    this.heading = stage.rig.downhill + 0.15;
    // Who wants no motion presses a button for it.
    if (!stage.rig.still) stage.rig.setMode("follow");
    stage.onSize(() => this.refresh());
    stage.rig.watchMode((mode) => {
      if (mode === "follow") queueMicrotask(() => this.refresh());
    });
    watchAll([twin.edited, twin.replay_s, ...twin.every("state"), ...twin.every("setup"), twin.shown], () => this.refresh());
    // The ground stays where it is under somebody's hands.
    watchAll([twin.tool, twin.selection], () => {
      if (twin.tool.value.kind !== "none" || twin.selection.value !== null) stage.rig.touch();
    });
  }

  /** Local place of the front of a scenario at the time on display; null: nothing has moved yet. */
  front(name: ScenarioName = this.twin.edited.value): Place | null {
    const { twin, stage } = this;
    const state = twin.shownState(name);
    if (!state || state.time_s <= 0) return null;
    const at = state.front_chainage_m === null ? null : placeOnPath(twin.scene, state.front_chainage_m);
    return at ? stage.relief.local(...at.at) : this.lowestDebris(name);
  }
  /** Without a flow path: the lowest ground under debris. */
  private lowestDebris(name: ScenarioName): Place | null {
    const frame = this.stage.views.get(name)?.clock.next;
    if (!frame) return null;
    const { relief, twin } = this;
    const { map } = twin.scene;
    const { column, row, columns } = frame.window;
    const least = debris_m / frame.depthUnit_m;
    let lowest: [number, number] | null = null;
    let z = Infinity;
    for (let k = 0; k < frame.depth.length; ++k) {
      if (frame.depth[k] < least) continue;
      const x = map.x_min_m + (column + (k % columns) + 0.5) * map.cell_m;
      const y = map.y_min_m + (row + Math.floor(k / columns) + 0.5) * map.cell_m;
      const here = relief.at(x, y);
      if (here < z) [z, lowest] = [here, [x, y]];
    }
    return lowest && relief.local(...lowest);
  }
  private get relief(): Relief {
    return this.stage.relief;
  }

  /** Looks again where the camera is to be. */
  refresh(): void {
    const { rig } = this.stage;
    if (this.stage.filming) return;
    const front = this.front();
    const follows = rig.mode === "follow";
    const view = front === null || !follows ? this.opening() : this.towards(front);
    // What is known of the scene comes bit by bit; who comes later sees the front at once.
    if (rig.untouched && (!this.placed || (front === null && !this.begun))) {
      rig.put(view);
      this.placed = this.twin.now.setup.value !== null && this.twin.now.state.value !== null;
    }
    this.begun ||= front !== null;
    rig.aim(view);
  }

  /** Corners of what is released and where debris comes in. */
  private sources(): Place[] {
    const setup = this.twin.now.setup.value;
    const corners = [...(setup?.releases ?? []).flatMap(({ polygons }) => polygons.flat(2)),
      ...(setup?.inflows ?? []).flatMap(({ line, polygons }) => [...(line ?? []), ...polygons.flat(2)])];
    return corners.map(([x, y]) => this.relief.local(x, y));
  }
  private opening(): Viewpoint {
    const path = this.twin.scene.flow_path?.points ?? [];
    const places = [...this.sources(), ...path.map(([x, y]) => this.relief.local(x, y))];
    if (path.length === 0) {
      const { west, south } = this.relief.grid;
      for (const [u, v] of [[0, 0], [1, 0], [1, 1], [0, 1]]) places.push(this.relief.local(west + u * this.relief.width, south + v * this.relief.height));
    }
    return this.stage.rig.frame(places, this.heading, tilt.opening);
  }
  /** From the valley's side; nearer than the first view, once debris has left its source. */
  private towards(front: Place): Viewpoint {
    const opening = this.opening();
    const farthest = Math.hypot(...opening.position.map((v, k) => v - opening.target[k]));
    const volume = (this.twin.now.setup.value?.releases ?? []).reduce((sum, release) => sum + (release.volume_m3 ?? 0), 0);
    const upright = 1 / Math.min(1, Math.max(0.62, this.stage.rig.aspect));
    const distance = Math.min(farthest, Math.max(distance_m.least, volume > 0 ? bodyLengths * Math.cbrt(volume) * upright : distance_m.unknown));
    const left = Math.min(...this.sources().map((p) => Math.hypot(p[0] - front[0], p[1] - front[1])), Infinity);
    const t = Math.min(1, left / (0.3 * distance));
    const share = t * t * (3 - 2 * t);
    const near = this.seen(front, distance);
    const between = (a: Place, b: Place): Place => [0, 1, 2].map((k) => a[k] + share * (b[k] - a[k])) as Place;
    return { position: between(opening.position, near.position), target: between(opening.target, near.target) };
  }
  /** A place from a distance, as steeply from above as hills before it demand. */
  private seen(target: Place, distance: number): Viewpoint {
    for (let up = tilt.front; ; up += 0.08) {
      const level = distance * Math.cos(up);
      const position: Place = [target[0] + level * Math.cos(this.heading), target[1] + level * Math.sin(this.heading), target[2] + distance * Math.sin(up)];
      if (up >= tilt.steepest || this.clear(position, target)) return { position, target };
    }
  }
  private clear(from: Place, to: Place): boolean {
    const [ox, oy, oz] = this.relief.origin;
    const steps = 40;
    for (let k = 0; k < steps - 1; ++k) {
      const t = k / steps;
      const [x, y, z] = [0, 1, 2].map((axis) => from[axis] + t * (to[axis] - from[axis]));
      if (z + oz < this.relief.at(x + ox, y + oy) + 3 * (1 - t)) return false;
    }
    return true;
  }
}
