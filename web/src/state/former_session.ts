// A session that ended while this page was not connected: its server was restarted, or another session was opened. The page reloads and says
// what was lost.
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
  const runs = former.runs.filter((run) => run.time_s >= 0.05).map((run) => `run ${run.scenario} (${run.time_s.toFixed(run.time_s < 10 ? 1 : 0)} s)`);
  return `The session “${former.title}” has ended. Lost: ${[...runs, "all edits that were not saved"].join(", ")}.`;
}
