// What the page says of the depth-averaged model, and its comparison with the particles.
import type { DepthAveragedComparison, DepthAveragedRow, DepthAveragedStatus } from "../protocol/messages";
import { fixed, number, quantity, tick } from "./format";

export const isOn = (status: DepthAveragedStatus | null): boolean => status !== null && status.state !== "off";

/** How far it is, or what came of it; empty: it is off. */
export function statusText(status: DepthAveragedStatus | null): string {
  switch (status?.state) {
    case undefined:
    case "off":
      return "";
    case "waiting":
      return "Waiting to be computed.";
    case "running":
      return `Computing: ${fixed(100 * (status.share ?? 0), 0)} % of the time.`;
    case "refused":
    case "failed":
      return status.message;
    case "done": {
      const { result } = status;
      if (!result) return "";
      const cost = `Computed in ${quantity(result.wall_time_s, "s", 2)} on cells of ${tick(result.grid_cell_m)}\u202fm`;
      const came = result.complete ? `${cost}: ${fixed(result.end_s, 0)} s of the present setup.` : `${cost}; not complete: ${result.stop_reason}.`;
      return result.verdict.within_limits ? came : `${came} Beyond limits. ${result.verdict.warnings.join(". ")}.`;
    }
  }
}

/** For a legend: which run its map is of. */
export function sourceText(status: DepthAveragedStatus | null): string {
  const result = status?.result;
  return result ? `Depth-averaged model, whole run of ${fixed(result.end_s, 0)} s` : `Depth-averaged model: ${statusText(status) || "off"}`;
}

export interface ComparedTable { heads: string[]; rows: { name: string; unit: string; values: string[] }[] }

/** Columns that say what they are: while the particles move, the other model by the same time and at its end. */
export function comparedTable(compared: DepthAveragedComparison): ComparedTable {
  const observed = compared.rows.some((row) => row.observed !== null);
  const by = `by ${fixed(compared.time_s, 1)} s`;
  const heads = [...(compared.over ? ["Particles", "Depth-averaged"] : [`Particles ${by}`, `Depth-averaged ${by}`, "Depth-averaged, whole run"]), ...(observed ? ["Observed"] : [])];
  const values = (row: DepthAveragedRow): string[] => {
    const text = (value: number | null): string => (row.unit === "m2" ? number(value) : fixed(value, row.decimals));
    return [text(row.particles), ...(compared.over ? [] : [text(row.depth_averaged_by_then)]), text(row.depth_averaged), ...(observed ? [text(row.observed)] : [])];
  };
  return { heads, rows: compared.rows.map((row) => ({ name: row.name, unit: row.unit, values: values(row) })) };
}

/** How far both cover the same ground. */
export function agreementText(compared: DepthAveragedComparison): string {
  const share = compared.area.intersection_over_union;
  const when = compared.over ? "" : ` by ${fixed(compared.time_s, 1)} s`;
  if (share === null) return `Neither model covers ground deeper than ${quantity(compared.least_depth_m, "m")}${when}.`;
  return `Agreement of the affected area${when}: ${fixed(100 * share, 0)} % (intersection over union, deeper than ${quantity(compared.least_depth_m, "m")}).`;
}
