// Triggers and alarms in words.
import type { Alerts, RaisedAlarm, TriggeredRun } from "../protocol/messages";
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

/** What tells two alarms apart, also of runs that were started again in one place. */
export const alarmKey = (alarm: RaisedAlarm): string => [alarm.scenario, alarm.alarm, alarm.raised_at, alarm.hash].join(" ");

/** Alarms from their raising until this person has acknowledged them, also of a run that was started again or has ended meanwhile. */
export class AlarmBook {
  private readonly open = new Map<string, RaisedAlarm>();

  constructor(private readonly acknowledged: Set<string>, private readonly keep: (acknowledged: readonly string[]) => void = () => {}) {}

  /** Returns those that are new. Alarms of a saved session have no time of day: nobody is alarmed again. */
  hear(alarms: readonly RaisedAlarm[]): RaisedAlarm[] {
    const fresh = alarms.filter((alarm) => alarm.raised_at !== null && !this.open.has(alarmKey(alarm)) && !this.acknowledged.has(alarmKey(alarm)));
    for (const alarm of fresh) this.open.set(alarmKey(alarm), alarm);
    return fresh;
  }
  acknowledge(alarms: readonly RaisedAlarm[]): void {
    for (const alarm of alarms) {
      this.open.delete(alarmKey(alarm));
      this.acknowledged.add(alarmKey(alarm));
    }
    this.keep([...this.acknowledged]);
  }
  /** The newest first. */
  get pending(): readonly RaisedAlarm[] {
    return [...this.open.values()].reverse();
  }
}
