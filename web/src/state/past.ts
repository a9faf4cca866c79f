// Data at an earlier time of the recording.
import type { Column, Series, State } from "../protocol/messages";

/** Series up to a time; null: all of them. */
export function seriesUntil(series: Series | null, time_s: number | null): Series | null {
  if (series === null || time_s === null) return series;
  const until = time_s + 1e-6;
  const kept = (times: Column): number => {
    const after = times.findIndex((t) => t !== null && t > until);
    return after < 0 ? times.length : after;
  };
  const rows = kept(series.time["time_s"] ?? []);
  const time = Object.fromEntries(Object.entries(series.time).map(([name, column]) => [name, column.slice(0, rows)]));
  // The front arrives in order of chainage, but a second surge may reach places that the first one missed.
  const { arrival_time_s } = series.front;
  const there = <T>(column: readonly T[]): T[] => column.filter((_, k) => (arrival_time_s[k] ?? Infinity) <= until);
  const { chainage_m, front_velocity_mps, particle_speed_mps } = series.front;
  const { gauges } = series;
  const passed = kept(gauges.time_s);
  return {
    time,
    gauges: { time_s: gauges.time_s.slice(0, passed), depth_m: gauges.depth_m.map((column) => column.slice(0, passed)) },
    front: { chainage_m: there(chainage_m), arrival_time_s: there(arrival_time_s), front_velocity_mps: there(front_velocity_mps),
      particle_speed_mps: there(particle_speed_mps) },
  };
}

/** The front counts as moving for this time after reaching a new chainage, as in the server. */
const lately_s = 1;

/** The state at a time, from the row of the series at or before it; values that are in no series remain current. null: its series is not there yet. */
export function stateAt(state: State, series: Series | null, time_s: number | null): State | null {
  if (time_s === null) return state;
  const past = seriesUntil(series, time_s);
  if (past === null) return null;
  const times = past.time["time_s"] ?? [];
  if (times.length === 0) return state;
  const row = times.length - 1;
  const number = <T extends number | null>(column: string, otherwise: T): T | number => past.time[column]?.[row] ?? otherwise;
  const { front } = past;
  const newest = front.arrival_time_s.reduce<number>((best, t, k) => ((t ?? -Infinity) > (front.arrival_time_s[best] ?? -Infinity) ? k : best), 0);
  const arrived = front.arrival_time_s[newest] ?? null;
  return {
    ...state,
    time_s,
    volume_released_m3: number("volume_released_m3", state.volume_released_m3),
    volume_entrained_m3: number("volume_entrained_m3", state.volume_entrained_m3),
    volume_held_m3: number("volume_held_m3", state.volume_held_m3),
    volume_moving_m3: number("volume_moving_m3", state.volume_moving_m3),
    volume_deposited_m3: number("volume_deposited_m3", state.volume_deposited_m3),
    volume_left_m3: number("volume_left_m3", state.volume_left_m3),
    largest_speed_mps: number("largest_speed_mps", state.largest_speed_mps),
    mean_compression: number("mean_compression", state.mean_compression),
    max_compression: number("max_compression", state.max_compression),
    overcompressed_share: number("overcompressed_share", state.overcompressed_share),
    front_chainage_m: past.time["front_chainage_m"]?.[row] ?? null,
    front_velocity_mps: arrived !== null && time_s - arrived <= lately_s ? (front.front_velocity_mps[newest] ?? null) : null,
  };
}
