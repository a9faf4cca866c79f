// Scale and texts of the misfit map of a calibration.
import type { CalibrationStatus, Parameter } from "../protocol/messages";
import { aboutTime } from "./time_left";

/** Misfits range over decades, and near the best their differences matter most: a logarithm of 1 + misfit. */
export class MisfitScale {
  constructor(readonly low: number, readonly high: number) {}

  static of(status: Pick<CalibrationStatus, "runs" | "fast_runs" | "map">): MisfitScale {
    const all = [...[...status.runs, ...status.fast_runs].map((r) => r.misfit), ...(status.map?.misfit ?? [])].filter((v): v is number => v !== null);
    if (all.length === 0) return new MisfitScale(0, 1);
    const low = Math.min(...all);
    const high = Math.max(...all);
    // Runs with similar misfit should look similar, and not span all colours.
    return new MisfitScale(low, Math.max(high, 1.5 * (1 + low) - 1));
  }
  share(misfit: number): number {
    const part = Math.log((1 + misfit) / (1 + this.low)) / Math.log((1 + this.high) / (1 + this.low));
    return Math.min(1, Math.max(0, part));
  }
  /** The misfit at a share of the scale. */
  at(share: number): number {
    return (1 + this.low) * ((1 + this.high) / (1 + this.low)) ** share - 1;
  }
}

/** Initial ranges of a calibration; as in docs/calibration.md, otherwise around the current value. */
const usual: Record<string, [number, number]> = { "material.friction_coefficient": [0.1, 0.6], "material.viscosity": [0.01, 0.6] };
export const freeAtFirst = Object.keys(usual);

export function firstRange(parameter: Parameter, present: number | null): [number, number] {
  const value = present ?? parameter.value ?? parameter.default ?? 1;
  const known = usual[parameter.key];
  if (known && value >= known[0] && value <= known[1]) return known;
  const low = Math.max(parameter.range.low ?? -Infinity, value > 0 ? value / 2 : 0);
  const high = Math.min(parameter.range.high ?? Infinity, value > 0 ? 1.5 * value : 1);
  return [Number(low.toPrecision(3)), Number((high > low ? high : low + 1).toPrecision(3))];
}

/** Which parameters are free before anything was chosen: with the depth-averaged model only what it has a use for. */
export const startsFree = (parameter: Parameter, depthAveraged: boolean): boolean =>
  freeAtFirst.includes(parameter.key) && (!depthAveraged || parameter.used_by_depth_averaged);

/** What a maximum number of runs becomes where the other way of searching is chosen: what was typed stays. */
export const runsAfterChoice = (typed: boolean, runs: number, usual: number): number => (typed && Number.isFinite(runs) ? runs : usual);

/** Why these cannot be the ends of a range; null: they can. */
export function rangeProblem(parameter: Parameter, low: number, high: number): string | null {
  const { range } = parameter;
  if (!Number.isFinite(low) || !Number.isFinite(high)) return `${parameter.label}: give a lowest and a highest value`;
  if (!(low < high)) return `${parameter.label}: ${low} must be below ${high}`;
  if (range.low !== null && low < range.low) return `${parameter.label}: at least ${range.low} is allowed`;
  if (range.high !== null && high > range.high) return `${parameter.label}: at most ${range.high} is allowed`;
  return null;
}

const phases = { design: "spread over the ranges", search: "search for the best", check: "checks of the result" };

const counted = (runs: number): string => `${runs} ${runs === 1 ? "run" : "runs"}`;

/** Progress of a calibration, in a sentence. */
export function progressText(status: CalibrationStatus): string {
  const fast = status.fast_runs_at_most > 0 ? `${status.fast_runs.length} of at most ${status.fast_runs_at_most} runs depth-averaged, ` : "";
  const computed = `${counted(status.runs.length)}${fast ? ` of particles and ${status.fast_runs.length} depth-averaged` : ""}`;
  const done = `${fast}${status.runs.length} of at most ${status.runs_at_most} runs${fast ? " of particles" : ""}`;
  const failed = status.runs_failed > 0 ? `, ${status.runs_failed} failed` : "";
  switch (status.state) {
    case "idle": return "";
    case "running": {
      const left = aboutTime(status.wall_remaining_s);
      return `${done}${failed}${status.phase ? ` · ${phases[status.phase]}` : ""}${left ? ` · ${left} left at most` : ""}`;
    }
    case "cancelling": return `${done}${failed} · stops after the current step`;
    case "cancelled": return `Cancelled after ${computed}${failed}`;
    case "failed": return `Ended after ${computed}${failed}: ${status.message}`;
    case "done": return `${computed}${failed}${status.result?.settled ? ": no further gain expected" : "; stopped at the maximum number"}${status.message ? `. ${status.message}` : ""}`;
  }
}
