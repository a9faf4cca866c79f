// What the start page and the server tell each other: docs/protocol.md, "The start page".
import type { Parameter } from "./messages";

export interface KnownScene {
  id: string;
  title: string;
  kind: "recent" | "own" | "builtin";
  file: string | null;
  opened_at: string | null;
  missing: boolean;
}
export interface SavedSession { id: string; name: string; title: string; saved_at: string; scenarios: number }

export interface UploadLimits { bytes: number; files: number; cells: number }
export type DraftRole = "terrain" | "release" | "buildings" | "orthophoto" | "bundle";
export interface MendingOfTerrain { epsg: number | null; metric: boolean; metres_per_unit: number | null; nodata: number | null }
/** A new scene that is being made. */
export interface Draft {
  files: Partial<Record<DraftRole, { name: string; bytes: number; kind: "raster" | "polygons" | "other" }>>;
  terrain: {
    problem: string | null;
    columns: number;
    rows: number;
    crs: string;
    metric_crs: string;
    value_unit: string;
    /** Metres per unit of the heights, as far as the file says. */
    height_unit_m: number;
    cell_m?: number;
    nodata_share?: number;
    elevation_m?: [number, number] | null;
    mending: MendingOfTerrain;
  } | null;
  bytes_left: number;
}
export interface Checked { summary: string; notes: string[]; created: string | null }
export interface WantedScene { title: string; thickness_m: number | null; volume_m3: number | null; scar: [number, number][] | null; check?: boolean }

export type JobKind = "ensemble" | "calibration" | "validation";
/** An ensemble, a calibration or a validation in a process of its own. */
export interface Job {
  id: string;
  kind: JobKind;
  state: "waiting" | "running" | "cancelling" | "done" | "cancelled" | "interrupted" | "failed";
  title: string;
  message: string;
  begun_at: string;
  ended_at: string | null;
  /** Runs, or cases of a validation. */
  done: number;
  failed: number;
  count: number;
  wall_remaining_s: number | null;
  command: string;
  folder: string;
  report: string | null;
}
/** What a job of a scene may vary. */
export interface JobForm {
  title: string;
  parameters: Parameter[];
  observations: string[];
  limits: { runs: number; ensemble_factors: number; calibration_factors: number };
}
/** Of one run on all cores. */
export interface JobEstimate { run_s: number | null; particles: number; memory_bytes: number; cores: number }
export interface ValidationCase { name: string; title: string; quick: boolean }
export interface Range { key: string; low: number; high: number }
export type WantedJob =
  | { kind: "ensemble"; scene: string; factors: Range[]; runs: number; design: string }
  | { kind: "calibration"; scene: string; factors: Range[]; runs: number }
  | { kind: "validation"; quick?: boolean; cases?: string[] };

export interface StartPage {
  /** False: a server of one scene, which has nothing of the following. */
  available: boolean;
  open: { title: string } | null;
  opening: { what: string; share: number } | null;
  error: string | null;
  /** Sessions opened so far: grows when another one has taken the place. */
  count: number;
  /** About the session that is open. */
  notes: string[];
  program: string;
  role: "viewer" | "controller";
  // For controllers.
  folder?: string;
  uploads?: UploadLimits;
  scenes?: KnownScene[];
  sessions?: SavedSession[];
  /** Newest first; null: there are none on this server. */
  jobs?: Job[] | null;
}
