// All graphics of one scenario.
import {
  Box3, Color, Group, PerspectiveCamera, Scene, Vector3, type BufferGeometry, type Camera, type Mesh, type MeshLambertMaterial, type Raycaster, type Texture,
} from "three";
import type { Line2 } from "three/examples/jsm/lines/Line2.js";
import { recycle, type Frame, type ScenarioName } from "../protocol/frame";
import type { Grid } from "../protocol/grid";
import type { Impacts, Place, SceneInfo, Setup } from "../protocol/messages";
import { Debris } from "./debris";
import { DepthField } from "./depth_field";
import { DrawnAreas, type Area } from "./drawn_areas";
import { FrameClock } from "./frame_clock";
import { Ground } from "./ground";
import { groundAreas, groundLabels, groundLines, sectionLabels, sectionLines } from "./ground_marks";
import { Labels, type Label } from "./labels";
import type { Daylight } from "./natural/daylight";
import { Houses } from "./natural/houses";
import { Rocks } from "./natural/rocks";
import { Trail } from "./natural/trail";
import { Trees } from "./natural/trees";
import type { Behind } from "./natural/veil";
import { disposeLine, pixelLine } from "./lines";
import type { Relief } from "./relief";
import { Sky } from "./sky";
import { barrierSolid, disposeSolid, houseSolid, plainHouse } from "./solids";
import { quantity, tick } from "../state/format";
import { observationText, placeOf } from "../state/tables";

export const releaseColour = "#a3262a";
/** What fits over the view; the list of notes has the whole. */
const shortened = (text: string): string => (text.length > 48 ? `${text.slice(0, 47)}…` : text);

const barrierColour = "#5d7f92";
const pathColour = "#08364d";
/** From the subtropics to cool hills; without a latitude as in temperate hills. */
const coniferShare = (latitude_deg: number | null): number => Math.min(0.7, Math.max(0.05, (Math.abs(latitude_deg ?? 45) - 25) / 30));

export interface Shared {
  scene: SceneInfo;
  relief: Relief;
  geometry: BufferGeometry;
  speedRamp: Texture;
  daylight: Daylight;
}

export class ScenarioView {
  readonly three = new Scene();
  readonly clock = new FrameClock(recycle);
  readonly ground: Ground;
  readonly debris: Debris;
  readonly labels: Labels;
  readonly sky: Sky;
  /** Lines and handles of the shape being drawn or edited, and marks of people and probes. */
  readonly overlay = new Group();
  extraLabels: Label[] = [];
  /** Names of features of people's layers. */
  overlayLabels: Label[] = [];
  namesShown = true;
  /** The ground as it is drawn: that of the scene, lowered by erosion. */
  relief: Relief;
  /** Id of the shape being edited: its handles replace its name. */
  selected: string | null = null;
  readonly trail: Trail;
  private readonly depths: DepthField;
  private readonly solids = new Group();
  private readonly houses: Houses;
  private readonly rocks: Rocks;
  private readonly trees: Trees;
  private readonly outlines = new Group();
  private readonly path = new Group();
  private readonly areas: DrawnAreas;
  private readonly wideAreas: DrawnAreas;
  private setup: Setup | null = null;
  private readonly sunInView = new Vector3();
  private readonly veiledFrom = new Vector3();
  private debrisMoved = true;
  /** Of the trees: what they may hide. */
  private readonly behind: Behind = {
    ground: (x, y) => this.relief.at(x + this.relief.origin[0], y + this.relief.origin[1]) - this.relief.origin[2],
    depth: (x, y) => this.depths.depthAt(x, y),
  };
  shadowsDue = true;

  constructor(readonly name: ScenarioName, private readonly shared: Shared) {
    const { scene, relief } = shared;
    this.relief = relief;
    this.sky = new Sky(this.three, shared.daylight);
    this.depths = new DepthField(scene);
    this.ground = new Ground(shared.geometry, relief, { ...this.depths.uniforms, ...shared.daylight.uniforms }, shared.scene.latitude_deg !== null);
    this.trail = new Trail(scene.map, scene.origin);
    this.ground.layTrail(this.trail);
    this.houses = new Houses(shared.daylight.uniforms);
    this.trees = new Trees(this.ground.uniforms, coniferShare(scene.latitude_deg));
    this.debris = new Debris(1.25 * scene.particle_spacing_m, shared.speedRamp);
    this.rocks = new Rocks(this.debris.geometry, this.debris.uniforms, this.ground.uniforms);
    this.labels = new Labels(relief);
    this.areas = new DrawnAreas(relief);
    this.wideAreas = new DrawnAreas(relief);
    this.three.add(this.ground.mesh, this.debris.points, this.rocks.rocks, this.rocks.spray, this.solids, this.houses.mesh, ...this.trees.meshes, this.outlines, this.path, this.overlay);
    this.drawPath();
  }

  /** Shadows are due after it. */
  showLook(natural: boolean): void {
    this.sky.shine(natural);
    this.houses.mesh.visible = natural;
    this.hideHouses();
    this.shadowsDue = true;
  }
  /** Plain solids of houses, where there are others in their place. */
  private hideHouses(): void {
    const barriers = new Set(this.setup?.barriers.map((b) => b.id));
    for (const group of this.solids.children) group.visible = !this.houses.mesh.visible || barriers.has(group.userData["id"] as string);
  }
  private drawPath(): void {
    const { relief } = this;
    for (const child of [...this.path.children]) disposeLine(child as Line2);
    const path = this.shared.scene.flow_path;
    if (!path) return;
    this.path.add(pixelLine(relief.drape(path.points.map(([x, y]) => [x, y]), 0.25), { colour: pathColour, width_px: 1.6, opacity: 0.75 }));
    for (const { at, across } of this.chainageMarks()) {
      const [x, y] = at;
      const half = 2.5;
      this.path.add(pixelLine(
        relief.drape([[x - across[0] * half, y - across[1] * half], [x + across[0] * half, y + across[1] * half]], 0.3),
        { colour: pathColour, width_px: 1.6, opacity: 0.75 },
      ));
    }
  }
  /** Round chainages, far enough apart to be read. */
  private chainageMarks(): { chainage: number; at: [number, number]; across: [number, number] }[] {
    const path = this.shared.scene.flow_path;
    if (!path) return [];
    const last = path.chainage_m[path.chainage_m.length - 1] ?? 0;
    const step = chainageStep(last);
    const marks = [];
    for (let chainage = 0; chainage <= last; chainage += step) {
      const place = placeOnPath(this.shared.scene, chainage);
      if (place) marks.push({ chainage, ...place });
    }
    return marks;
  }

  push(frame: Frame, now_ms: number): void {
    const previous = this.clock.next;
    const joins = this.clock.push(frame, now_ms);
    this.debris.push(frame, previous ?? frame, joins);
    this.depths.push(frame, joins);
    this.debrisMoved = true;
  }

  setSetup(setup: Setup): void {
    this.setup = setup;
    const { relief } = this.shared;
    for (const child of [...this.solids.children]) disposeSolid(child as Group);
    for (const building of setup.buildings) {
      const { base_m, roof_m } = building;
      if (base_m !== null && roof_m !== null) this.solids.add(houseSolid({ ...building, base_m, roof_m }, relief, plainHouse));
    }
    for (const barrier of setup.barriers) this.solids.add(barrierSolid(barrier, relief, barrierColour, this.shared.daylight));
    this.houses.build(setup.buildings, relief);
    this.trees.plant(setup, relief);
    this.trees.stand(this.relief);
    this.hideHouses();
    const areas: Area[] = [];
    for (const release of setup.releases) {
      // The thicker the release, the stronger its tint.
      const tint = 0.10 + 0.30 * Math.min(1, (release.thickness_m ?? 1) / 4);
      areas.push({ rings: release.polygons.flat(), colour: releaseColour, opacity: tint, pattern: release.status === "held" ? "rising" : "none", gap_m: 2.5 });
    }
    this.drawOutlines();
    this.ground.drape(this.areas.paint(areas), this.wideAreas.paint(groundAreas(setup)));
    this.sky.aim(new Box3().setFromObject(this.solids), this.trees.extent);
    this.shadowsDue = true;
    this.refreshLabels();
  }

  private drawOutlines(): void {
    for (const child of [...this.outlines.children]) disposeLine(child as Line2);
    for (const release of this.setup?.releases ?? []) {
      for (const ring of release.polygons.flat()) {
        this.outlines.add(pixelLine(this.relief.drape(ring, 0.25, true), { colour: releaseColour, width_px: 2, dashed: release.status === "held" }));
      }
    }
    if (this.setup) for (const line of groundLines(this.setup, this.relief)) this.outlines.add(line);
    for (const line of sectionLines(this.shared.scene.cross_sections, this.relief)) this.outlines.add(line);
  }

  /**
   * Lowers the ground by `depth`, NaN: unchanged; null: the scene's ground. Lines on it move with it, solids do not.
   */
  sink(depth: Grid | null): void {
    this.relief = depth ? this.shared.relief.lowered(depth) : this.shared.relief;
    this.labels.relief = this.relief;
    this.ground.sink(depth);
    this.trees.stand(this.relief);
    this.drawPath();
    this.drawOutlines();
  }

  /** Colours houses and barriers by impact; `colourOf` returns null for those not hit. */
  colourSolids(impacts: Impacts | null, colourOf: (id: string) => string | null, selected: string | null): void {
    for (const group of this.solids.children) {
      const id = group.userData["id"] as string;
      const isBarrier = this.setup?.barriers.some((b) => b.id === id) ?? false;
      const mesh = group.children[0] as Mesh;
      const material = mesh.material as MeshLambertMaterial;
      const colour = impacts === null || isBarrier ? null : colourOf(id);
      if (!isBarrier) this.houses.colour(id, colour, id === selected);
      material.color.set(colour ?? (isBarrier ? barrierColour : plainHouse));
      material.emissive.set(id === selected ? new Color("#1d86ab") : new Color(0));
      material.emissiveIntensity = 0.6;
    }
  }
  /** Of the next picture. */
  get treesShown(): number {
    return this.trees.shown;
  }
  solidAt(id: string): Vector3 | null {
    const group = this.solids.children.find((g) => g.userData["id"] === id);
    return group ? new Box3().setFromObject(group).getCenter(new Vector3()) : null;
  }

  /** Id of the nearest house or barrier that the ray hits before the ground. */
  solidUnder(ray: Raycaster): string | null {
    const [first] = ray.intersectObjects(this.solids.children.map((group) => group.children[0]), false);
    if (!first) return null;
    const ground = this.relief.meet(ray.ray.origin.toArray(), ray.ray.direction.toArray());
    const [ox, oy, oz] = this.relief.origin;
    const far = ground ? ray.ray.origin.distanceTo(new Vector3(ground[0] - ox, ground[1] - oy, ground[2] - oz)) : Infinity;
    return first.distance < far + 1 ? ((first.object.parent?.userData["id"] as string | undefined) ?? null) : null;
  }

  refreshLabels(): void {
    const labels: Label[] = [...this.extraLabels];
    const { relief, shared: { scene } } = this;
    const size = relief.width + relief.height;
    for (const note of this.setup?.notes ?? []) labels.push({ at: relief.local(note.x_m, note.y_m, 0.5), text: shortened(note.name), kind: "note", priority: 9 });
    if (this.namesShown) {
      labels.push(...this.overlayLabels);
      for (const { chainage, at } of this.chainageMarks()) {
        labels.push({ at: relief.local(at[0], at[1], 1), text: chainage === 0 ? "0 m" : chainage < 20 ? tick(chainage) : `${chainage}`, kind: "chainage", priority: 2, farthest: 1.6 * size });
      }
      for (const observation of this.setup?.observations ?? []) {
        const at = placeOf(observation, (chainage) => {
          const place = placeOnPath(scene, chainage);
          return place ? [place.at[0], place.at[1]] : null;
        });
        if (at) labels.push({ at: relief.local(at[0], at[1], 4), text: observationText(observation), kind: "observation", priority: 6 });
      }
      // Below their places, where observed front velocities and chainages of the same places do not hide them.
      for (const gauge of this.setup?.gauges ?? []) {
        labels.push({ at: relief.local(gauge.x_m, gauge.y_m, 0.5), text: gauge.name, kind: "gauge", priority: 5, below: true });
      }
      labels.push(...sectionLabels(scene.cross_sections, relief));
      for (const release of this.setup?.releases ?? []) {
        if (release.id === this.selected) continue;
        const ring = release.polygons[0]?.[0] ?? [];
        if (ring.length === 0) continue;
        const x = ring.reduce((sum, p) => sum + p[0], 0) / ring.length;
        const y = ring.reduce((sum, p) => sum + p[1], 0) / ring.length;
        labels.push({ at: relief.local(x, y, 3), text: `${release.name}, ${quantity(release.volume_m3, "m3")}`, kind: "release", priority: 8 });
      }
      for (const barrier of this.setup?.barriers ?? []) {
        if (barrier.id === this.selected) continue;
        const [x, y] = barrier.line[Math.floor(barrier.line.length / 2)] ?? [0, 0];
        labels.push({ at: relief.local(x, y, barrier.height_m + 1), text: `${barrier.name}, ${quantity(barrier.height_m, "m")}`, kind: "barrier", priority: 7 });
      }
      if (this.setup) labels.push(...groundLabels(this.setup, relief, this.selected));
      for (const building of this.setup?.buildings ?? []) {
        const ring = building.polygons[0]?.[0] ?? [];
        if (ring.length === 0 || building.roof_m === null) continue;
        const x = ring.reduce((sum, p) => sum + p[0], 0) / ring.length;
        const y = ring.reduce((sum, p) => sum + p[1], 0) / ring.length;
        labels.push({ at: [x - relief.origin[0], y - relief.origin[1], building.roof_m - relief.origin[2] + 0.5], text: building.name, kind: "house",
          priority: 1, farthest: 0.3 * size });
      }
    }
    this.labels.set(labels);
  }

  /** Interpolates the two frames for `now_ms`; true while something moves. */
  update(now_ms: number, camera: Camera, pixels: number, fastest_mps: number): boolean {
    const fraction = this.clock.fraction(now_ms);
    this.debris.mix(fraction);
    this.depths.mix(fraction);
    const { uNatural, uDetail } = this.shared.daylight.uniforms;
    this.rocks.show(uNatural.value > 0, uNatural.value > 0 && uDetail.value > 0);
    this.trees.show(uNatural.value > 0, uDetail.value);
    const veiling = this.veilTrees(camera);
    this.ground.uniforms.uFlowTime.value = this.clock.time_s(now_ms) ?? 0;
    this.sunInView.copy(this.sky.towards).transformDirection(camera.matrixWorldInverse);
    this.debris.prepare(pixels, this.sunInView, fastest_mps);
    return fraction < 1 || veiling;
  }
  /** True while there are trees to be looked at. */
  private veilTrees(camera: Camera): boolean {
    if (this.trees.extent.isEmpty()) return false;  // all of those planted later are looked at
    const moved = this.debrisMoved || camera.position.distanceTo(this.veiledFrom) > 0.5;
    if (moved) this.veiledFrom.copy(camera.position);
    this.debrisMoved = false;
    const eye: Place | null = camera instanceof PerspectiveCamera ? camera.position.toArray() : null;
    return this.trees.veil(eye, this.behind, moved);
  }
  dispose(): void {
    for (const child of [...this.solids.children]) disposeSolid(child as Group);
    this.houses.dispose();
    this.trees.dispose();
    this.rocks.dispose();
    this.ground.dispose();
    this.debris.dispose();
    this.depths.dispose();
    this.trail.dispose();
    this.areas.dispose();
    this.wideAreas.dispose();
    this.labels.layer.remove();
  }
}

/** Between the marks of a path of so many metres: a fifth to an eighth of one in a laboratory. */
export function chainageStep(length_m: number): number {
  if (length_m >= 20) return length_m > 4000 ? 500 : length_m > 1500 ? 200 : length_m > 600 ? 100 : length_m > 300 ? 50 : 25;
  const power = 10 ** Math.floor(Math.log10(Math.max(length_m, 0.01) / 5));
  const digit = length_m / 5 / power;
  return (digit >= 5 ? 5 : digit >= 2 ? 2 : 1) * power;
}

/** World place at a chainage and the unit vector across the path there. */
export function placeOnPath(scene: SceneInfo, chainage: number): { at: [number, number]; across: [number, number] } | null {
  const path = scene.flow_path;
  if (!path || path.points.length < 2) return null;
  let k = path.chainage_m.findIndex((c) => c >= chainage);
  if (k < 0) return null;
  k = Math.max(1, k);
  const [x0, y0] = path.points[k - 1];
  const [x1, y1] = path.points[k];
  const c0 = path.chainage_m[k - 1];
  const span = path.chainage_m[k] - c0;
  const t = span > 0 ? (chainage - c0) / span : 0;
  const length = Math.hypot(x1 - x0, y1 - y0) || 1;
  return { at: [x0 + t * (x1 - x0), y0 + t * (y1 - y0)], across: [-(y1 - y0) / length, (x1 - x0) / length] };
}
