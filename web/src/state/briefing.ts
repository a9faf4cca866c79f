// The course of a briefing: which time of the run each picture of the film shows, where the front is then, what it has hit.
import type { Impacts, Series } from "../protocol/messages";

export const pictures_hz = 25;
/** Of views of the whole scene before and after the flow. */
const overview_s = { before: 2, after: 3 };

export interface Moment { film_s: number; run_s: number; part: "before" | "flow" | "after" }

/** speed: seconds of the run per second of the film; overviews: whether it begins and ends with the whole scene. */
export function course(from_s: number, to_s: number, speed: number, overviews = true): Moment[] {
  const [before_s, after_s] = overviews ? [overview_s.before, overview_s.after] : [0, 0];
  const flow_s = (to_s - from_s) / speed;
  const count = Math.max(1, Math.round((before_s + flow_s + after_s) * pictures_hz));
  return Array.from({ length: count }, (_, k) => {
    const film_s = k / pictures_hz;
    const into = film_s - before_s;
    return { film_s, run_s: from_s + speed * Math.min(flow_s, Math.max(0, into)), part: into < 0 ? "before" : into < flow_s ? "flow" : "after" };
  });
}

/** When the front stops: nothing of the film is lost to a deposit that only creeps. */
export function endOfFlow(series: Series | null, last_s: number): number {
  const arrivals = (series?.front.arrival_time_s ?? []).filter((t): t is number => t !== null);
  return arrivals.length === 0 ? last_s : Math.min(last_s, Math.max(...arrivals) + 3);
}

/** The farthest chainage reached by a time, between the places where the front was timed, and the velocity there; null: none yet. */
export function frontAt(series: Series | null, time_s: number): { chainage_m: number; velocity_mps: number | null } | null {
  if (!series) return null;
  const { chainage_m, arrival_time_s, front_velocity_mps } = series.front;
  let at = -1;
  for (let k = 0; k < chainage_m.length; ++k) {
    const [c, t] = [chainage_m[k], arrival_time_s[k]];
    if (c === null || t === null || t > time_s) continue;
    if (at < 0 || c > (chainage_m[at] ?? 0)) at = k;
  }
  if (at < 0) return null;
  const chainage = chainage_m[at] ?? 0;
  const arrival = arrival_time_s[at] ?? 0;
  const next = arrival_time_s[at + 1];
  const there = chainage_m[at + 1];
  // The front is between the last place reached and the next; it stands where nothing further is reached.
  if (typeof next !== "number" || typeof there !== "number" || next <= arrival) return { chainage_m: chainage, velocity_mps: time_s - arrival > 1 ? 0 : (front_velocity_mps[at] ?? null) };
  const share = Math.min(1, (time_s - arrival) / (next - arrival));
  return { chainage_m: chainage + share * (there - chainage), velocity_mps: front_velocity_mps[at] ?? null };
}

/** Names of what was hit until a time, the latest first. */
export function hitUntil(impacts: Impacts | null, time_s: number): { name: string; at_s: number }[] {
  if (!impacts) return [];
  return [...impacts.buildings, ...impacts.barriers].flatMap(({ name, first_hit_s }) => (first_hit_s !== null && first_hit_s <= time_s ? [{ name, at_s: first_hit_s }] : []))
    .sort((a, b) => b.at_s - a.at_s);
}
