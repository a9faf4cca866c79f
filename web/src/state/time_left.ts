// How long something still takes, as people say it.
import type { State } from "../protocol/messages";
import { quantity, tick } from "./format";

/** "about 3 min": the estimate is not more accurate. */
export function aboutTime(seconds: number | null): string {
  if (seconds === null || !Number.isFinite(seconds)) return "";
  if (seconds < 90) return `about ${Math.max(5, 5 * Math.round(seconds / 5))}\u202fs`;
  if (seconds < 5400) return `about ${Math.round(seconds / 60)}\u202fmin`;
  return `about ${Number((seconds / 3600).toPrecision(2))}\u202fh`;
}

/** Why a run has ended, as its people say it; the server's message names keys of the scene. */
export function endText(state: Pick<State, "status" | "message" | "time_s" | "end_time_s" | "volume_moving_m3">): string {
  // A run also ends where its energy falls to a share of the peak.
  if (state.status !== "ended" || state.time_s < state.end_time_s * (1 - 1e-6)) return state.message;
  const moving = state.volume_moving_m3 > 0 ? `; ${quantity(state.volume_moving_m3, "m3")} still moving` : "";
  return `Stopped at the ${tick(state.end_time_s)}\u202fs limit${moving}`;
}

/** Wall time until a run is expected to be over, s: at the speed that is wanted, unless it takes longer anyway. */
export function timeLeft(state: Pick<State, "time_s" | "expected_end_s" | "wall_remaining_s" | "speed_factor">): number | null {
  if (state.expected_end_s === null || state.wall_remaining_s === null) return null;
  const wanted = state.speed_factor === null ? 0 : (state.expected_end_s - state.time_s) / state.speed_factor;
  return Math.max(wanted, state.wall_remaining_s);
}
