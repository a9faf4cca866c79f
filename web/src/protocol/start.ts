// Made from src/messages/protocol.json: edit that; docs/protocol.md tells how this is made again.
import type { Journal, Parameter, Point, Preparation, Role, SavedOverlay, SavedTiles, VariedKey } from "./messages";

/** A scene that can be opened. */
export interface KnownScene {
  /** In requests. */
  id: string;
  /** Of the scene. */
  title: string;
  /** Recent: opened before; own: made here. */
  kind: "recent" | "own" | "builtin";
  /** Null: it is built in. */
  file: string | null;
  /** UTC; null: never. */
  opened_at: string | null;
  /** Its file is gone. */
  missing: boolean;
}

/** A session that can be opened. */
export interface SavedSession {
  /** In requests. */
  id: string;
  /** As it was saved. */
  name: string;
  /** Of its scene. */
  title: string;
  /** UTC. */
  saved_at: string;
  /** Number of them. */
  scenarios: number;
}

/** A scenario of a session file. */
export interface SavedScenario {
  /** A to F. */
  name: string;
  /** Given by people. */
  title: string;
  /** As GET .../journal. */
  journal: Journal;
}

/** The journal of every scenario, all of one scene. Opened, each is replayed, and its hash compared with the saved one. */
export interface SessionFile {
  /** Version of the format. */
  talus_session: 1;
  /** As it was saved. */
  name: string;
  /** Of its scene. */
  title: string;
  /** UTC. */
  saved_at: string;
  /** In the order of their names. */
  scenarios: SavedScenario[];
  /** Layers over the terrain, from bottom to top. */
  overlays?: SavedOverlay[];
  /** Addresses of map tiles that people added. */
  tiles?: SavedTiles[];
}

/** Body of POST /api/sessions. */
export interface WantedSession {
  /** Under which it is saved. */
  name: string;
  /** A session file; absent: the open session. */
  file?: object;
}

/** Body of POST /api/open: one of the first three. */
export interface WantedOpening {
  /** Id of one. */
  scene?: string;
  /** Id of a saved one. */
  session?: string;
  /** A finished one of the jobs, shown on its scene. */
  ensemble?: string;
  /** In place of the open session, which nobody else may control. */
  replace?: boolean;
}

/** What a new scene may have. */
export interface UploadLimits {
  /** Of all files together. */
  bytes: number;
  /** In an archive. */
  files: number;
  /** Of a raster. */
  cells: number;
}

/** Of a file; a bundle is a whole scene. */
export type DraftRole = "terrain" | "release" | "buildings" | "orthophoto" | "bundle";

/** A file that was uploaded. */
export interface DraftFile {
  /** As uploaded. */
  name: string;
  /** Of the file. */
  bytes: number;
  /** What it holds. */
  kind: "raster" | "polygons" | "other";
}

/** What is known of the terrain as it was uploaded. */
export interface MendingOfTerrain {
  /** Code of the reference system that it is in. */
  epsg: number | null;
  /** It states none, and its coordinates are metres of its own, as those of a flume. */
  local: boolean;
  /** Bring it onto square cells of a metric system. */
  metric: boolean;
  /** Of its elevations. */
  metres_per_unit: number | null;
  /** The elevation that marks missing data. */
  nodata: number | null;
}

/** The terrain of a new scene. */
export interface DraftTerrain {
  /** Why it cannot be the terrain of a scene. */
  problem: string | null;
  /** Of cells. */
  columns: number;
  /** Of cells. */
  rows: number;
  /** Empty: none is stated. */
  crs: string;
  /** What it could be brought to; empty: its place is not known. */
  metric_crs: string;
  /** As stated; empty: none. */
  value_unit: string;
  /** Metres per unit of its heights, as far as the file says: of its values, else the vertical or else the horizontal unit of its reference system. */
  height_unit_m: number;
  /** This and nodata_share: of a terrain without a problem. */
  cell_m?: number;
  /** Of cells without a value. */
  nodata_share?: number;
  /** Lowest and highest. */
  elevation_m?: [number, number] | null;
  /** As POST /api/draft/{id}/mend said. */
  mending: MendingOfTerrain;
}

/** A new scene that is being made. */
export interface Draft {
  /** By role. */
  files: Partial<Record<DraftRole, DraftFile>>;
  /** Null: there is none yet. */
  terrain: DraftTerrain | null;
  /** That may still come. */
  bytes_left: number;
}

/** What was found in a new scene. */
export interface Checked {
  /** As talus scene check prints it. */
  summary: string;
  /** What was assumed or changed, what is odd. */
  notes: string[];
  /** Id of the scene; null: it was only checked. */
  created: string | null;
}

/** Body of POST /api/draft/{id}/scene; thickness or volume, not both. */
export interface WantedScene {
  /** Of the scene. */
  title?: string;
  /** Of the release. */
  thickness_m?: number | null;
  /** Of the release. */
  volume_m3?: number | null;
  /** Outline of the release, in place of a file, in the reference system of the terrain. */
  scar?: Point[] | null;
  /** Only check it. */
  check?: boolean;
}

export type JobKind = "ensemble" | "calibration" | "validation" | "risk" | "options" | "design";

/** An ensemble, a calibration or a validation in a process of its own. */
export interface Job {
  /** In routes. */
  id: string;
  /** What it computes. */
  kind: JobKind;
  /** Interrupted: the program ended meanwhile. */
  state: "waiting" | "running" | "cancelling" | "done" | "cancelled" | "interrupted" | "failed";
  /** Of its scene; of a validation which cases. */
  title: string;
  /** How it ended, where its state does not say all. */
  message: string;
  /** UTC. */
  begun_at: string;
  /** UTC; null: it has not. */
  ended_at: string | null;
  /** Runs, or cases of a validation. */
  done: number;
  /** Of these. */
  failed: number;
  /** 0: not known yet. */
  count: number;
  /** An estimate; null: not known. */
  wall_remaining_s: number | null;
  /** The command line that computes the same. */
  command: string;
  /** Of its results. */
  folder: string;
  /** Link to its report, relative to the page. */
  report: string | null;
}

/** What a job may have at most. */
export interface JobLimits {
  /** Of a job. */
  runs: number;
  /** Keys that an ensemble may vary. */
  ensemble_factors: number;
  /** Keys that a calibration may vary. */
  calibration_factors: number;
}

/** What a job of a scene may vary. */
export interface JobForm {
  /** Of the scene. */
  title: string;
  /** That may vary. */
  parameters: Parameter[];
  /** None: the scene cannot be calibrated. */
  observations: string[];
  /** Classes of events; none: the scene states no risk. */
  events: string[];
  /** Of measures. */
  options: string[];
  /** None: there is nothing to design. */
  barriers: string[];
  /** Of a job. */
  limits: JobLimits;
}

/** What one run of a scene costs here. */
export interface JobEstimate {
  /** Wall time of one run on all cores. */
  run_s: number | null;
  /** About. */
  particles: number;
  /** Of one run. */
  memory_bytes: number;
  /** Of this computer. */
  cores: number;
}

/** A case of the program. */
export interface ValidationCase {
  /** In requests. */
  name: string;
  /** For people. */
  title: string;
  /** One of the quick cases. */
  quick: boolean;
}

export interface ValidationCases {
  /** In the order of their names. */
  cases: ValidationCase[];
}

/** A job of many runs. */
export interface WantedEnsemble {
  /** Which job. */
  kind: "ensemble";
  /** Id of a scene. */
  scene: string;
  /** What varies. */
  factors: VariedKey[];
  /** Absent: as the command has it. */
  runs?: number;
  /** How values are drawn; absent: as the command has it. */
  design?: "latin_hypercube" | "monte_carlo" | "sobol" | "saltelli" | "morris";
}

/** A job that fits parameters to the scene's observations. */
export interface WantedBackAnalysis {
  /** Which job. */
  kind: "calibration";
  /** Id of a scene. */
  scene: string;
  /** What varies. */
  factors: VariedKey[];
  /** Absent: as the command has it. */
  runs?: number;
}

/** A job that runs validation cases. */
export interface WantedValidation {
  /** Which job. */
  kind: "validation";
  /** The quick cases only. */
  quick?: boolean;
  /** These cases; absent: all. */
  cases?: string[];
}

/** A job that counts what is at risk, or compares options. */
export interface WantedRisk {
  /** Which job. */
  kind: "risk" | "options";
  /** Id of a scene. */
  scene: string;
  /** What varies. */
  factors: VariedKey[];
  /** Of each class of events, for each option; absent: as the command has it. */
  runs?: number;
  /** How values are drawn; absent: as the command has it. */
  design?: "latin_hypercube" | "monte_carlo" | "sobol";
}

/** A job that finds the least height of a barrier. */
export interface WantedDesign {
  /** Which job. */
  kind: "design";
  /** Id of a scene. */
  scene: string;
  /** What varies. */
  factors: VariedKey[];
  /** Its name in the scene. */
  barrier: string;
  /** Of each height; absent: as the command has it. */
  runs?: number;
  /** How values are drawn; absent: as the command has it. */
  design?: "latin_hypercube" | "monte_carlo" | "sobol";
  /** That may pass, 0 to below 1; absent: as the command has it. */
  share?: number;
  /** Of what; absent: of the runs. */
  of?: "runs" | "volume";
  /** Least height tried; absent: as the command has it. */
  min_height_m?: number;
  /** Greatest height tried; absent: as the command has it. */
  max_height_m?: number;
  /** Repeats the deciding runs; absent: none. */
  confirm?: "none" | "particles";
}

/** Body of POST /api/jobs. */
export type WantedJob = WantedEnsemble | WantedBackAnalysis | WantedValidation | WantedRisk | WantedDesign;

/** What can be opened, what is being opened. folder and the following are for controllers. */
export interface StartPage {
  /** True. */
  available: boolean;
  /** The session that is open; null: none. */
  open: { title: string } | null;
  /** What is being opened; null: nothing. */
  opening: Preparation | null;
  /** Why the last one could not be opened. */
  error: string | null;
  /** Sessions opened so far: grows when another one has taken the place. */
  count: number;
  /** About the session that is open, such as a result that differs from the saved one. */
  notes: string[];
  /** With its version. */
  program: string;
  /** What the token entitles to. */
  role: Role;
  /** Keeps own scenes and saved sessions. */
  folder?: string;
  /** What a new scene may have. */
  uploads?: UploadLimits;
  /** That can be opened. */
  scenes?: KnownScene[];
  /** That can be opened. */
  sessions?: SavedSession[];
  /** Ensembles, calibrations and validations started here, newest first; null: there are none on this server. */
  jobs?: Job[] | null;
}

/** Of a server of one scene. */
export interface NoStartPage {
  /** False. */
  available: boolean;
}
