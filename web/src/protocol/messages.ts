// Made from src/serve/protocol.json: edit that; docs/protocol.md tells how this is made again.
import type { BarrierOpeningValues, BarrierValues, BedValues, BuildingsValues, HydrographValues, InflowValues, ReleaseValues, ZoneValues } from "./schema";

/** Those that there can be at one time. */
export const scenarioNames = ["A", "B", "C", "D", "E", "F"] as const;
export type ScenarioName = (typeof scenarioNames)[number];

/** East and north, m, in the terrain's reference system. */
export type Point = [number, number];

/** East, north and up, m. */
export type Place = [number, number, number];

/** Of a table. */
export type Column = (number | null)[];

/** What a token entitles to. */
export type Role = "viewer" | "controller";

/** Why a request was refused. */
export interface Refusal {
  /** One sentence that names key, value and allowed range. */
  error: string;
}

/** What came of a change. */
export interface Done {
  /** What has happened, for people. */
  done: string;
  /** Id of what is new, or null. */
  created: string | null;
}

/** What came of a request for another scenario. */
export interface NewScenario {
  /** What has happened, for people. */
  done: string;
  /** Its name. */
  created: ScenarioName;
  /** Id of what its action made, or null. */
  object: string | null;
}

/** Somebody who has the page open. */
export interface Person {
  id: string;
  name: string;
  role: Role;
  colour: string;
  /** Local position that the person points at, m. */
  mark: Place | null;
}

/** The person of a page itself. */
export interface You {
  id: string;
  name: string;
  role: Role;
  colour: string;
  /** What this page shows with its requests, so that nobody can act in its name. */
  secret: string;
}

/** Who asks for control. */
export interface ControlRequest { id: string; name: string }

/** Who is here, what runs. */
export interface Session {
  /** Version of docs/protocol.md. */
  protocol: number;
  /** Identifies the session: it changes when the server is restarted or another session is opened. */
  id: string;
  /** With its version. */
  program: string;
  /** Of the scene. */
  title: string;
  /** What the token of the request entitles to. */
  you: { role: Role };
  scenarios: ScenarioName[];
  people: Person[];
  /** Id of who has control. */
  controller: string | null;
  /** Who asks for control. */
  request: ControlRequest | null;
  /** Tokens of the links to share, as far as the own token entitles to them. */
  links: { viewer: string; controller?: string };
}

/** Body of POST /api/control. */
export interface WantedControl {
  do: "request" | "release" | "grant" | "decline";
  /** From the WebSocket's hello; default: the header's. */
  secret?: string;
}

/** null: no bound. */
export interface ParameterRange { low: number | null; high: number | null; low_included: boolean; high_included: boolean }

/** A live parameter, from the declaration that also makes the scene file's reference. */
export interface Parameter {
  /** Such as material.friction_coefficient. */
  key: string;
  label: string;
  unit: string;
  /** In this scene. */
  default: number | null;
  value: number | null;
  range: ParameterRange;
  help: string;
  /** Whether the depth-averaged model has a use for it. */
  used_by_depth_averaged: boolean;
}

/** What was observed in the field. */
export interface Observation {
  name: string;
  /** Along the flow path. */
  chainage_m: number;
  quantity: "front_velocity" | "debris_speed";
  observed_mps: number;
  source: string;
}

/** The line along which the front is measured. */
export interface FlowPath {
  points: Place[];
  /** At each of the points. */
  chainage_m: number[];
  corridor_width_m: number;
  /** Traced down the terrain; false: from a file. */
  traced: boolean;
}

/** A gauge of the scene file. */
export interface GaugePlace {
  name: string;
  x_m: number;
  y_m: number;
  /** Null: given as a place. */
  chainage_m: number | null;
}

/** A value of a map of classes. */
export interface Category { name: string; colour: string }

/** A class of a guideline. */
export interface IntensityClass extends Category { criterion: string }

/** Grid of depth windows, and of layers except erosion_depth. */
export interface MapGrid {
  /** West edge. */
  x_min_m: number;
  /** South edge. */
  y_min_m: number;
  cell_m: number;
  columns: number;
  rows: number;
}

/** By which structures are classed. */
export interface IntensityGuideline {
  /** Name of that of outputs.intensity_guideline. */
  guideline: string;
  classes: IntensityClass[];
  /** One sentence. */
  rule: string;
  /** The publication. */
  source: string;
}

/** What does not change during a session. */
export interface SceneInfo {
  title: string;
  description: string;
  /** Whether it reconstructs an event, as the scene says. */
  reconstruction: boolean;
  assumptions: string[];
  sources: string[];
  /** Reference system, such as EPSG:2326. */
  crs: string;
  crs_name: string;
  vertical_unit: string;
  /** Of the middle of the terrain; null where the reference system does not say. */
  latitude_deg: number | null;
  /** World position of the local frame's origin, m. */
  origin: Place;
  /** Of the terrain: west, south, east, north. */
  extent_m: [number, number, number, number];
  /** Lowest and highest. */
  elevation_m: [number, number];
  /** Of depth windows, and of layers except erosion_depth. */
  map: MapGrid;
  /** Whether /api/orthophoto has a picture. */
  orthophoto: boolean;
  particle_spacing_m: number;
  end_time_s: number;
  gravity_mps2: number;
  flow_path: FlowPath | null;
  observations: Observation[];
  /** As the scene file has them. */
  gauges: GaugePlace[];
  /** The live ones. */
  parameters: Parameter[];
  /** Keys of the scene that others need, such as solver.internal_friction, with their values. */
  settings: Record<string, string>;
  intensity: IntensityGuideline;
}

/** Of a scenario. fault: the step could not be trusted. */
export type Status = "paused" | "running" | "at_rest" | "ended" | "fault";

/** A number of a run against its limit. */
export interface Check {
  key: "resolution" | "compression" | "energy" | "still_moving" | "convergence";
  name: string;
  state: "within" | "beyond" | "not_measured";
  value: number | null;
  limit: number | null;
  unit: string;
  /** One sentence. */
  text: string;
}

/** Whether the results of a run can be relied on: its numbers against their limits. */
export interface Verdict {
  /** No check is beyond its limit. */
  within_limits: boolean;
  /** One sentence. */
  text: string;
  /** A sentence for each check beyond its limit. */
  warnings: string[];
  checks: Check[];
}

/** A change that is being prepared. */
export interface Preparation {
  what: string;
  /** That is done, 0 to 1. */
  share: number;
}

/** What is recorded; null: nothing yet. */
export interface RecordingExtent {
  first_s: number | null;
  last_s: number | null;
  frames: number;
  /** Of memory. */
  bytes: number;
}

/** Status, time, rates and mass balance of a scenario. */
export interface State {
  scenario: ScenarioName;
  status: Status;
  /** One sentence, or empty. */
  message: string;
  /** Simulated. */
  time_s: number;
  /** Of the scene. */
  end_time_s: number;
  /** When the run is expected to be over, from the motion of its debris; null before the first step and while debris outlasts the estimate. */
  expected_end_s: number | null;
  /** Wall time until then as fast as it goes; null likewise. */
  wall_remaining_s: number | null;
  /** Steps taken. */
  step: number;
  /** Simulated seconds per second that are wanted; null: as fast as it goes. */
  speed_factor: number | null;
  /** Simulated seconds per second of late. */
  real_time_factor: number;
  steps_per_second: number;
  particles: number;
  /** With what has flowed in. */
  volume_released_m3: number;
  /** Entrained from the bed. */
  volume_entrained_m3: number;
  /** Not started yet. */
  volume_held_m3: number;
  volume_moving_m3: number;
  volume_deposited_m3: number;
  /** Beyond the edge of the terrain. */
  volume_left_m3: number;
  front_chainage_m: number | null;
  /** Null: it does not advance. */
  front_velocity_mps: number | null;
  /** Of the particles now. */
  largest_speed_mps: number | null;
  /** The largest so far. */
  peak_speed_mps: number | null;
  mean_compression: number | null;
  max_compression: number | null;
  /** Of the particles. */
  overcompressed_share: number | null;
  /** Null before the first step. */
  too_compressed: boolean | null;
  /** Whether the run so far can be relied on, as of a moment ago; null before the first step. */
  verdict: Verdict | null;
  /** A change that is being prepared, and the share of it that is done. */
  preparing: Preparation | null;
  recording: RecordingExtent;
  /** Of time and particles; while not running. */
  hash?: string;
}

/** Debris that starts to move at one moment. */
export interface Release extends ReleaseValues {
  id: string;
  name: string;
  /** Outlines. */
  polygons: Point[][];
  volume_m3: number;
  from_scene: boolean;
  status: "held" | "released";
  /** Null: it has not started. */
  start_time_s: number | null;
}

/** A slot or a spillway in a barrier. */
export type BarrierOpening = BarrierOpeningValues;

/** A slot or a spillway as an action gives it. */
export type WantedBarrierOpening = Omit<BarrierOpeningValues, "sill_height_m"> & Partial<BarrierOpeningValues>;

/** A wall, a dam or a net along a line. */
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

/** A solid obstacle with vertical walls and a flat roof. */
export interface Building extends BuildingsValues {
  id: string;
  name: string;
  /** Polygons: the outer ring, then holes. */
  footprint: Point[][][];
  /** Elevation; null: it stands on no known ground. */
  base_m: number | null;
  /** Elevation; null likewise. */
  roof_m: number | null;
  from_scene: boolean;
}

/** Ground with properties of its own. Later ones go before earlier ones. */
export interface Zone extends ZoneValues {
  id: string;
  name: string;
  /** The outer ring, then holes; none: from a raster. */
  polygons: Point[][][];
  area_m2: number;
  from_scene: boolean;
}

/** Loose material on the ground that debris entrains. */
export interface Bed extends BedValues {
  id: string;
  name: string;
  /** The outer ring, then holes; none: from a raster, or everywhere. */
  polygons: Point[][][];
  area_m2: number;
  volume_m3: number;
  /** Null: it differs from place to place. */
  depth_m: number | null;
  from_scene: boolean;
  /** False: from the next restart. */
  in_force: boolean;
}

/** A row of an inflow's hydrograph, linear between rows. */
export type HydrographRow = Omit<HydrographValues, "density_kgpm3"> & Partial<HydrographValues>;

/** Debris injected during the run: to the right of a line, seen along it, or over an area. */
export interface Inflow extends InflowValues {
  id: string;
  name: string;
  /** Null: over an area. */
  line: Point[] | null;
  /** The outer ring, then holes; none: across the line. */
  polygons: Point[][][];
  /** Null: more than 200 rows. */
  hydrograph: HydrographRow[] | null;
  volume_m3: number;
  from_scene: boolean;
  /** False: from the next restart. */
  in_force: boolean;
}

/** Where depth and speed are recorded. */
export interface Gauge {
  id: string;
  name: string;
  x_m: number;
  y_m: number;
  /** Null: given as a place. */
  chainage_m: number | null;
  from_scene: boolean;
  /** False: from the next restart. */
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

/** A change of a run after its first step. */
export interface ChangeOnTheWay { time_s: number; by: string; sentence: string }

/** Parameters and objects of a scenario as they are now. */
export interface Setup {
  scenario: ScenarioName;
  /** Given by people; may be empty. */
  name: string;
  /** Grows with every change. */
  revision: number;
  /** What was changed after the first step, none again at restart: without these, the run is that of its setup from time 0. */
  changes: ChangeOnTheWay[];
  /** Values by key. */
  parameters: Record<string, number | null>;
  releases: Release[];
  barriers: Barrier[];
  buildings: Building[];
  /** Later ones go before earlier ones. */
  zones: Zone[];
  beds: Bed[];
  inflows: Inflow[];
  /** Where depth and speed are recorded. */
  gauges: Gauge[];
  /** What people have written at places; the run does not know of them. */
  notes: Note[];
  /** Beds, inflows or gauges differ from those that the run began with. */
  pending_restart: boolean;
  /** What undo would do. */
  undo: string | null;
  /** What redo would do. */
  redo: string | null;
}

/** What a structure has met. */
export interface Impact {
  id: string;
  name: string;
  hit: boolean;
  first_hit_s: number | null;
  peak_force_kN: number | null;
  peak_impact_pressure_kPa: number | null;
  /** At its walls. */
  peak_depth_m: number | null;
  peak_speed_mps: number | null;
  peak_dynamic_pressure_kPa: number | null;
  impulse_kNs: number;
  /** When its resistance was exceeded. */
  failed_s: number | null;
  /** Name of a class of the scene's guideline. */
  intensity: string | null;
}

/** What a barrier has met and done. */
export interface BarrierImpact extends Impact {
  overtopped_m3: number;
  first_overtopped_s: number | null;
  /** Through openings and meshes. */
  passed_m3: number;
  /** Debris that it retains at that time. */
  retained_m3: number;
  peak_filling_height_m: number;
}

/** An obstacle removed during the run, and its impact until then. */
export interface RemovedImpact extends Impact {
  kind: "building" | "barrier";
  removed_s: number;
  /** This and the following: of a barrier. */
  overtopped_m3?: number;
  first_overtopped_s?: number | null;
  passed_m3?: number;
  retained_m3?: number;
  peak_filling_height_m?: number;
}

/** A row per obstacle. */
export interface Impacts {
  buildings: Impact[];
  barriers: BarrierImpact[];
  /** Obstacles that were taken away while the run went on, with what they had met until then. */
  removed: RemovedImpact[];
}

/** What passed a gauge, and what is there. */
export interface GaugeReading { name: string; arrival_s: number | null; depth_m: number; speed_mps: number; peak_depth_m: number; peak_speed_mps: number }

export interface GaugeReadings {
  /** In the scene's order. */
  gauges: GaugeReading[];
}

/** The front over chainage. */
export interface FrontSeries { chainage_m: number[]; arrival_time_s: Column; front_velocity_mps: Column; particle_speed_mps: Column }

/** At most 600 rows; a column of depths per gauge of the scene. */
export interface GaugeSeries { time_s: number[]; depth_m: number[][] }

/** Time series, and the front over chainage. */
export interface Series {
  /** Columns of equal length by key: time_s, front_chainage_m, volume_..._m3, ... */
  time: Record<string, Column>;
  front: FrontSeries;
  /** At most 600 rows; a column of depths per gauge of the scene. */
  gauges: GaugeSeries;
}

/** At a point over the recording. */
export interface ProbeSeries { time_s: number[]; depth_m: Column; speed_mps: Column; pressure_kPa: Column }

/** Which moments are recorded. */
export interface Recording { times_s: number[]; bytes: number }

/** A key figure of a run, as in its report. */
export interface Figure {
  key: string;
  name: string;
  value: number | string | null;
  unit: string;
  format?: string;
  note?: string;
  /** Whether it needs attention. */
  alert?: boolean;
  kind?: string;
}

export interface Figures { figures: Figure[] }

/** A result file of the run so far. */
export interface ExportFile {
  name: string;
  /** Null: not written yet for this moment of the run. */
  bytes: number | null;
  what: string;
}

export interface ExportFiles { files: ExportFile[] }

/** What talus replay reads: the scene, and the actions with the steps before which they came. */
export type Journal = object;

export type CalibrationState = "idle" | "running" | "cancelling" | "done" | "cancelled" | "failed";

export type CalibrationPhase = "design" | "search" | "check";

/** A run of a calibration. */
export interface CalibrationRun {
  /** As parameters. */
  values: number[];
  phase: CalibrationPhase;
  /** Null: the run failed. */
  misfit: number | null;
}

/** What the best run has for an observation. */
export interface CalibratedObservation {
  name: string;
  unit: string;
  observed: number;
  /** A standard deviation. */
  uncertainty: number;
  is: "equal" | "at_least" | "below";
  /** Computed by the best run; null: nothing came there. */
  best: number | null;
  /** Of that, in standard deviations. */
  deviation: number | null;
}

/** What is varied. */
export interface CalibratedParameter { key: string; label: string; unit: string; low: number; high: number }

/** By the emulators over the first two parameters, from low to high; one row where there is one parameter. */
export interface MisfitMap {
  columns: number;
  rows: number;
  /** By rows of the second. */
  misfit: Column;
}

/** Of the runs so far. */
export interface BestRun { run: number; values: number[]; misfit: number }

/** What a calibration found. */
export interface FoundParameter {
  key: string;
  best: number;
  median: number;
  low_95: number;
  high_95: number;
  /** Of the range that it was given, 0 to 1. */
  share_of_prior_width: number;
}

/** Of a calibration that is done. */
export interface CalibrationResult {
  /** More runs would have told nothing new. */
  settled: boolean;
  checks_within_95: number | null;
  parameters: FoundParameter[];
  warnings: string[];
}

/** The calibration that runs, or the last one. */
export interface CalibrationStatus {
  state: CalibrationState;
  /** Why this scene cannot be calibrated; null: it can. */
  why_not: string | null;
  /** Who started it. */
  by: string | null;
  /** Why it failed, or what could not be written; empty. */
  message: string;
  observations: CalibratedObservation[];
  parameters: CalibratedParameter[];
  phase: CalibrationPhase | null;
  runs_at_most: number;
  runs_failed: number;
  /** Made with the depth-averaged model, which searches; as runs. */
  fast_runs: CalibrationRun[];
  /** 0: it searches without that model. */
  fast_runs_at_most: number;
  /** At most; an estimate. */
  wall_remaining_s: number | null;
  /** Of the scene's own model, in the order in which they were made. */
  runs: CalibrationRun[];
  /** Misfit over the first two parameters, by emulators, from low to high; null: none yet. */
  map: MisfitMap | null;
  best: BestRun | null;
  result: CalibrationResult | null;
}

/** Between which values a key varies. */
export interface VariedKey {
  /** Of a parameter of the scene. */
  key: string;
  low: number;
  high: number;
}

/** Body of POST /api/calibration. */
export interface WantedCalibration {
  parameters: VariedKey[];
  /** At most so many, 8 to 2000 with two parameters; default: 100. With search_with 3 to 2000, default: 10. */
  runs?: number;
  /** A faster model for most of the search, with at most 100 runs; runs are then those of particles. */
  search_with?: "depth_averaged" | null;
}

/** What a run has a map of. */
export const layerNames = ["depth", "peak_depth", "peak_speed", "peak_pressure", "arrival_time", "deposit_depth", "erosion_depth"] as const;
export type LayerName = (typeof layerNames)[number];

/** What the depth-averaged model has a map of. */
export const quantityNames = ["depth", "peak_depth", "peak_speed", "peak_pressure", "arrival_time", "deposit_depth"] as const;
export type QuantityName = (typeof quantityNames)[number];

/** A map of a finished ensemble. */
export interface EnsembleMap {
  name: string;
  title: string;
  /** Of the grid's values. */
  unit: string;
  kind: "probability" | "percentile" | "zones";
  /** The map of a single run that it counts. */
  of: "peak_depth" | "peak_speed" | "peak_pressure" | "arrival_time" | "deposit_depth" | "intensity";
  /** Of the values. */
  description: string;
  /** Of a probability of depth, speed or pressure. */
  threshold: number | null;
  threshold_unit: string | null;
  /** In %. */
  percentile: number | null;
  /** Of zones: names and colours of the values 1, 2, ... */
  categories: Category[];
  /** Null: nowhere in any run. */
  greatest: number | null;
}

/** What an ensemble varied. */
export interface EnsembleFactor {
  key: string;
  /** For people: uniform from 0.2 to 0.5. */
  distribution: string;
}

/** A finished ensemble of this scene whose maps can be shown. */
export interface Ensemble {
  id: string;
  /** Of its folder. */
  name: string;
  /** Complete ones, which the maps count. */
  runs: number;
  failed: number;
  factors: EnsembleFactor[];
  /** Whether it was computed on this scene's terrain file. */
  same_terrain: boolean;
  maps: EnsembleMap[];
}

export interface Ensembles { ensembles: Ensemble[] }

/** Columns of equal length. */
export interface DepthAveragedFront { chainage_m: Column; arrival_time_s: Column; front_velocity_mps: Column }

/** Of the present setup, from time 0 to its end. */
export interface DepthAveragedResult {
  /** Time at which it ended, s. */
  end_s: number;
  /** False: it ended before debris rested or the scene's end time; see stop_reason. */
  complete: boolean;
  stop_reason: string;
  verdict: Verdict;
  /** Of its steps. */
  wall_time_s: number;
  /** Of all of it. */
  processor_time_s: number;
  grid_cell_m: number;
  /** As talus run --model depth_averaged has it for the same setup. */
  hash: string;
  /** What the model leaves out. */
  notes: string[];
  front: DepthAveragedFront;
}

/** The depth-averaged model of the present setup of a scenario. Nothing of it is recorded. */
export interface DepthAveragedStatus {
  scenario: ScenarioName;
  /** Refused: the model does not have something of the setup, which message names. */
  state: "off" | "waiting" | "running" | "done" | "refused" | "failed";
  /** Why it was refused or failed; empty. */
  message: string;
  /** Of the time, while it runs, 0 to 1. */
  share: number | null;
  /** Of the present setup from time 0; null: there is none yet. A change of the setup discards it. */
  result: DepthAveragedResult | null;
}

/** A quantity of both models: particles so far, the other model by the same time and at its end. */
export interface DepthAveragedRow {
  key: "front_velocity" | "front_arrival" | "front_chainage" | "run_out" | "affected_area" | "peak_depth" | "peak_speed" | "peak_pressure";
  name: string;
  unit: string;
  decimals: number;
  /** So far. */
  particles: number | null;
  /** By the time of the particles, or as a whole if their run is over; null: not known or not reached. */
  depth_averaged_by_then: number | null;
  /** Of the whole run. */
  depth_averaged: number | null;
  observed: number | null;
}

/** Ground covered by then. */
export interface AffectedArea {
  both_m2: number;
  particles_only_m2: number;
  depth_averaged_only_m2: number;
  /** Null: neither covers any. */
  intersection_over_union: number | null;
}

/** The run so far beside the depth-averaged model. */
export interface DepthAveragedComparison {
  /** Of the particles. */
  time_s: number;
  /** The particles' run is over: both are compared as a whole. */
  over: boolean;
  rows: DepthAveragedRow[];
  /** Ground covered deeper than this is affected. */
  least_depth_m: number;
  /** Affected by then. */
  area: AffectedArea;
  /** How the setups of both differ. */
  differs: string[];
}

/** Body of POST /api/depth_averaged. */
export interface WantedDepthAveraged { on: boolean }

/** Body of POST /api/scenarios. */
export interface WantedCopy {
  /** Name of a scenario. */
  copy_of: string;
  /** Applied to the new one first. */
  action?: Action;
}

/** Values of a trigger's message, by key with its unit. */
export interface TriggerValues { volume_m3?: number; pore_pressure_ratio?: number; discharge_m3ps?: number }

/** Body of POST /api/trigger. */
export interface TriggerMessage {
  /** Name of a trigger of the scene. */
  trigger: string;
  values?: TriggerValues;
  /** When it was measured, UTC, such as 2026-11-24T14:03:00Z; default: now. */
  time?: string;
  /** Shown to everybody, up to 200 bytes. */
  reason?: string;
}

/** What came of a trigger's message. */
export interface TriggerAnswer {
  /** What has happened, for people. */
  done: string;
  scenario: ScenarioName | null;
  started: boolean;
}

/** The last value of a trigger's gauge. */
export interface GaugeValue { discharge_m3ps: number; received_at: string }

/** A run that a trigger started; times of day are UTC. */
export interface TriggeredRun {
  scenario: ScenarioName;
  trigger: string;
  source: "HTTP" | "MQTT" | "";
  received_at: string;
  reason: string;
  values: TriggerValues;
  reading: GaugeValue | null;
}

/** An alarm that a run raised. */
export interface RaisedAlarm {
  scenario: ScenarioName;
  alarm: string;
  sentence: string;
  message: string;
  time_s: number;
  expected_s: number | null;
  step: number;
  /** Of the state after that step. */
  hash: string;
  /** Null in a run that was opened from a saved session. */
  raised_at: string | null;
  /** What came of sending it; empty: nobody to send it to. */
  delivery: string;
}

/** A trigger of the scene. */
export interface Trigger {
  name: string;
  /** Largest values. */
  limits: TriggerValues;
}

/** What came of a message. */
export interface AlertNote { at: string; sentence: string }

/** Where messages of triggers can come from. */
export interface Listening {
  http: boolean;
  /** Of the connection to the broker; null: none. */
  mqtt: string | null;
}

/** Runs that triggers started, alarms that runs raised, and what came of messages. */
export interface Alerts {
  /** Where messages of triggers can come from. */
  listening: Listening;
  triggers: Trigger[];
  runs: TriggeredRun[];
  alarms: RaisedAlarm[];
  /** The last 20: runs started, messages refused, what was not delivered. */
  notes: AlertNote[];
}

/** How other computers reach the server. */
export interface SharedLink { host: string; encrypted: boolean; viewer_url: string; controller_url: string }

/** Whether other computers reach the server, and by which addresses they could. */
export interface Share {
  shared: SharedLink | null;
  /** Of this computer. */
  addresses: string[];
}

/** Body of POST /api/share. */
export interface WantedShare {
  /** One of this computer. */
  address: string;
  /** 0 or absent: any that is free. */
  port?: number;
  /** Under which browsers reach it; absent: the address. */
  name?: string;
  /** PEM, with its chain. */
  certificate?: string;
  /** PEM, without a password; kept in memory only. */
  key?: string;
}

/** With the id of an existing object, only what changes needs to be given. */
export type Action =
  | { action: "run" | "pause" | "step"; scenarios?: ScenarioName[] }
  | { action: "restart"; scenarios?: ScenarioName[] }
  | { action: "cancel" }
  | { action: "name_scenario"; name: string }
  | { action: "set_speed"; factor: number | null }
  | { action: "set_parameter"; key: string; value: number | null }
  | { action: "set_parameters"; values: Record<string, number | null> }
  | ({ action: "put_release"; id?: string; name?: string; polygon?: Point[]; move_m?: Point } & Partial<ReleaseValues>)
  | { action: "remove_release"; id: string }
  | { action: "trigger_release"; id: string }
  | ({ action: "put_barrier"; id?: string; name?: string; line?: Point[]; openings?: WantedBarrierOpening[] } & Partial<BarrierValues>)
  | ({ action: "put_building"; id?: string; name?: string; footprint?: Point[]; move_m?: Point } & Partial<BuildingsValues>)
  | ({ action: "put_zone"; id?: string; name?: string; polygon?: Point[]; move_m?: Point } & Partial<ZoneValues>)
  | { action: "remove_barrier" | "remove_building" | "remove_zone"; id: string }
  | ({ action: "put_bed"; id?: string; name?: string; polygon?: Point[]; move_m?: Point } & Partial<BedValues>)
  | ({ action: "put_inflow"; id?: string; name?: string; line?: Point[]; polygon?: Point[]; move_m?: Point; hydrograph?: HydrographRow[] } & Partial<InflowValues>)
  | { action: "put_gauge"; id?: string; name?: string; x_m?: number; y_m?: number; chainage_m?: number }
  | { action: "remove_bed" | "remove_inflow" | "remove_gauge"; id: string }
  | { action: "put_note"; id?: string; name?: string; x_m?: number; y_m?: number }
  | { action: "remove_note"; id: string }
  | { action: "undo" | "redo" };

/** What the server sends over the WebSocket, besides frames. */
export type ServerMessage =
  | { type: "hello"; protocol: number; you: You; session: Session }
  | ({ type: "state" } & State)
  | ({ type: "setup" } & Setup)
  | { type: "people"; people: Person[]; controller: string | null; request: ControlRequest | null }
  | ({ type: "calibration" } & CalibrationStatus)
  | ({ type: "alerts" } & Alerts)
  | ({ type: "depth_averaged" } & DepthAveragedStatus)
  | { type: "scenarios"; scenarios: ScenarioName[] }
  | { type: "ended" }
  | { type: "done"; scenario: ScenarioName; by: string; done: string };

/** What a page sends over the WebSocket. */
export type PageMessage =
  | { type: "view"; scenarios: ScenarioName[]; rate_hz: number; particle_cap: number }
  | { type: "mark"; at: Place | null }
  | { type: "name"; name: string };
