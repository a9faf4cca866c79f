// Triggers and alarms in words.
import type { Alerts, TriggeredRun } from "../protocol/messages";
import { fixed, quantity } from "./format";

/** What tells two runs of triggers apart. */
export const runKey = (run: TriggeredRun): string => `${run.scenario} ${run.trigger} ${run.received_at}`;
export const runKeys = (alerts: Alerts | null): string[] => alerts?.runs.map(runKey) ?? [];

/** "14:03:00" where the reader is, of a time in UTC. */
export function clockText(at: string | null, zone?: string): string {
  const time = new Date(at ?? "");
  return Number.isNaN(time.getTime()) ? "–" : time.toLocaleTimeString("en-GB", { hour12: false, ...(zone ? { timeZone: zone } : {}) });
}

/** "Started by trigger Gauge (MQTT) at 14:03:00: gauge 12 m³/s". */
export function startedText(run: TriggeredRun, zone?: string): string {
  const { volume_m3, pore_pressure_ratio, discharge_m3ps } = run.values;
  const said = [volume_m3 !== undefined && `volume ${quantity(volume_m3, "m3")}`,
    pore_pressure_ratio !== undefined && `pore pressure ratio ${fixed(pore_pressure_ratio, 2)}`,
    discharge_m3ps !== undefined && `gauge ${quantity(discharge_m3ps, "m3/s")}`, run.reason].filter(Boolean);
  return `Started by trigger ${run.trigger} (${run.source}) at ${clockText(run.received_at, zone)}${said.length > 0 ? `: ${said.join(", ")}` : ""}`;
}

export function readingText(run: TriggeredRun, zone?: string): string {
  return run.reading ? `Gauge now ${quantity(run.reading.discharge_m3ps, "m3/s")} (${clockText(run.reading.received_at, zone)})` : "";
}
