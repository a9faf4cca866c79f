// How long something still takes, as people say it.
import type { State } from "../protocol/messages";

/** "about 3 min": the estimate is not more accurate. */
export function aboutTime(seconds: number | null): string {
  if (seconds === null || !Number.isFinite(seconds)) return "";
  if (seconds < 90) return `about ${Math.max(5, 5 * Math.round(seconds / 5))}\u202fs`;
  if (seconds < 5400) return `about ${Math.round(seconds / 60)}\u202fmin`;
  return `about ${Number((seconds / 3600).toPrecision(2))}\u202fh`;
}

/** Wall time until a run is expected to be over, s: at the speed that is wanted, unless it takes longer anyway. */
export function timeLeft(state: Pick<State, "time_s" | "expected_end_s" | "wall_remaining_s" | "speed_factor">): number | null {
  if (state.expected_end_s === null || state.wall_remaining_s === null) return null;
  const wanted = state.speed_factor === null ? 0 : (state.expected_end_s - state.time_s) / state.speed_factor;
  return Math.max(wanted, state.wall_remaining_s);
}
