// JSON of docs/protocol.md.
import type { ScenarioName } from "./frame";
import type { BarrierOpeningValues, BarrierValues, BedValues, BuildingsValues, HydrographValues, InflowValues, ReleaseValues, ZoneValues } from "./schema";

export type Point = [number, number];
export type Place = [number, number, number];
export type Role = "viewer" | "controller";

export interface Person { id: string; name: string; role: Role; colour: string; mark: Place | null }
/** secret: what this page shows with its requests, so that nobody can act in its name. */
export interface You { id: string; name: string; role: Role; colour: string; secret: string }
export interface Session {
  protocol: number;
  /** Changes when the server is restarted or another session is opened. */
  id: string;
  program: string;
  title: string;
  scenarios: ScenarioName[];
  people: Person[];
  controller: string | null;
  you?: { role: Role };
  /** Tokens that this person may share. */
  links?: { viewer?: string; controller?: string };
}

export interface Parameter {
  key: string;
  label: string;
  unit: string;
  default: number | null;
  value: number | null;
  range: { low: number | null; high: number | null; low_included: boolean; high_included: boolean };
  help: string;
  used_by_depth_averaged: boolean;
}
export interface Observation { name: string; chainage_m: number; quantity: "front_velocity" | "debris_speed"; observed_mps: number; source: string }
/** chainage_m: null: given as a place. */
export interface FlowPath { points: Place[]; chainage_m: number[]; corridor_width_m: number; traced: boolean }
export interface Category { name: string; colour: string }
export interface IntensityClass extends Category { criterion: string }
export interface SceneInfo {
  title: string;
  description: string;
  reconstruction: boolean;
  assumptions: string[];
  sources: string[];
  crs: string;
  crs_name: string;
  vertical_unit: string;
  /** null: its reference system does not say. */
  latitude_deg: number | null;
  origin: Place;
  extent_m: [number, number, number, number];
  elevation_m: [number, number];
  map: { x_min_m: number; y_min_m: number; cell_m: number; columns: number; rows: number };
  particle_spacing_m: number;
  end_time_s: number;
  gravity_mps2: number;
  flow_path: FlowPath | null;
  observations: Observation[];
  /** Whether there is an orthophoto. */
  orthophoto: boolean;
  parameters: Parameter[];
  /** Keys of the scene that others need, with their values. */
  settings: Record<string, string>;
  intensity: { guideline: string; classes: IntensityClass[]; rule: string; source: string };
}

export type Status = "paused" | "running" | "at_rest" | "ended" | "fault";
/** Whether the results of a run can be relied on: its numbers against their limits. */
export interface Verdict {
  within_limits: boolean;
  text: string;
  /** A sentence for each check beyond its limit. */
  warnings: string[];
  checks: { key: string; name: string; state: "within" | "beyond" | "not_measured"; value: number | null; limit: number | null; unit: string; text: string }[];
}
export interface State {
  scenario: ScenarioName;
  status: Status;
  message: string;
  time_s: number;
  end_time_s: number;
  /** When the run is expected to be over, from the motion of its debris; null before the first step and while debris outlasts the estimate. */
  expected_end_s: number | null;
  wall_remaining_s: number | null;
  step: number;
  speed_factor: number | null;
  real_time_factor: number;
  steps_per_second: number;
  particles: number;
  volume_released_m3: number;
  volume_entrained_m3: number;
  volume_held_m3: number;
  volume_moving_m3: number;
  volume_deposited_m3: number;
  volume_left_m3: number;
  front_chainage_m: number | null;
  front_velocity_mps: number | null;
  largest_speed_mps: number;
  /** The largest so far; null: not known. */
  peak_speed_mps: number | null;
  mean_compression: number;
  max_compression: number;
  overcompressed_share: number;
  too_compressed: boolean | null;
  /** Of a moment ago while the run goes on; null before the first step. */
  verdict: Verdict | null;
  /** A change that is being prepared, and the share of it that is done. */
  preparing: { what: string; share: number } | null;
  recording: { first_s: number; last_s: number; frames: number; bytes: number };
  hash?: string;
}

export interface Release extends ReleaseValues {
  id: string;
  name: string;
  polygons: Point[][];
  volume_m3: number;
  from_scene: boolean;
  status: "held" | "released";
  start_time_s: number | null;
}
export type BarrierOpening = BarrierOpeningValues;
export interface Barrier extends BarrierValues {
  id: string;
  name: string;
  line: Point[];
  /** The mean of a level crest. */
  height_m: number;
  openings: BarrierOpening[];
  crest_length_m: number;
  from_scene: boolean;
}
export interface Building extends BuildingsValues {
  id: string;
  name: string;
  /** Polygons, each with its outer ring first. */
  footprint: Point[][][];
  base_m: number;
  roof_m: number;
  from_scene: boolean;
}
export interface Zone extends ZoneValues {
  id: string;
  name: string;
  /** Each with its outer ring first; none: it comes from a raster and has no outline. */
  polygons: Point[][][];
  area_m2: number;
  from_scene: boolean;
}
/** Its depth is null where it differs from place to place. */
export interface Bed extends BedValues {
  id: string;
  name: string;
  /** None: it comes from a raster, or covers everything. */
  polygons: Point[][][];
  area_m2: number;
  volume_m3: number;
  from_scene: boolean;
  /** false: changed; in force after the next restart. */
  in_force: boolean;
}
/** density_kgpm3: null or absent: the material's rest density. */
export type HydrographRow = Omit<HydrographValues, "density_kgpm3"> & Partial<HydrographValues>;
/** Debris injected during the run: to the right of a line, seen along it, or over an area. */
export interface Inflow extends InflowValues {
  id: string;
  name: string;
  line: Point[] | null;
  polygons: Point[][][];
  /** null: too long to be edited here. */
  hydrograph: HydrographRow[] | null;
  volume_m3: number;
  from_scene: boolean;
  in_force: boolean;
}
/** A change of a run after its first step. */
export interface ChangeOnTheWay { time_s: number; by: string; sentence: string }
/** Where depth and speed are recorded. */
export interface Gauge {
  id: string;
  name: string;
  x_m: number;
  y_m: number;
  /** null: given as a place. */
  chainage_m: number | null;
  from_scene: boolean;
  /** false: from the next restart. */
  in_force: boolean;
}

/** A text that people have pinned to a place; it does not affect the run. */
export interface Note {
  id: string;
  /** The text. */
  name: string;
  x_m: number;
  y_m: number;
}

export interface Setup {
  scenario: ScenarioName;
  /** Given by people; may be empty. */
  name: string;
  changes: ChangeOnTheWay[];
  revision: number;
  parameters: Record<string, number | null>;
  releases: Release[];
  barriers: Barrier[];
  buildings: Building[];
  zones: Zone[];
  beds: Bed[];
  inflows: Inflow[];
  gauges: Gauge[];
  notes: Note[];
  /** Beds, inflows or gauges differ from those at the run's start. */
  pending_restart: boolean;
  undo: string | null;
  redo: string | null;
}

export interface Impact {
  id: string;
  name: string;
  hit: boolean;
  first_hit_s: number | null;
  peak_force_kN: number | null;
  peak_impact_pressure_kPa: number | null;
  peak_depth_m: number | null;
  peak_dynamic_pressure_kPa: number | null;
  impulse_kNs: number;
  failed_s: number | null;
  intensity: string | null;
}
export interface BarrierImpact extends Impact {
  overtopped_m3: number;
  first_overtopped_s: number | null;
  passed_m3: number;
  retained_m3: number;
  peak_filling_height_m: number;
}
/** An obstacle removed during the run, and its impact until then. */
export interface RemovedImpact extends Impact { kind: "building" | "barrier"; removed_s: number; overtopped_m3?: number; retained_m3?: number }
export interface Impacts { buildings: Impact[]; barriers: BarrierImpact[]; removed: RemovedImpact[] }

/** What passed a gauge, and what is there. */
export interface GaugeReading { name: string; arrival_s: number | null; depth_m: number; speed_mps: number; peak_depth_m: number; peak_speed_mps: number }

export type Column = (number | null)[];
export interface Series {
  time: Record<string, Column>;
  front: { chainage_m: Column; arrival_time_s: Column; front_velocity_mps: Column; particle_speed_mps: Column };
  /** A column of depths per gauge of the scene. */
  gauges: { time_s: Column; depth_m: Column[] };
}
export interface ProbeSeries { time_s: Column; depth_m: Column; speed_mps: Column; pressure_kPa: Column }
export interface Recording { times_s: number[]; bytes: number }
/** Of a run, as in its report. */
export interface Figure { key: string; name: string; value: number | string | null; unit: string }
export interface ExportFile { name: string; bytes: number | null; what: string }

export type CalibrationState = "idle" | "running" | "cancelling" | "done" | "cancelled" | "failed";
export interface CalibrationRun { values: number[]; phase: "design" | "search" | "check"; misfit: number | null }
export interface CalibrationStatus {
  state: CalibrationState;
  /** Why none can be started here; null: one can. */
  why_not: string | null;
  by: string | null;
  message: string;
  observations: { name: string; unit: string; observed: number; uncertainty: number; is: "equal" | "at_least" | "below"; best: number | null; deviation: number | null }[];
  parameters: { key: string; label: string; unit: string; low: number; high: number }[];
  phase: CalibrationRun["phase"] | null;
  runs_at_most: number;
  runs_failed: number;
  /** Of the depth-averaged model, which searches; at most 0: it does not. */
  fast_runs: CalibrationRun[];
  fast_runs_at_most: number;
  wall_remaining_s: number | null;
  runs: CalibrationRun[];
  /** By the emulators over the first two parameters, by rows of the second; one row where there is one parameter. */
  map: { columns: number; rows: number; misfit: (number | null)[] } | null;
  best: { run: number; values: number[]; misfit: number } | null;
  result: {
    settled: boolean;
    checks_within_95: number | null;
    parameters: { key: string; best: number; median: number; low_95: number; high_95: number; share_of_prior_width: number }[];
    warnings: string[];
  } | null;
}

export const layerNames = ["depth", "peak_depth", "peak_speed", "peak_pressure", "arrival_time", "deposit_depth", "erosion_depth"] as const;
export type LayerName = (typeof layerNames)[number];

/** A map of a finished ensemble. */
export interface EnsembleMap {
  name: string;
  title: string;
  unit: string;
  kind: "probability" | "percentile" | "zones";
  /** The map of a single run from which it is computed. */
  of: Exclude<LayerName, "depth" | "erosion_depth"> | "intensity";
  description: string;
  /** Of a probability of depth, speed or pressure. */
  threshold: number | null;
  threshold_unit: string | null;
  percentile: number | null;
  /** Of zones: of the values 1, 2, ... */
  categories: Category[];
  /** null: no run reached any place by that measure. */
  greatest: number | null;
}
export interface Ensemble {
  id: string;
  name: string;
  runs: number;
  failed: number;
  factors: { key: string; distribution: string }[];
  same_terrain: boolean;
  maps: EnsembleMap[];
}
export type EnsembleLayer = `ensemble/${string}/${string}`;

/** What the depth-averaged model has a map of. */
export const quantityNames = ["depth", "peak_depth", "peak_speed", "peak_pressure", "arrival_time", "deposit_depth"] as const;
export type DepthAveragedLayer = `depth_averaged/${(typeof quantityNames)[number]}`;
/** Of the present setup, from time 0 to its end. */
export interface DepthAveragedResult {
  end_s: number;
  complete: boolean;
  stop_reason: string;
  verdict: Verdict;
  wall_time_s: number;
  processor_time_s: number;
  grid_cell_m: number;
  hash: string;
  /** Sentences on what the model leaves out. */
  notes: string[];
  front: { chainage_m: Column; arrival_time_s: Column; front_velocity_mps: Column };
}
export interface DepthAveragedStatus {
  scenario: ScenarioName;
  state: "off" | "waiting" | "running" | "done" | "refused" | "failed";
  /** Why it was refused or failed. */
  message: string;
  share: number | null;
  result: DepthAveragedResult | null;
}
/** A quantity of both models: particles so far, the other model by the same time and at its end. */
export interface DepthAveragedRow { key: string; name: string; unit: string; decimals: number; particles: number | null; depth_averaged_by_then: number | null; depth_averaged: number | null; observed: number | null }
export interface DepthAveragedComparison {
  time_s: number;
  /** The particles' run is over: then both are compared as a whole. */
  over: boolean;
  rows: DepthAveragedRow[];
  least_depth_m: number;
  area: { both_m2: number; particles_only_m2: number; depth_averaged_only_m2: number; intersection_over_union: number | null };
  /** Sentences on how the setups of both differ. */
  differs: string[];
}
/** A layer on the ground: of the run, of the depth-averaged model, or a map of an ensemble. */
export type ShownLayer = LayerName | DepthAveragedLayer | EnsembleLayer;

export type Action =
  | { action: "run" | "pause" | "step" | "restart"; scenarios: ScenarioName[] }
  | { action: "undo" | "redo" | "cancel" }
  | { action: "name_scenario"; name: string }
  | { action: "set_speed"; factor: number | null }
  | { action: "set_parameter"; key: string; value: number }
  | { action: "set_parameters"; values: Record<string, number> }
  // With an id, only changed values need to be given.
  | { action: "put_release"; id?: string; name?: string; polygon?: Point[]; move_m?: Point } & Partial<ReleaseValues>
  | { action: "put_barrier"; id?: string; name?: string; line?: Point[]; openings?: BarrierOpening[] } & Partial<BarrierValues>
  | { action: "put_building"; id?: string; name?: string; footprint?: Point[]; move_m?: Point } & Partial<BuildingsValues>
  | { action: "put_zone"; id?: string; name?: string; polygon?: Point[]; move_m?: Point } & Partial<ZoneValues>
  | { action: "put_bed"; id?: string; name?: string; polygon?: Point[]; move_m?: Point } & Partial<BedValues>
  | { action: "put_inflow"; id?: string; name?: string; line?: Point[]; polygon?: Point[]; move_m?: Point; hydrograph?: HydrographRow[] } & Partial<InflowValues>
  | { action: "put_gauge"; id?: string; name?: string; x_m?: number; y_m?: number; chainage_m?: number }
  | { action: "put_note"; id?: string; name?: string; x_m?: number; y_m?: number }
  | { action: "remove_gauge" | "remove_note" | "trigger_release" | "remove_release" | "remove_barrier" | "remove_building" | "remove_zone" | "remove_bed" | "remove_inflow"; id: string };
export interface Done { done: string; created: string | null }
/** object: id of what the action made. */
export interface NewScenario { done: string; created: ScenarioName; object: string | null }

/** Values of a trigger's message, by key with its unit. */
export type TriggerValues = Partial<Record<"volume_m3" | "pore_pressure_ratio" | "discharge_m3ps", number>>;
/** A run that a trigger started; times of day are UTC. */
export interface TriggeredRun {
  scenario: ScenarioName;
  trigger: string;
  source: string;
  received_at: string;
  reason: string;
  values: TriggerValues;
  reading: { discharge_m3ps: number; received_at: string } | null;
}
export interface RaisedAlarm {
  scenario: ScenarioName;
  alarm: string;
  sentence: string;
  message: string;
  time_s: number;
  expected_s: number | null;
  step: number;
  hash: string;
  raised_at: string | null;
  delivery: string;
}
export interface Alerts {
  listening: { http: boolean; mqtt: string | null };
  triggers: { name: string; limits: TriggerValues }[];
  runs: TriggeredRun[];
  alarms: RaisedAlarm[];
  notes: { at: string; sentence: string }[];
}

export type ServerMessage =
  | { type: "hello"; protocol: number; you: You; session: Session }
  | ({ type: "state" } & State)
  | ({ type: "setup" } & Setup)
  | { type: "people"; people: Person[]; controller: string | null; request: { id: string; name: string } | null }
  | ({ type: "calibration" } & CalibrationStatus)
  | ({ type: "alerts" } & Alerts)
  | ({ type: "depth_averaged" } & DepthAveragedStatus)
  | { type: "scenarios"; scenarios: ScenarioName[] }
  | { type: "ended" }
  | { type: "done"; scenario: ScenarioName; by: string; done: string };

/** Whether other computers reach the server, and by which addresses they could. */
export interface Share {
  shared: { host: string; encrypted: boolean; viewer_url: string; controller_url: string } | null;
  addresses: string[];
}
export interface WantedShare { address: string; port: number; name?: string; certificate?: string; key?: string }
