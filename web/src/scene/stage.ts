// The canvas: one renderer, a view per scenario side by side, one camera for all, pictures only when something changed.
import { Vector3, WebGLRenderer, type BufferGeometry } from "three";
import { lastDecode, type Frame, type ScenarioName } from "../protocol/frame";
import type { Grid } from "../protocol/grid";
import type { Place, SceneInfo } from "../protocol/messages";
import type { Twin } from "../state/twin";
import { h } from "../ui/dom";
import { Cell, watchAll } from "../state/cell";
import { ramps, speedScale_mps } from "./colour";
import { groundGeometry, rampTextureOf, type Draped } from "./ground";
import type { Box } from "./labels";
import { Daylight } from "./natural/daylight";
import { hillShade } from "./natural/hill_shade";
import type { Relief } from "./relief";
import { Resolution } from "./resolution";
import { Rig, type Viewpoint } from "./rig";
import { ScenarioView } from "./scenario_view";

/** Performance figures for tests and users: window.talusStats. */
export interface Stats {
  frames: number;
  /** Script time of the last display frame and of decoding the last message, ms. */
  script_ms: number;
  draw_ms: number;
  /** From a frame's arrival to its decoding, waiting for the unpacking included. */
  decode_ms: number;
  /** Script time within that. */
  unfold_ms: number;
  upload_ms: number;
  particles: number;
  /** Of the last picture. */
  drawCalls: number;
  trees: number;
  /** Of the natural look: 2 all, 1 and 0 less where graphics are slow. */
  detail: number;
  shownTime_s: number;
  /** Pixels of the canvas per pixel of the page: lower while slow graphics draw a moving picture. */
  pixelRatio: number;
  /** Greatest depth of erosion, by scenario, m. */
  sunk_m: Partial<Record<ScenarioName, number>>;
  /** Answers of the server asked for, and read. */
  reads: Readonly<{ begun: number; ended: number }>;
}
declare global {
  interface Window {
    talusStats: Stats;
  }
}

/** What is around the ground in a plan. */
const aroundPlan = 0xdfe7ea;

/** Where the scene has none, that of temperate hills. */
const latitudeOf = (scene: SceneInfo): number => scene.latitude_deg ?? 45;

export interface Hit { scenario: ScenarioName; world: Place; x: number; y: number }

export class Stage {
  readonly element = h("div", { class: "stage" });
  readonly canvas = h("canvas", { tabindex: "0", role: "application",
    "aria-label": "Three-dimensional view. Arrow keys turn, Shift with arrow keys moves, plus and minus zoom." });
  readonly rig: Rig;
  readonly views = new Map<ScenarioName, ScenarioView>();
  readonly stats: Stats;
  /** Speed at the upper end of the colours: the largest of the scenarios' runs so far, rounded up. */
  readonly fastest_mps = new Cell(speedScale_mps([]));
  /** Counts changes of the ground. */
  readonly sinkings = new Cell(0);
  /** Pictures are asked for one by one: none is drawn between. */
  filming = false;
  /** Elements that lie over the view; labels keep clear of them. */
  covers: readonly HTMLElement[] = [];
  private readonly renderer: WebGLRenderer;
  readonly daylight: Daylight;
  private hills: Draped | null = null;
  private readonly geometry: BufferGeometry;
  /** The views in their order. */
  private drawn: readonly ScenarioView[] = [];
  private readonly place = { left: 0, top: 0, wide: 1, high: 1 };
  private readonly panes = new Map<ScenarioName, HTMLElement>();
  private readonly speedRamp = rampTextureOf(ramps.speed);
  private readonly readers: (() => void)[] = [];
  private readonly cameraReaders: (() => void)[] = [];
  private readonly sizeReaders: (() => void)[] = [];
  private due = true;
  private cameraMoved = true;
  private readonly resolution = new Resolution();
  private width = 1;
  private height = 1;
  private swiped = false;

  constructor(readonly twin: Twin, readonly relief: Relief) {
    this.stats = { frames: 0, script_ms: 0, draw_ms: 0, decode_ms: 0, unfold_ms: 0, upload_ms: 0, particles: 0, drawCalls: 0, trees: 0, detail: 2, shownTime_s: 0, pixelRatio: 1, sunk_m: {},
      reads: twin.api.reads };
    this.renderer = new WebGLRenderer({ canvas: this.canvas, antialias: true, preserveDrawingBuffer: false, powerPreference: "high-performance" });
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.autoUpdate = false;
    this.renderer.autoClear = false;
    this.renderer.setClearColor(aroundPlan, 1);
    this.geometry = groundGeometry(relief);
    this.daylight = new Daylight(relief, latitudeOf(twin.scene));
    this.element.append(this.canvas);
    this.rig = new Rig(this.canvas, relief, () => {
      this.cameraMoved = true;
      this.invalidate();
    });
    window.talusStats = this.stats;
    // A new size clears the canvas, after this display frame's picture was drawn: without another one the view would be blank.
    new ResizeObserver(() => {
      this.resize();
      if (!this.filming) this.draw(performance.now());
    }).observe(this.element);
    watchAll(twin.every("state"), () => (this.fastest_mps.value = speedScale_mps(twin.every("state").map((cell) => cell.value))));
    twin.shown.watch((names) => this.arrange(names));
    twin.divider.watch(() => this.divide());
    watchAll([twin.look, twin.layer, twin.surface, twin.shown], () => this.shine());
    twin.moment.watch((moment) => {
      if (moment === this.daylight.moment) return;
      this.daylight.set(moment);
      this.hills?.texture.dispose();
      this.hills = null;
      this.shine();
    });
    twin.onFrame((frame) => this.push(frame));
    requestAnimationFrame(this.tick);
  }

  invalidate(): void {
    this.due = true;
  }
  /** The first picture is of that view. */
  beginAt(view: Viewpoint): void {
    this.rig.touch();
    this.rig.go(view, false);
  }
  /** Called after every picture. */
  onPicture(reader: () => void): void {
    this.readers.push(reader);
  }
  onSize(reader: () => void): void {
    this.sizeReaders.push(reader);
  }
  onCamera(reader: () => void): void {
    this.cameraReaders.push(reader);
  }
  /** Of the picture of a scenario: two that are shown may be at different times. */
  timeOf(name: ScenarioName): number | null {
    return this.views.get(name)?.clock.time_s(performance.now()) ?? null;
  }
  pane(name: ScenarioName): HTMLElement | undefined {
    return this.panes.get(name);
  }

  /** The ground of a scenario as it is drawn. */
  reliefOf(name: ScenarioName): Relief {
    return this.views.get(name)?.relief ?? this.relief;
  }
  /** See ScenarioView.sink. */
  sink(view: ScenarioView, depth: Grid | null): void {
    view.sink(depth);
    let most = 0;
    for (const v of depth?.values ?? []) if (v > most) most = v;
    this.stats.sunk_m[view.name] = most;
    ++this.sinkings.value;
    this.relabel(view);
  }

  /** Light of the present look, in all views. */
  private shine(): void {
    const { natural } = this.twin;
    if (natural) this.hills ??= hillShade(this.relief, this.daylight.towards);
    for (const view of this.views.values()) {
      view.showLook(natural);
      if (this.hills) view.ground.shadeBy(this.hills);
    }
    this.invalidate();
  }
  private arrange(names: readonly ScenarioName[]): void {
    for (const [name, view] of this.views) {
      if (names.includes(name)) continue;
      view.dispose();
      this.views.delete(name);
      this.panes.get(name)?.remove();
      this.panes.delete(name);
    }
    for (const name of names) {
      if (this.views.has(name)) continue;
      const view = new ScenarioView(name, { scene: this.twin.scene, relief: this.relief, geometry: this.geometry, speedRamp: this.speedRamp,
        daylight: this.daylight });
      this.views.set(name, view);
      const pane = h("div", { class: "pane", "data-scenario": name }, view.labels.layer);
      this.panes.set(name, pane);
      this.element.append(pane);
    }
    // From left to right, or from top to bottom, in the order of the names.
    for (const name of names) {
      const view = this.views.get(name);
      this.views.delete(name);
      if (view) this.views.set(name, view);
      this.panes.get(name)?.classList.toggle("second", names.indexOf(name) === 1);
    }
    this.drawn = [...this.views.values()];
    this.element.classList.toggle("two", names.length > 1);
    this.divide();
    this.resize();
  }
  private divide(): void {
    const { divider } = this;
    this.element.style.setProperty("--divider", `${100 * (divider ?? 0.5)}%`);
    // A picture of another shape; where the divider only moves, nothing else changes.
    if (this.element.classList.toggle("swipe", divider !== null) !== this.swiped) this.resize();
    this.swiped = divider !== null;
    this.invalidate();
  }
  private push(frame: Frame): void {
    const begun = performance.now();
    this.views.get(frame.scenario)?.push(frame, begun);
    this.stats.upload_ms = performance.now() - begun;
    this.stats.decode_ms = this.twin.live.decode_ms;
    this.stats.unfold_ms = lastDecode.unfold_ms;
    this.stats.particles = frame.count;
    this.invalidate();
  }
  private resize(): void {
    this.width = Math.max(1, this.element.clientWidth);
    this.height = Math.max(1, this.element.clientHeight);
    this.setSharpness(1);
    this.renderer.setSize(this.width, this.height, false);
    const part = this.part(0);
    this.element.classList.toggle("stacked", this.stacked);
    this.rig.aspect = part.wide / part.high;
    if (this.element.clientWidth > 0) for (const reader of this.sizeReaders) reader();
    this.cameraMoved = true;
    this.invalidate();
  }

  /** Where two views of the whole stage meet, as a share of its width; null: views do not overlap. */
  get divider(): number | null {
    return this.views.size > 1 ? this.twin.divider.value : null;
  }
  /** Whether views stand above one another: where the stage is hardly wider than high, as on a phone. */
  get stacked(): boolean {
    return this.views.size > 1 && this.width < 1.1 * this.height && this.divider === null;
  }
  /** Place of the k-th view in pixels of the stage, from its top left. The next call changes it. */
  private part(k: number): Readonly<Stage["place"]> {
    const count = this.divider === null ? Math.max(1, this.views.size) : 1;
    const { place, stacked, width, height } = this;
    place.wide = stacked ? width : width / count;
    place.high = stacked ? height / count : height;
    place.left = stacked || count === 1 ? 0 : k * place.wide;
    place.top = stacked ? k * place.high : 0;
    return place;
  }
  /** `share` of the screen's pixels; a change clears the canvas. */
  private setSharpness(share: number): void {
    const ratio = share * Math.min(2, devicePixelRatio);
    if (ratio !== this.renderer.getPixelRatio()) this.renderer.setPixelRatio(ratio);
    this.stats.pixelRatio = ratio;
  }
  // Of a picture as little as possible is allocated here and in what it calls: sixty times a second it would add up.
  private readonly tick = (now_ms: number): void => {
    requestAnimationFrame(this.tick);
    if (this.filming) return;
    // Frames from the server are timed by the same clock.
    const now = Math.max(now_ms, 0);
    this.resolution.tick(now);
    if (this.rig.update(now)) this.invalidate();
    for (const view of this.drawn) if (view.clock.moving(now)) this.due = true;
    if (!this.due) {
      // A picture drawn at reduced resolution is drawn once more in full.
      if (this.stats.pixelRatio >= Math.min(2, devicePixelRatio) || !this.resolution.standsStill(now)) return;
      this.setSharpness(1);
      this.draw(now);
      return;
    }
    this.due = false;
    this.resolution.drew(now);
    this.setSharpness(this.resolution.share);
    this.draw(now);
  };
  draw(now: number): void {
    const begun = performance.now();
    const camera = this.rig.camera;
    camera.updateMatrixWorld();
    const pixels = this.part(0).high * this.renderer.getPixelRatio() * this.rig.magnification;
    this.renderer.setScissorTest(true);
    this.stats.detail = this.renderer.getPixelRatio() >= Math.min(2, devicePixelRatio) ? 2 : this.resolution.detail;
    this.daylight.prepare(this.twin.natural, this.rig.mode === "plan", this.stats.detail);
    this.stats.drawCalls = this.stats.trees = 0;
    let more = false;
    for (let k = 0; k < this.drawn.length; ++k) {
      const view = this.drawn[k];
      const { left, top, wide, high } = this.part(k);
      const bottom = this.height - top - high;
      if (view.update(now, camera, pixels, this.fastest_mps.value)) more = true;
      if (this.cameraMoved || !view.labels.placed) view.labels.place(this.rig, wide, high, this.covered(left, top));
      this.renderer.setViewport(left, bottom, wide, high);
      // Of two views of the whole stage each is drawn on its side of the divider.
      const cut = this.divider === null ? 0 : Math.round(this.divider * wide);
      if (this.divider === null) this.renderer.setScissor(left, bottom, wide, high);
      else this.renderer.setScissor(k === 0 ? 0 : cut, bottom, k === 0 ? cut : wide - cut, high);
      if (view.shadowsDue) {
        this.renderer.shadowMap.needsUpdate = true;
        view.shadowsDue = false;
      }
      const drawn = performance.now();
      this.renderer.clear();
      this.renderer.render(view.three, camera);
      this.stats.draw_ms = performance.now() - drawn;
      this.stats.drawCalls += this.renderer.info.render.calls;
      this.stats.trees += view.treesShown;
      if (view.name === this.twin.edited.value) this.stats.shownTime_s = view.clock.time_s(now) ?? 0;
    }
    if (this.cameraMoved) {
      this.cameraMoved = false;
      for (const reader of this.cameraReaders) reader();
    }
    if (more) this.due = true;
    for (const reader of this.readers) reader();
    ++this.stats.frames;
    this.stats.script_ms = performance.now() - begun;
  }
  /** Elements that cover a view whose top left corner is there, as boxes in that view. */
  private covered(left: number, top: number): Box[] {
    if (!this.element.isConnected) return [];
    const own = this.canvas.getBoundingClientRect();
    return this.covers.filter((e) => !e.hidden).flatMap((element) => [...(element.matches(".bar, .front-mark") ? [element] : element.children)]).map((element) => {
      const box = element.getBoundingClientRect();
      return [box.left - own.left - left, box.top - own.top - top, box.right - own.left - left, box.bottom - own.top - top];
    });
  }
  relabel(view: ScenarioView): void {
    view.refreshLabels();
    view.labels.placed = false;
    this.invalidate();
  }

  /** The view at a point of the page, and the point in it from -1 to 1, to the right and up. */
  viewAt(clientX: number, clientY: number): { name: ScenarioName; x: number; y: number } | null {
    const box = this.canvas.getBoundingClientRect();
    for (const [k, name] of [...this.views.keys()].entries()) {
      const { left, top, wide, high } = this.part(k);
      const [x, y] = [(clientX - box.left - left) / wide, (clientY - box.top - top) / high];
      if (this.divider !== null && (x < this.divider) !== (k === 0)) continue;
      if (x >= 0 && x < 1 && y >= 0 && y <= 1) return { name, x: 2 * x - 1, y: 1 - 2 * y };
    }
    return null;
  }
  /** The object under a point of the page. */
  hit(clientX: number, clientY: number): Hit | null {
    const at = this.viewAt(clientX, clientY);
    if (at === null) return null;
    const { from, direction } = this.rig.sight(at.x, at.y);
    const world = this.reliefOf(at.name).meet(from, direction);
    return world ? { scenario: at.name, world, x: clientX, y: clientY } : null;
  }
  /** A point of a view, from -1 to 1, in pixels of the page. */
  pixelOf(scenario: ScenarioName, x: number, y: number): { x: number; y: number } | null {
    const k = [...this.views.keys()].indexOf(scenario);
    if (k < 0) return null;
    const box = this.canvas.getBoundingClientRect();
    const { left, top, wide, high } = this.part(k);
    return { x: box.left + left + ((x + 1) / 2) * wide, y: box.top + top + ((1 - y) / 2) * high };
  }
  /** Position of a local place in pixels of the page; null behind the camera. */
  seenAt(local: Place, scenario: ScenarioName): { x: number; y: number } | null {
    const seen = new Vector3(...local).project(this.rig.camera);
    return seen.z > 1 ? null : this.pixelOf(scenario, seen.x, seen.y);
  }
  /** Metres per pixel at the camera's target; in a plan everywhere. */
  get metresPerPixel(): number {
    return this.rig.visible_m / this.part(0).high;
  }
  /** Draws now, so that the canvas can be read in the same task. */
  drawNow(): HTMLCanvasElement {
    this.setSharpness(1);
    this.draw(performance.now());
    return this.canvas;
  }
}
