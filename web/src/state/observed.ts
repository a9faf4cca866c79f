// Rows of observations of several runs beside each other.
import type { ObservedRow } from "../protocol/messages";

/** For each observation its row of every run, null: that has none. Names may be given twice, and ids differ where each run has got its own: those of the same observation come together first, then those of the same name. */
export function pairedRows(runs: readonly (readonly ObservedRow[])[]): (ObservedRow | null)[][] {
  const groups: (ObservedRow | null)[][] = [];
  const same: readonly ((a: ObservedRow, b: ObservedRow) => boolean)[] = [(a, b) => a.id === b.id && a.name === b.name, (a, b) => a.name === b.name];
  runs.forEach((rows, run) => {
    const free = [...rows];
    for (const belong of same) {
      for (const group of groups) {
        if (group[run] !== null) continue;
        const found = free.findIndex((row) => group.some((other) => other !== null && belong(other, row)));
        if (found >= 0) group[run] = free.splice(found, 1)[0];
      }
    }
    for (const row of free) groups.push(runs.map((_, k) => (k === run ? row : null)));
  });
  return groups;
}
