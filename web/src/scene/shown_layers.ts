// Keeps the selected map layer of every scenario on its ground, updated during the run.
import type { Texture } from "three";
import { scenarioNames, type ScenarioName } from "../protocol/frame";
import { gridAt, type Grid } from "../protocol/grid";
import type { DepthAveragedLayer, EnsembleLayer, ShownLayer } from "../protocol/layers";
import type { LayerName } from "../protocol/messages";
import { Cell, watchAll } from "../state/cell";
import type { Twin } from "../state/twin";
import { divergingAt, rampAt, ramps, roundStep } from "./colour";
import { DepthAveragedMaps } from "./depth_averaged_maps";
import { rampTexture, type Photo } from "./ground";
import { photoTexture } from "./photo";
import { colourOf, differenceOf, drapedFrom, findMap, infoOf, inUnit, isDepthAveragedLayer, isEnsembleLayer, quantityOf, rangeOfMap, scaleEnd, shownOfMap, shownValues } from "./layers";
import type { Stage } from "./stage";

const refresh_ms = 2000;

/** A layer of a run, of one of both models. */
type RunLayer = LayerName | DepthAveragedLayer;

export class ShownLayers {
  /** Values at the ends of the legend. */
  readonly range = new Cell<readonly [number, number]>([0, 1]);
  readonly grids = new Map<ScenarioName, Grid>();
  /** Time of the recording of the displayed layers; null: now. */
  readonly shown_s = new Cell<number | null>(null);
  surfaceTop = 3;
  private ofNow: { key: string; grids: readonly Grid[] } | null = null;
  private difference: Grid | null = null;
  private readonly ofEnsembles = new Map<EnsembleLayer, Grid>();
  private readonly rampTextures = new Map<string, Texture>();
  private readonly held = new Map<ScenarioName, Texture>();
  private photo: Photo | null = null;
  private readonly otherModel: DepthAveragedMaps;
  private busy = false;
  private again = false;

  constructor(private readonly twin: Twin, private readonly stage: Stage) {
    this.otherModel = new DepthAveragedMaps(twin, () => {
      this.forgetStale();
      if (this.isLive) void this.load();
    });
    watchAll([twin.layer, twin.difference, twin.shown, twin.replay_s], () => void this.load());
    twin.layerOpacity.watch(() => this.put());
    watchAll([twin.look, twin.layer, twin.surface, twin.particles, twin.contours, twin.shown, stage.fastest_mps], () => this.putSurface());
    watchAll([twin.photo, twin.shown], () => void this.putPhoto());
    setInterval(() => {
      const running = twin.shown.value.some((s) => twin.cells[s].state.value?.status === "running");
      if (running && this.isLive && twin.replay_s.value === null) void this.load();
    }, refresh_ms);
    // A step or the end of the run changes the maps once more.
    for (const s of scenarioNames) {
      let before = -1;
      twin.cells[s].state.watch((state) => {
        if (state && state.status !== "running" && state.step !== before) {
          before = state.step;
          if (this.isLive) void this.load();
        }
      });
    }
  }
  /** Whether the layer is one of the run, which changes with it. */
  private get isLive(): boolean {
    const name = this.twin.layer.value;
    return name !== "none" && !isEnsembleLayer(name);
  }
  get isDifference(): boolean {
    return this.twin.difference.value && this.twin.shown.value.length > 1 && this.isLive;
  }
  /** Value of the shown layer of a scenario, or of the difference, at a world place; null: no layer or no value. */
  valueAt(scenario: ScenarioName, x: number, y: number): number | null {
    const grid = this.difference ?? this.grids.get(scenario);
    const value = grid ? gridAt(grid, x, y) : NaN;
    return Number.isFinite(value) ? value : null;
  }

  private async load(): Promise<void> {
    if (this.busy) {
      this.again = true;
      return;
    }
    this.busy = true;
    do {
      this.again = false;
      const name = this.twin.layer.value;
      if (name === "none") {
        this.grids.clear();
        this.difference = null;
        this.put();
        continue;
      }
      if (isEnsembleLayer(name)) {
        if (!(await this.twin.attempt(() => this.loadMap(name)))) break;
        continue;
      }
      const names = this.twin.shown.value;
      const time = this.twin.replay_s.value;
      const fine = await this.twin.attempt(async () => {
        const [grids, present, others] = await Promise.all([Promise.all(names.map((s) => this.layerOf(s, name, time))), this.presentFor(name, names, time),
          Promise.all(names.map((s) => this.counterpartOf(s, name, time)))]);
        this.grids.clear();
        names.forEach((s, i) => {
          const grid = grids[i];
          if (grid) this.grids.set(s, grid);
        });
        this.shown_s.value = time;
        if (this.twin.layer.value === name) this.show(name, present, others.filter((grid) => grid !== null));
      });
      if (!fine) break;
    } while (this.again);
    this.busy = false;
  }
  /** null: the depth-averaged model has no result. */
  private async layerOf(scenario: ScenarioName, name: RunLayer, time: number | null = null): Promise<Grid | null> {
    return isDepthAveragedLayer(name) ? this.otherModel.of(scenario, quantityOf(name), time) : inUnit(name, await this.twin.api.layer(scenario, name, time));
  }
  /** The same quantity of the other model, once there is a result of both: both have one scale. */
  private async counterpartOf(scenario: ScenarioName, name: RunLayer, time: number | null): Promise<Grid | null> {
    if (!this.otherModel.has(scenario)) return null;
    return isDepthAveragedLayer(name) ? this.layerOf(scenario, quantityOf(name), time) : this.otherModel.of(scenario, name, time);
  }
  /** A map of a setup that is no more goes at once. */
  private forgetStale(): void {
    if (!isDepthAveragedLayer(this.twin.layer.value)) return;
    for (const s of scenarioNames) {
      if (this.otherModel.has(s)) continue;
      this.grids.delete(s);
      this.difference = null;
    }
    this.put();
  }
  /** A map of an ensemble lies on every scenario's ground, at any time. */
  private async loadMap(name: EnsembleLayer): Promise<void> {
    const found = findMap(this.twin.ensembles.value, name);
    if (!found) return;
    const grid = this.ofEnsembles.get(name) ?? (await this.twin.api.ensembleMap(found.ensemble.id, found.map.name));
    this.ofEnsembles.set(name, grid);
    if (this.twin.layer.value !== name) return;
    const shown = { ...grid, values: shownOfMap(found.map, grid) };
    this.difference = null;
    this.shown_s.value = null;
    this.range.value = rangeOfMap(found.map, shown.values);
    this.grids.clear();
    for (const s of this.twin.shown.value) this.grids.set(s, shown);
    this.lay(name, this.grids);
  }
  /** In the recording, colours remain those of the current time, so that maps of different times can be compared. */
  private async presentFor(name: RunLayer, names: readonly ScenarioName[], time: number | null): Promise<readonly Grid[] | null> {
    if (time === null) {
      this.ofNow = null;
      return null;
    }
    const key = `${name} ${names.join()}`;
    if (this.ofNow?.key !== key) this.ofNow = { key, grids: (await Promise.all(names.map((s) => this.layerOf(s, name)))).filter((grid) => grid !== null) };
    return this.ofNow.grids;
  }
  private show(name: RunLayer, present: readonly Grid[] | null, others: readonly Grid[]): void {
    const { twin } = this;
    const [a, b] = twin.shown.value.map((s) => this.grids.get(s));
    const all = new Map<ScenarioName, Grid>();
    this.difference = null;
    const quantity = quantityOf(name);
    if (this.isDifference && !(a && b)) this.grids.clear();  // of one alone there is no difference
    if (this.isDifference && a && b) {
      const difference = differenceOf(quantity, a, b);
      this.difference = difference;
      const ends = present && present.length > 1 ? differenceOf(quantity, present[0], present[1]) : difference;
      const end = scaleEnd(ends.values.map(Math.abs));
      this.range.value = [-end, end];
      // Both views show it, so that it can be compared with either flow.
      for (const s of twin.shown.value) all.set(s, difference);
    } else {
      let end = 0;
      for (const s of twin.shown.value) {
        const grid = this.grids.get(s);
        if (!grid) continue;
        const values = shownValues(quantity, grid);
        all.set(s, { ...grid, values });
        end = Math.max(end, scaleEnd(values));
      }
      if (present) end = Math.max(...present.map((grid) => scaleEnd(shownValues(quantity, grid))));
      this.range.value = [0, Math.max(end, ...others.map((grid) => scaleEnd(shownValues(quantity, grid))))];
    }
    this.lay(name, all);
  }
  private lay(name: ShownLayer, all: ReadonlyMap<ScenarioName, Grid>): void {
    for (const [s, grid] of all) {
      const view = this.stage.views.get(s);
      if (!view) continue;
      this.held.get(s)?.dispose();
      const draped = drapedFrom(grid, this.twin.scene.origin, infoOf(name, this.twin.ensembles.value).categories === undefined);
      this.held.set(s, draped.texture);
      view.ground.showLayer(draped, this.rampFor(name), [...this.range.value] as [number, number], this.twin.layerOpacity.value);
    }
    this.put();
  }
  private put(): void {
    for (const view of this.stage.views.values()) {
      if (this.twin.layer.value === "none") view.ground.showLayer(null, null, [0, 1], 0);
      else view.ground.uniforms.uLayerOpacity.value = this.grids.has(view.name) ? this.twin.layerOpacity.value : 0;
    }
    this.stage.invalidate();
  }
  private rampFor(name: ShownLayer | "speed" | "difference"): Texture {
    const key = this.isDifference && name !== "speed" ? "difference" : name;
    let texture = this.rampTextures.get(key);
    if (!texture) {
      texture = rampTexture(key === "difference" ? (s) => divergingAt(2 * s - 1)
        : (s) => (key === "speed" ? rampAt(ramps.speed, s) : colourOf(infoOf(key as ShownLayer, this.twin.ensembles.value), s)));
      this.rampTextures.set(key, texture);
    }
    return texture;
  }
  private putSurface(): void {
    const { twin, stage } = this;
    const spacing = twin.scene.particle_spacing_m;
    this.surfaceTop = roundStep(Math.max(1, 5 * spacing));
    for (const view of stage.views.values()) {
      view.debris.points.visible = twin.particles.value && !twin.natural;
      const bySpeed = twin.surface.value === "speed";
      view.ground.showSurface(twin.surface.value !== "off", bySpeed, bySpeed ? this.rampFor("speed") : this.surfaceRamp(),
        bySpeed ? stage.fastest_mps.value : this.surfaceTop);
      view.ground.uniforms.uContour.value = twin.contours.value ? 1 : 0;
    }
    stage.invalidate();
  }
  private async putPhoto(): Promise<void> {
    const { twin, stage } = this;
    if (twin.photo.value && !this.photo) {
      const fine = await twin.attempt(async () => {
        this.photo ??= await photoTexture(await twin.api.orthophoto(), twin.scene);
      });
      if (!fine) twin.photo.value = false;
    }
    for (const view of stage.views.values()) view.ground.showPhoto(twin.photo.value ? this.photo : null);
    stage.invalidate();
  }
  private surfaceRamp(): Texture {
    let texture = this.rampTextures.get("surface");
    if (!texture) {
      texture = rampTexture((s) => rampAt(ramps.surface_depth, s));
      this.rampTextures.set("surface", texture);
    }
    return texture;
  }
}
