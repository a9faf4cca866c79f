// A session that is gone because its server was started again, or because another one took its place while this page was away. The page loads
// itself anew and tells what was lost.
import type { ScenarioName } from "../protocol/frame";

const key = "talus-former-session";

export interface FormerSession { title: string; runs: { scenario: ScenarioName; time_s: number }[] }

export function keepFormer(former: FormerSession): void {
  sessionStorage.setItem(key, JSON.stringify(former));
}
/** Once: then it has been told. */
export function takeFormer(): FormerSession | null {
  const kept = sessionStorage.getItem(key);
  sessionStorage.removeItem(key);
  return kept === null ? null : (JSON.parse(kept) as FormerSession);
}
export function whatIsGone(former: FormerSession): string {
  const runs = former.runs.filter((run) => run.time_s >= 0.05).map((run) => `${run.scenario} to ${run.time_s.toFixed(run.time_s < 10 ? 1 : 0)} s`);
  return `The session “${former.title}” has ended. ${runs.length === 0 ? "" : `Its ${runs.length === 1 ? "run is" : "runs are"} gone: ${runs.join(", ")}. `}` +
    "What was drawn or changed in it is gone unless it was saved.";
}
