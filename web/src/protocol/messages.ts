// Made from src/messages/protocol.json: edit that; docs/protocol.md tells how this is made again.
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
  /** Of this person, while connected. */
  id: string;
  /** As the person gave it. */
  name: string;
  /** What the token entitles to. */
  role: Role;
  /** Of the person's mark, as #rrggbb. */
  colour: string;
  /** Local position that the person points at, m. */
  mark: Place | null;
}

/** The person of a page itself. */
export interface You {
  /** Of this person, while connected. */
  id: string;
  /** As the server has it. */
  name: string;
  /** What the token entitles to. */
  role: Role;
  /** Of the person's mark, as #rrggbb. */
  colour: string;
  /** What this page shows with its requests, so that nobody can act in its name. */
  secret: string;
}

/** Who asks for control. */
export interface ControlRequest {
  /** Of the person. */
  id: string;
  /** Of the person. */
  name: string;
}

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
  /** Those that there are. */
  scenarios: ScenarioName[];
  /** Those who have the page open. */
  people: Person[];
  /** Id of who has control. */
  controller: string | null;
  /** Who asks for control. */
  request: ControlRequest | null;
  /** Tokens of the links to share, as far as the own token entitles to them. */
  links: { viewer?: string; controller?: string };
}

/** Body of POST /api/control. */
export interface WantedControl {
  /** Ask for it, give it up, grant a request or decline it. */
  do: "request" | "release" | "grant" | "decline";
  /** From the WebSocket's hello; default: the header's. */
  secret?: string;
}

/** null: no bound. */
export interface ParameterRange {
  /** Lowest value. */
  low: number | null;
  /** Highest value. */
  high: number | null;
  /** The lowest value itself is allowed. */
  low_included: boolean;
  /** The highest value itself is allowed. */
  high_included: boolean;
}

/** A live parameter, from the declaration that also makes the scene file's reference. */
export interface Parameter {
  /** Such as material.friction_coefficient. */
  key: string;
  /** For people. */
  label: string;
  /** Empty: a pure number. */
  unit: string;
  /** In this scene. */
  default: number | null;
  /** Now. */
  value: number | null;
  /** Of allowed values in this scene. */
  range: ParameterRange;
  /** What it is, one sentence. */
  help: string;
  /** Whether the depth-averaged model has a use for it. */
  used_by_depth_averaged: boolean;
}

/** What people add to the tables of the scene. */
export type TableKind = "observation" | "trigger" | "alarm";

/** Of a key; null: none. */
export type TableValue = number | string | boolean | null;

/** A key of a section of the scene file. */
export interface TableKey {
  /** With its unit. */
  key: string;
  /** For people. */
  label: string;
  /** Empty: none. */
  unit: string;
  /** Of its value. */
  is: "number" | "text" | "boolean";
  /** There must be a value. */
  required: boolean;
  /** Of a new entry. */
  default: TableValue;
  /** What no value means. */
  absent: string;
  /** The range of a number. */
  allowed: string;
  /** One sentence. */
  help: string;
}

/** A section of the scene file to which entries are added. */
export interface TableSection {
  /** Its name there. */
  section: string;
  /** What an entry is. */
  kind: TableKind;
  /** For people. */
  help: string;
  /** In the order of the scene file. */
  keys: TableKey[];
  /** Keys of which exactly one must have a value. */
  one_of: string[][];
}

/** The line along which the front is measured. */
export interface FlowPath {
  /** From top to bottom. */
  points: Place[];
  /** At each of the points. */
  chainage_m: number[];
  /** Debris within it counts for the front. */
  corridor_width_m: number;
  /** Traced down the terrain; false: from a file. */
  traced: boolean;
}

/** A gauge of the scene file. */
export interface GaugePlace {
  /** For people. */
  name: string;
  /** East. */
  x_m: number;
  /** North. */
  y_m: number;
  /** Null: given as a place. */
  chainage_m: number | null;
}

/** A cross-section of the scene file. */
export interface SectionPlace {
  /** For people. */
  name: string;
  /** What passes from its left to its right counts as positive. */
  line: Point[];
}

/** A value of a map of classes. */
export interface Category {
  /** For people. */
  name: string;
  /** As #rrggbb. */
  colour: string;
}

/** A class of a guideline. */
export interface IntensityClass extends Category {
  /** For people. */
  criterion: string;
}

/** Grid of depth windows, and of layers except erosion_depth. */
export interface MapGrid {
  /** West edge. */
  x_min_m: number;
  /** South edge. */
  y_min_m: number;
  /** Edge of a cell. */
  cell_m: number;
  /** From west to east. */
  columns: number;
  /** From south to north. */
  rows: number;
}

/** By which structures are classed. */
export interface IntensityGuideline {
  /** Name of that of outputs.intensity_guideline. */
  guideline: string;
  /** From low to high. */
  classes: IntensityClass[];
  /** One sentence. */
  rule: string;
  /** The publication. */
  source: string;
}

/** What does not change during a session. */
export interface SceneInfo {
  /** Of the scene. */
  title: string;
  /** Of the scene file. */
  description: string;
  /** Whether it reconstructs an event, as the scene says. */
  reconstruction: boolean;
  /** Sentences of the scene file. */
  assumptions: string[];
  /** Publications, of the scene file. */
  sources: string[];
  /** Reference system, such as EPSG:2326. */
  crs: string;
  /** Name of the reference system. */
  crs_name: string;
  /** Of the terrain file's elevations. */
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
  /** Between neighbouring particles at rest. */
  particle_spacing_m: number;
  /** At which a run ends at the latest. */
  end_time_s: number;
  /** Of the solver. */
  gravity_mps2: number;
  /** Along which the front is measured; null: there is none. */
  flow_path: FlowPath | null;
  /** Kinds of observations, then triggers and alarms. */
  table_sections: TableSection[];
  /** As the scene file has them. */
  gauges: GaugePlace[];
  /** As the scene file has them. */
  cross_sections: SectionPlace[];
  /** The live ones. */
  parameters: Parameter[];
  /** Keys of the scene that others need, such as solver.internal_friction, with their values. */
  settings: Record<string, string>;
  /** The scene's guideline. */
  intensity: IntensityGuideline;
}

/** Of a scenario. fault: the step could not be trusted. */
export type Status = "paused" | "running" | "at_rest" | "ended" | "fault";

/** A number of a run against its limit. */
export interface Check {
  /** Which number. */
  key: "resolution" | "compression" | "energy" | "still_moving" | "convergence";
  /** For people. */
  name: string;
  /** Of the number against its limit. */
  state: "within" | "beyond" | "not_measured";
  /** Null: not measured. */
  value: number | null;
  /** Null: there is none. */
  limit: number | null;
  /** Of value and limit. */
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
  /** All of them. */
  checks: Check[];
}

/** A change that is being prepared, or what is being opened. */
export interface Preparation {
  /** For people. */
  what: string;
  /** That is done, 0 to 1. */
  share: number;
}

/** What is recorded; null: nothing yet. */
export interface RecordingExtent {
  /** Time of the first frame. */
  first_s: number | null;
  /** Time of the last frame. */
  last_s: number | null;
  /** Number of frames. */
  frames: number;
  /** Of memory. */
  bytes: number;
}

/** Status, time and mass balance of a run. */
export interface RunState {
  /** Whether it runs. */
  status: Status;
  /** One sentence, or empty. */
  message: string;
  /** Simulated. */
  time_s: number;
  /** Of the scene. */
  end_time_s: number;
  /** When the run is expected to be over, from the motion of its debris; null before the first step and while debris outlasts the estimate. */
  expected_end_s: number | null;
  /** Wall time until then as fast as it goes; null likewise, and below 1 % done. */
  wall_remaining_s: number | null;
  /** Steps taken. */
  step: number;
  /** In the run now. */
  particles: number;
  /** With what has flowed in. */
  volume_released_m3: number;
  /** Entrained from the bed. */
  volume_entrained_m3: number;
  /** Whether the layer pore_pressure_ratio has values. */
  pore_pressure: boolean;
  /** Not started yet. */
  volume_held_m3: number;
  /** Moving now. */
  volume_moving_m3: number;
  /** At rest. */
  volume_deposited_m3: number;
  /** Beyond the edge of the terrain. */
  volume_left_m3: number;
  /** How far the front has come; null: there is none. */
  front_chainage_m: number | null;
  /** Null: it does not advance. */
  front_velocity_mps: number | null;
  /** Of the particles now. */
  largest_speed_mps: number | null;
  /** The largest so far. */
  peak_speed_mps: number | null;
  /** Mean of max(0, density / rest density - 1). */
  mean_compression: number | null;
  /** Largest of the same. */
  max_compression: number | null;
  /** Of the particles. */
  overcompressed_share: number | null;
  /** Null before the first step. */
  too_compressed: boolean | null;
  /** Whether the run so far can be relied on, as of a moment ago; null before the first step. */
  verdict: Verdict | null;
  /** What is recorded. */
  recording: RecordingExtent;
  /** Of time and particles; while not running. */
  hash?: string;
}

/** The run of a scenario, and what its session does with it. */
export interface State extends RunState {
  /** Its name. */
  scenario: ScenarioName;
  /** Simulated seconds per second that are wanted; null: as fast as it goes. */
  speed_factor: number | null;
  /** Simulated seconds per second of late. */
  real_time_factor: number;
  /** Wall time. */
  steps_per_second: number;
  /** A change that is being prepared, and the share of it that is done. */
  preparing: Preparation | null;
}

/** Debris that starts to move at one moment. */
export interface Release extends ReleaseValues {
  /** Of this object, as actions name it. */
  id: string;
  /** For people. */
  name: string;
  /** The outer ring, then holes. */
  polygons: Point[][][];
  /** Of each polygon. */
  thicknesses_m: number[];
  /** True: the thickness is that of a raster. */
  raster?: boolean;
  /** Of all its patches. */
  volume_m3: number;
  /** It is of the scene file; false: somebody made it here. */
  from_scene: boolean;
  /** Released: it has started, or its trigger has been pulled. */
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
  /** Of this object, as actions name it. */
  id: string;
  /** For people. */
  name: string;
  /** The places that it runs through. */
  line: Point[];
  /** The mean of a level crest. */
  height_m: number;
  /** Along its line. */
  openings: BarrierOpening[];
  /** Along its line. */
  crest_length_m: number;
  /** It is of the scene file; false: somebody made it here. */
  from_scene: boolean;
}

/** A solid obstacle with vertical walls and a flat roof. */
export interface Building extends BuildingsValues {
  /** Of this object, as actions name it. */
  id: string;
  /** For people. */
  name: string;
  /** The outer ring, then holes. */
  polygons: Point[][][];
  /** Elevation; null: it stands on no known ground. */
  base_m: number | null;
  /** Elevation; null likewise. */
  roof_m: number | null;
  /** It is of the scene file; false: somebody made it here. */
  from_scene: boolean;
}

/** Ground with properties of its own. Later ones go before earlier ones. */
export interface Zone extends ZoneValues {
  /** Of this object, as actions name it. */
  id: string;
  /** For people. */
  name: string;
  /** The outer ring, then holes; none: from a raster. */
  polygons: Point[][][];
  /** Inside the outlines. */
  area_m2: number;
  /** It is of the scene file; false: somebody made it here. */
  from_scene: boolean;
  /** Where the stems of a zone from a raster are: west, south, width and height of rectangles, m. */
  blocks?: number[][];
}

/** Loose material on the ground that debris entrains. */
export interface Bed extends BedValues {
  /** Of this object, as actions name it. */
  id: string;
  /** For people. */
  name: string;
  /** The outer ring, then holes; none: from a raster, or everywhere. */
  polygons: Point[][][];
  /** That it covers. */
  area_m2: number;
  /** Of each polygon. */
  depths_m: number[];
  /** True: the depth is that of a raster. */
  raster?: boolean;
  /** That debris could entrain at most. */
  volume_m3: number;
  /** Null: it differs from place to place. */
  depth_m: number | null;
  /** It is of the scene file; false: somebody made it here. */
  from_scene: boolean;
  /** False: from the next restart. */
  in_force: boolean;
}

/** A row of an inflow's hydrograph, linear between rows. */
export type HydrographRow = Omit<HydrographValues, "density_kgpm3"> & Partial<HydrographValues>;

/** Debris injected during the run: to the right of a line, seen along it, or over an area. */
export interface Inflow extends InflowValues {
  /** Of this object, as actions name it. */
  id: string;
  /** For people. */
  name: string;
  /** Null: over an area. */
  line: Point[] | null;
  /** The outer ring, then holes; none: across the line. */
  polygons: Point[][][];
  /** Null: more than 200 rows. */
  hydrograph: HydrographRow[] | null;
  /** Of the whole hydrograph. */
  volume_m3: number;
  /** It is of the scene file; false: somebody made it here. */
  from_scene: boolean;
  /** False: from the next restart. */
  in_force: boolean;
}

/** Where depth and speed are recorded. */
export interface Gauge extends GaugePlace {
  /** Of this object, as actions name it. */
  id: string;
  /** It is of the scene file; false: somebody made it here. */
  from_scene: boolean;
  /** False: from the next restart. */
  in_force: boolean;
}

/** A text that people have pinned to a place; it does not affect the run. */
export interface Note {
  /** Of this object, as actions name it. */
  id: string;
  /** The text. */
  name: string;
  /** East. */
  x_m: number;
  /** North. */
  y_m: number;
}

/** An observation, a trigger or an alarm; no step of the run knows it. */
export interface TableEntry {
  /** Of this object, as actions name it. */
  id: string;
  /** Of the scene file. */
  section: string;
  /** For people. */
  name: string;
  /** By key of the section. */
  values: Record<string, TableValue>;
  /** It is of the scene file; false: somebody made it here. */
  from_scene: boolean;
}

/** A change of a run after its first step. */
export interface ChangeOnTheWay {
  /** Simulated. */
  time_s: number;
  /** Name of who made it. */
  by: string;
  /** What was done. */
  sentence: string;
}

/** Parameters and objects of a scenario as they are now. */
export interface Setup {
  /** Its name. */
  scenario: ScenarioName;
  /** Given by people; may be empty. */
  name: string;
  /** Grows with every change. */
  revision: number;
  /** What was changed after the first step, none again at restart: without these, the run is that of its setup from time 0. */
  changes: ChangeOnTheWay[];
  /** Values by key. */
  parameters: Record<string, number | null>;
  /** Debris that starts at one moment. */
  releases: Release[];
  /** Walls, dams and nets. */
  barriers: Barrier[];
  /** Solid obstacles. */
  buildings: Building[];
  /** Later ones go before earlier ones. */
  zones: Zone[];
  /** Ground that debris entrains. */
  beds: Bed[];
  /** Debris that comes during the run. */
  inflows: Inflow[];
  /** Where depth and speed are recorded. */
  gauges: Gauge[];
  /** What people have written at places; the run does not know of them. */
  notes: Note[];
  /** Of the field. */
  observations: TableEntry[];
  /** Those of scenario A can start runs. */
  triggers: TableEntry[];
  /** For which this run is watched. */
  alarms: TableEntry[];
  /** Beds, inflows or gauges differ from those that the run began with. */
  pending_restart: boolean;
  /** What undo would do. */
  undo: string | null;
  /** What redo would do. */
  redo: string | null;
}

/** What a structure has met. */
export interface Impact {
  /** Of the structure. */
  id: string;
  /** Of the structure. */
  name: string;
  /** Debris has touched it. */
  hit: boolean;
  /** Null: it was not hit. */
  first_hit_s: number | null;
  /** Largest filtered force. */
  peak_force_kN: number | null;
  /** Largest on a patch of its walls. */
  peak_impact_pressure_kPa: number | null;
  /** At its walls. */
  peak_depth_m: number | null;
  /** Depth-averaged, at its walls. */
  peak_speed_mps: number | null;
  /** Density times square of the speed towards its walls. */
  peak_dynamic_pressure_kPa: number | null;
  /** Force over time. */
  impulse_kNs: number;
  /** When its resistance was exceeded. */
  failed_s: number | null;
  /** Name of a class of the scene's guideline. */
  intensity: string | null;
}

/** What a barrier has met and done. */
export interface BarrierImpact extends Impact {
  /** Debris that went over it. */
  overtopped_m3: number;
  /** Null: nothing went over it. */
  first_overtopped_s: number | null;
  /** Through openings and meshes. */
  passed_m3: number;
  /** Debris that it retains at that time. */
  retained_m3: number;
  /** Largest height of debris behind it. */
  peak_filling_height_m: number;
}

/** An obstacle removed during the run, and its impact until then. */
export interface RemovedImpact extends Impact {
  /** What it was. */
  kind: "building" | "barrier";
  /** When it was taken away. */
  removed_s: number;
  /** This and the following: of a barrier. */
  overtopped_m3?: number;
  /** Null: nothing went over it. */
  first_overtopped_s?: number | null;
  /** Through openings and meshes. */
  passed_m3?: number;
  /** Debris that it retained last. */
  retained_m3?: number;
  /** Largest height of debris behind it. */
  peak_filling_height_m?: number;
}

/** A row per obstacle. */
export interface Impacts {
  /** In the order of the setup. */
  buildings: Impact[];
  /** In the order of the setup. */
  barriers: BarrierImpact[];
  /** Obstacles that were taken away while the run went on, with what they had met until then. */
  removed: RemovedImpact[];
}

/** What passed a gauge, and what is there. */
export interface GaugeReading {
  /** Of the gauge. */
  name: string;
  /** When debris came; null: none has. */
  arrival_s: number | null;
  /** There. */
  depth_m: number;
  /** There. */
  speed_mps: number;
  /** So far. */
  peak_depth_m: number;
  /** So far. */
  peak_speed_mps: number;
}

/** What passes a cross-section. */
export interface SectionReading {
  /** Of the cross-section. */
  name: string;
  /** Mean over the last interval. */
  discharge_m3ps: number;
  /** The greatest so far, in either direction. */
  peak_discharge_m3ps: number;
  /** So far, less what came back. */
  passed_m3: number;
}

export interface GaugeReadings {
  /** In the scene's order. */
  gauges: GaugeReading[];
  /** In the scene's order. */
  cross_sections: SectionReading[];
}

/** A field observation beside the run. */
export interface ObservedRow {
  /** Of the observation in the setup; null: one that names a file. */
  id: string | null;
  /** For people. */
  name: string;
  /** Empty: none. */
  unit: string;
  /** Its value; of damage: the limit. */
  observed: number;
  /** Standard deviation. */
  uncertainty: number;
  /** What the computed value should be to the observed one. */
  is: "equal" | "at_least" | "below";
  /** Null: debris has not come there. */
  computed: number | null;
  /** In standard deviations; 0: on the right side of a limit. */
  deviation: number | null;
}

export interface Observed {
  /** Of the run. */
  time_s: number;
  /** In the order of the scene file's sections. */
  rows: ObservedRow[];
}

/** The front over chainage. */
export interface FrontSeries {
  /** Along the flow path. */
  chainage_m: number[];
  /** Of the front. */
  arrival_time_s: Column;
  /** There. */
  front_velocity_mps: Column;
  /** Of the debris at the front. */
  particle_speed_mps: Column;
}

/** At most 600 rows; a column of depths per gauge of the scene. */
export interface GaugeSeries {
  /** A row each. */
  time_s: number[];
  /** A column per gauge. */
  depth_m: number[][];
}

/** Time series, and the front over chainage. */
export interface Series {
  /** Columns of equal length by key: time_s, front_chainage_m, volume_..._m3, ... */
  time: Record<string, Column>;
  /** Over chainage. */
  front: FrontSeries;
  /** At most 600 rows; a column of depths per gauge of the scene. */
  gauges: GaugeSeries;
}

/** At a point over the recording. */
export interface ProbeSeries {
  /** Of the recorded frames. */
  time_s: number[];
  /** Of the flow. */
  depth_m: Column;
  /** Depth-averaged. */
  speed_mps: Column;
  /** Dynamic: density times square of the speed. */
  pressure_kPa: Column;
  /** Of the debris; null: none is known there. */
  pore_pressure_ratio: Column;
}

/** Which frames are recorded. */
export interface Recording {
  /** Of its frames. */
  times_s: number[];
  /** Of memory. */
  bytes: number;
}

/** A key figure of a run, as in its report. */
export interface Figure {
  /** Of results.json. */
  key: string;
  /** For people. */
  name: string;
  /** A number or a text; null: there is none. */
  value: number | string | null;
  /** Of a number. */
  unit: string;
  /** How reports write the number. */
  format?: string;
  /** What to know of it. */
  note?: string;
  /** Whether it needs attention. */
  alert?: boolean;
  /** As in results.json. */
  kind?: string;
}

export interface Figures {
  /** In the order of the report. */
  figures: Figure[];
}

/** A result file of the run so far. */
export interface ExportFile {
  /** Of the file. */
  name: string;
  /** Null: not written yet for this moment of the run. */
  bytes: number | null;
  /** For people. */
  what: string;
}

export interface ExportFiles {
  /** Those that there can be. */
  files: ExportFile[];
}

/** A format of outputs.series that is made of the recording. */
export type FlowFormat = "gltf" | "3dtiles" | "geotiff" | "netcdf";

/** A format of the moving flow. */
export interface FlowFormatOffer {
  /** As in outputs.series. */
  name: FlowFormat;
  /** For people. */
  what: string;
  /** Their names. */
  files: string[];
  /** In the files; an animation has 100 at most. */
  frames: number;
  /** About how large the files are together. */
  bytes: number;
  /** Why this run cannot have it. */
  refused: string | null;
}

/** What files of the moving flow would contain. */
export interface FlowOffer {
  /** Its name. */
  scenario: ScenarioName;
  /** The first moment. */
  from_s: number;
  /** The last moment, which is now. */
  to_s: number;
  /** Of the recording, at this interval. */
  frames: number;
  /** Simulated time between them. */
  interval_s: number;
  /** That of the recording. */
  shortest_interval_s: number;
  /** All there are. */
  formats: FlowFormatOffer[];
}

/** Body of POST /api/scenarios/{s}/flow. */
export interface WantedFlow {
  /** At least one. */
  formats: FlowFormat[];
  /** Simulated time between frames, 0.001 to 1e7; default: outputs.series_interval_s of the scene. */
  interval_s?: number;
}

/** A file of the moving flow. */
export interface FlowFile {
  /** Of the file. */
  name: string;
  /** Its size. */
  bytes: number;
}

/** Files of the moving flow: how far they are. */
export interface FlowExport {
  state: "idle" | "running" | "cancelling" | "done" | "cancelled" | "failed";
  /** Whose flow; null: none yet. */
  scenario: ScenarioName | null;
  /** That is written, 0 to 1, while it runs. */
  share: number | null;
  /** Why it failed; empty. */
  message: string;
  /** Once it is done. */
  files: FlowFile[];
}

/** What talus replay reads: the scene, and the actions with the steps before which they came. */
export type Journal = object;

export type CalibrationState = "idle" | "running" | "cancelling" | "done" | "cancelled" | "failed";

export type CalibrationPhase = "design" | "search" | "check";

/** A run of a calibration. */
export interface CalibrationRun {
  /** As parameters. */
  values: number[];
  /** For which it was made. */
  phase: CalibrationPhase;
  /** Null: the run failed. */
  misfit: number | null;
}

/** What the best run has for an observation. */
export interface CalibratedObservation {
  /** Of the observation. */
  name: string;
  /** Of the values. */
  unit: string;
  /** In the field. */
  observed: number;
  /** A standard deviation. */
  uncertainty: number;
  /** Of the computed value against the observed one. */
  is: "equal" | "at_least" | "below";
  /** Computed by the best run; null: nothing came there. */
  best: number | null;
  /** Of that, in standard deviations. */
  deviation: number | null;
}

/** What is varied. */
export interface CalibratedParameter {
  /** Of the parameter. */
  key: string;
  /** For people. */
  label: string;
  /** Of the values. */
  unit: string;
  /** Least value. */
  low: number;
  /** Greatest value. */
  high: number;
}

/** By the emulators over the first two parameters, from low to high; one row where there is one parameter. */
export interface MisfitMap {
  /** Values of the first parameter. */
  columns: number;
  /** Values of the second. */
  rows: number;
  /** By rows of the second. */
  misfit: Column;
}

/** Of the runs so far. */
export interface BestRun {
  /** Its number. */
  run: number;
  /** As parameters. */
  values: number[];
  /** Its misfit. */
  misfit: number;
}

/** What a calibration found. */
export interface FoundParameter {
  /** Of the parameter. */
  key: string;
  /** Value of the best run. */
  best: number;
  /** Of the posterior. */
  median: number;
  /** Low end of the 95 % interval. */
  low_95: number;
  /** High end of the 95 % interval. */
  high_95: number;
  /** Of the range that it was given, 0 to 1. */
  share_of_prior_width: number;
}

/** Of a calibration that is done. */
export interface CalibrationResult {
  /** More runs would have told nothing new. */
  settled: boolean;
  /** Share of the check runs within the 95 % interval of the emulators; null: there were none. */
  checks_within_95: number | null;
  /** As varied. */
  parameters: FoundParameter[];
  /** Limitations, a sentence each. */
  warnings: string[];
}

/** The calibration that runs, or the last one. */
export interface CalibrationStatus {
  /** Idle: none has been started. */
  state: CalibrationState;
  /** Why this scene cannot be calibrated; null: it can. */
  why_not: string | null;
  /** Who started it. */
  by: string | null;
  /** Why it failed, or what could not be written; empty. */
  message: string;
  /** That it fits. */
  observations: CalibratedObservation[];
  /** That are varied. */
  parameters: CalibratedParameter[];
  /** Null: it does not run. */
  phase: CalibrationPhase | null;
  /** Of the scene's own model. */
  runs_at_most: number;
  /** So far. */
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
  /** Of the runs so far; null: none has a misfit. */
  best: BestRun | null;
  /** Null: it is not done. */
  result: CalibrationResult | null;
}

/** Between which values a key varies. */
export interface VariedKey {
  /** Of a parameter of the scene. */
  key: string;
  /** Least value. */
  low: number;
  /** Greatest value. */
  high: number;
}

/** Body of POST /api/calibration. */
export interface WantedCalibration {
  /** What varies. */
  parameters: VariedKey[];
  /** At most so many, 8 to 2000 with two parameters; default: 100. With search_with 3 to 2000, default: 10. */
  runs?: number;
  /** A faster model for most of the search, with at most 100 runs; runs are then those of particles. */
  search_with?: "depth_averaged" | null;
}

/** What a run has a map of. */
export const layerNames = ["depth", "peak_depth", "peak_speed", "peak_pressure", "arrival_time", "deposit_depth", "pore_pressure_ratio", "erosion_depth"] as const;
export type LayerName = (typeof layerNames)[number];

/** What the depth-averaged model has a map of. */
export const quantityNames = ["depth", "peak_depth", "peak_speed", "peak_pressure", "arrival_time", "deposit_depth"] as const;
export type QuantityName = (typeof quantityNames)[number];

/** A map of a finished ensemble. */
export interface EnsembleMap {
  /** Of the map, in its route. */
  name: string;
  /** For people. */
  title: string;
  /** Of the grid's values. */
  unit: string;
  /** What it shows of the runs. */
  kind: "probability" | "percentile" | "zones";
  /** The map of a single run that it counts. */
  of: "peak_depth" | "peak_speed" | "peak_pressure" | "arrival_time" | "deposit_depth" | "intensity";
  /** Of the values. */
  description: string;
  /** Of a probability of depth, speed or pressure. */
  threshold: number | null;
  /** Null likewise. */
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
  /** Of the scene file. */
  key: string;
  /** For people: uniform from 0.2 to 0.5. */
  distribution: string;
}

/** A finished ensemble of this scene whose maps can be shown. */
export interface Ensemble {
  /** In routes. */
  id: string;
  /** Of its folder. */
  name: string;
  /** Complete ones, which the maps count. */
  runs: number;
  /** Runs that failed. */
  failed: number;
  /** What varied. */
  factors: EnsembleFactor[];
  /** Whether it was computed on this scene's terrain file. */
  same_terrain: boolean;
  /** That can be shown. */
  maps: EnsembleMap[];
}

export interface Ensembles {
  /** In the order in which they were given. */
  ensembles: Ensemble[];
}

/** Columns of equal length. */
export interface DepthAveragedFront {
  /** Along the flow path. */
  chainage_m: Column;
  /** Of the front. */
  arrival_time_s: Column;
  /** There. */
  front_velocity_mps: Column;
}

/** Of the present setup, from time 0 to its end. */
export interface DepthAveragedResult {
  /** Time at which it ended, s. */
  end_s: number;
  /** False: it ended before debris rested or the scene's end time; see stop_reason. */
  complete: boolean;
  /** One sentence. */
  stop_reason: string;
  /** Whether it can be relied on. */
  verdict: Verdict;
  /** Of its steps. */
  wall_time_s: number;
  /** Of all of it. */
  processor_time_s: number;
  /** Edge of its cells. */
  grid_cell_m: number;
  /** As talus run --model depth_averaged has it for the same setup. */
  hash: string;
  /** What the model leaves out. */
  notes: string[];
  /** Over chainage. */
  front: DepthAveragedFront;
}

/** The depth-averaged model of the present setup of a scenario. Nothing of it is recorded. */
export interface DepthAveragedStatus {
  /** Its name. */
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
  /** Which quantity. */
  key: "front_velocity" | "front_arrival" | "front_chainage_m" | "run_out_along_flow_m" | "affected_area" | "peak_depth" | "peak_speed" | "peak_pressure";
  /** For people. */
  name: string;
  /** Of the values. */
  unit: string;
  /** To be shown. */
  decimals: number;
  /** So far. */
  particles: number | null;
  /** By the time of the particles, or as a whole if their run is over; null: not known or not reached. */
  depth_averaged_by_then: number | null;
  /** Of the whole run. */
  depth_averaged: number | null;
  /** In the field; null: it was not. */
  observed: number | null;
}

/** Ground covered by then. */
export interface AffectedArea {
  /** By both models. */
  both_m2: number;
  /** By particles alone. */
  particles_only_m2: number;
  /** By the depth-averaged model alone. */
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
  /** A quantity each. */
  rows: DepthAveragedRow[];
  /** Ground covered deeper than this is affected. */
  least_depth_m: number;
  /** Affected by then. */
  area: AffectedArea;
  /** How the setups of both differ. */
  differs: string[];
}

/** Body of POST /api/depth_averaged. */
export interface WantedDepthAveraged {
  /** Compute it, or discard it. */
  on: boolean;
}

/** Body of POST /api/scenarios. */
export interface WantedCopy {
  /** Name of a scenario. */
  copy_of: string;
  /** Applied to the new one first. */
  action?: Action;
}

/** Values of a trigger's message, by key with its unit. */
export interface TriggerValues {
  /** Of the release. */
  volume_m3?: number;
  /** Of the debris. */
  pore_pressure_ratio?: number;
  /** Of the gauge. */
  discharge_m3ps?: number;
}

/** Body of POST /api/trigger. */
export interface TriggerMessage {
  /** Name of a trigger of the scene. */
  trigger: string;
  /** Absent: those of the scene. */
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
  /** That has started or goes on; null: none. */
  scenario: ScenarioName | null;
  /** A run has started. */
  started: boolean;
}

/** The last value of a trigger's gauge. */
export interface GaugeValue {
  /** As received. */
  discharge_m3ps: number;
  /** UTC. */
  received_at: string;
}

/** A run that a trigger started; times of day are UTC. */
export interface TriggeredRun {
  /** Its name. */
  scenario: ScenarioName;
  /** Name of the trigger. */
  trigger: string;
  /** Empty: not known. */
  source: "HTTP" | "MQTT" | "";
  /** UTC. */
  received_at: string;
  /** As the message gave it; may be empty. */
  reason: string;
  /** Of the message. */
  values: TriggerValues;
  /** Last value of its gauge; null: none. */
  reading: GaugeValue | null;
}

/** An alarm that a run raised. */
export interface RaisedAlarm {
  /** Its name. */
  scenario: ScenarioName;
  /** Name of the alarm. */
  alarm: string;
  /** What is so, for people. */
  sentence: string;
  /** Of the scene file; may be empty. */
  message: string;
  /** Simulated time at which it was raised. */
  time_s: number;
  /** Simulated time at which the front is at the place, or what is warned of happens; null: not known. */
  expected_s: number | null;
  /** Steps taken until then. */
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
  /** Of the scene file. */
  name: string;
  /** Largest values. */
  limits: TriggerValues;
}

/** What came of a message. */
export interface AlertNote {
  /** UTC. */
  at: string;
  /** For people. */
  sentence: string;
}

/** Where messages of triggers can come from. */
export interface Listening {
  /** There is a token of triggers. */
  http: boolean;
  /** Of the connection to the broker; null: none. */
  mqtt: string | null;
}

/** Runs that triggers started, alarms that runs raised, and what came of messages. */
export interface Alerts {
  /** Where messages of triggers can come from. */
  listening: Listening;
  /** Of the scene. */
  triggers: Trigger[];
  /** Of all scenarios. */
  runs: TriggeredRun[];
  /** Of all runs. */
  alarms: RaisedAlarm[];
  /** The last 20: runs started, messages refused, what was not delivered. */
  notes: AlertNote[];
}

/** A layer that people have laid over the terrain. It takes no part in a run. */
export interface Overlay {
  /** In routes. */
  id: string;
  /** For people. */
  name: string;
  /** Points, lines and areas; or a picture over the terrain. */
  kind: "vector" | "picture";
  /** Who added it. */
  by: string;
  /** Whether it is shown. */
  visible: boolean;
  /** 0 to 1. */
  opacity: number;
  /** Of what the file gives no style, as #1f77b4. */
  colour: string;
  /** On the terrain. */
  features: number;
  /** Features left out, because they lie beside the terrain. */
  outside: number;
  /** By the file's own style. */
  styled: boolean;
  /** Of a raster of values: that of the darkest colour. */
  low: number | null;
  /** That of the brightest. */
  high: number | null;
  /** Of its reference system; may be empty. */
  note: string;
  /** Of its data. */
  bytes: number;
}

/** Layers that people have laid over the terrain. */
export interface Overlays {
  /** From bottom to top. */
  overlays: Overlay[];
  /** Name of the one that was removed last, or the host of its map tiles, which can come back. */
  removed: string | null;
  /** Of map tiles that can be chosen as background. */
  tiles: TileAddress[];
  /** That may still come. */
  bytes_left: number;
}

/** A layer over the terrain, of a session file. */
export interface SavedOverlay extends Overlay {
  /** Of data. */
  type: "application/json" | "image/png" | "image/webp";
  /** An OverlayData as text, or a picture in Base64. */
  data: string;
}

/** Body of POST /api/overlays/{id}; what is absent stays. */
export interface WantedOverlay {
  /** Up to 80 bytes. */
  name?: string;
  /** Whether it is shown. */
  visible?: boolean;
  /** 1: it hides what is below. */
  opacity?: number;
  /** As #1f77b4. */
  colour?: string;
}

/** How a feature is drawn, by its file. */
export interface OverlayStyle {
  /** Of lines and outlines, as #1f77b4; empty: none. */
  stroke: string;
  /** 0 to 1. */
  stroke_opacity: number;
  /** Of areas and marks; empty: none. */
  fill: string;
  /** 0 to 1. */
  fill_opacity: number;
  /** Of lines. */
  width_px: number;
  /** Of the mark of a point. */
  size_px: number;
}

/** A feature of a layer, cut to the terrain. */
export interface OverlayFeature {
  /** Of its parts. */
  kind: "point" | "line" | "area";
  /** x, y, x, y, ... in metres from the south-west corner of the terrain; of an area its rings, inside by the even-odd rule. */
  parts: number[][];
  /** May be empty. */
  name: string;
  /** The others. */
  attributes: Record<string, string | number>;
  /** Index into styles; -1: none. */
  style: number;
}

/** What is in a layer of points, lines and areas. */
export interface OverlayData {
  /** Of features. */
  styles: OverlayStyle[];
  /** In the order of the file. */
  features: OverlayFeature[];
}

/** An address of map tiles that a browser may load. */
export interface TileAddress {
  /** In routes. */
  id: string;
  /** With {z}, {x} and {y}, or {TileMatrix}, {TileCol} and {TileRow}. */
  address: string;
  /** Who added it; empty: the program was started with it. */
  by: string;
}

/** An address of map tiles, of a session file. */
export interface SavedTiles {
  /** As in TileAddress. */
  address: string;
  /** Who added it. */
  by: string;
}

/** Body of POST /api/tiles. */
export interface WantedTiles {
  /** Up to 500 bytes: https or http, with {z}, {x} and {y}, or {TileMatrix}, {TileCol} and {TileRow} of a WMTS in Web Mercator. */
  address: string;
}

/** Map tiles in Web Mercator that a browser may load. */
export interface Tiles {
  /** With {z}, {x} and {y}, or {TileMatrix}, {TileCol} and {TileRow}. */
  addresses: string[];
  /** The terrain is divided into so many by so many equal parts. */
  steps: number;
  /** Longitude and latitude of their corners on WGS 84, from west to east, then from south to north; empty without an address. */
  degrees: number[];
}

/** How other computers reach the server. */
export interface SharedLink {
  /** Address or name, with the port. */
  host: string;
  /** With TLS. */
  encrypted: boolean;
  /** Link for viewers. */
  viewer_url: string;
  /** Link for controllers. */
  controller_url: string;
}

/** Whether other computers reach the server, and by which addresses they could. */
export interface Share {
  /** Null: they do not. */
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
  | ({ action: "put_building"; id?: string; name?: string; polygon?: Point[]; move_m?: Point } & Partial<BuildingsValues>)
  | ({ action: "put_zone"; id?: string; name?: string; polygon?: Point[]; move_m?: Point } & Partial<ZoneValues>)
  | { action: "remove_barrier" | "remove_building" | "remove_zone"; id: string }
  | ({ action: "put_bed"; id?: string; name?: string; polygon?: Point[]; move_m?: Point } & Partial<BedValues>)
  | ({ action: "put_inflow"; id?: string; name?: string; line?: Point[]; polygon?: Point[]; move_m?: Point; hydrograph?: HydrographRow[] } & Partial<InflowValues>)
  | { action: "put_gauge"; id?: string; name?: string; x_m?: number; y_m?: number; chainage_m?: number }
  | { action: "remove_bed" | "remove_inflow" | "remove_gauge"; id: string }
  | { action: "put_note"; id?: string; name?: string; x_m?: number; y_m?: number }
  | { action: "remove_note"; id: string }
  | { action: "put_observation"; id?: string; section?: string; values?: Record<string, TableValue> }
  | { action: "put_trigger" | "put_alarm"; id?: string; values?: Record<string, TableValue> }
  | { action: "remove_observation" | "remove_trigger" | "remove_alarm"; id: string }
  | { action: "undo" | "redo" };

/** What the server sends over the WebSocket, besides frames. */
export type ServerMessage =
  | { type: "hello"; protocol: number; you: You; session: Session }
  | ({ type: "state" } & State)
  | ({ type: "setup" } & Setup)
  | { type: "people"; people: Person[]; controller: string | null; request: ControlRequest | null }
  | ({ type: "calibration" } & CalibrationStatus)
  | ({ type: "alerts" } & Alerts)
  | ({ type: "overlays" } & Overlays)
  | ({ type: "depth_averaged" } & DepthAveragedStatus)
  | { type: "scenarios"; scenarios: ScenarioName[] }
  | { type: "ended" }
  | { type: "done"; scenario: ScenarioName; by: string; done: string };

/** What a page sends over the WebSocket. */
export type PageMessage =
  | { type: "view"; scenarios: ScenarioName[]; rate_hz: number; particle_cap: number }
  | { type: "mark"; at: Place | null }
  | { type: "name"; name: string };
