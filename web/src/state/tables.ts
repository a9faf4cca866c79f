// Observations, triggers and alarms: entries of the scene's tables, and what a form of one needs.
import type { FlowPath, Point, SceneInfo, Setup, TableEntry, TableKey, TableKind, TableSection, TableValue } from "../protocol/messages";
import { quantity, unitText } from "./format";

const titles: Readonly<Record<string, string>> = { observation: "Velocity", superelevation: "Superelevation in a bend", arrival: "Arrival of the front", run_up: "Run-up mark",
  deposit_depth: "Depth of the deposit", damage: "Damage to a building", observed_run_out: "Run-out", trigger: "Trigger", alarm: "Alarm" };
export const titleOf = (section: string): string => titles[section] ?? section;

export const sectionsOf = (scene: SceneInfo, kind: TableKind): TableSection[] => scene.table_sections.filter((s) => s.kind === kind);
export const sectionOf = (scene: SceneInfo, name: string): TableSection | undefined => scene.table_sections.find((s) => s.section === name);
export const entriesOf = (setup: Setup | null, kind: TableKind): readonly TableEntry[] =>
  setup === null ? [] : { observation: setup.observations, trigger: setup.triggers, alarm: setup.alarms }[kind];

/** m along the path, of its point that is nearest in plan. */
export function chainageAt(path: FlowPath | null, at: Point): number | null {
  let [best, found] = [Infinity, null as number | null];
  for (let k = 1; k < (path?.points.length ?? 0); ++k) {
    const [a, b] = [path!.points[k - 1], path!.points[k]];
    const [from, to] = [path!.chainage_m[k - 1], path!.chainage_m[k]];
    const [dx, dy] = [b[0] - a[0], b[1] - a[1]];
    const length = dx * dx + dy * dy;
    const t = length > 0 ? Math.min(1, Math.max(0, ((at[0] - a[0]) * dx + (at[1] - a[1]) * dy) / length)) : 0;
    const distance = Math.hypot(at[0] - a[0] - t * dx, at[1] - a[1] - t * dy);
    if (distance < best) [best, found] = [distance, from + t * (to - from)];
  }
  return found;
}

/** What a new entry at a place begins with. */
export function placeValues(section: TableSection, at: Point | null, path: FlowPath | null): Record<string, TableValue> {
  if (at === null) return {};
  const keys = section.keys.map(({ key }) => key);
  const places = { x_m: Number(at[0].toFixed(2)), y_m: Number(at[1].toFixed(2)) };
  if (section.one_of.some((keysOfOne) => keysOfOne.includes("x_m"))) return places;
  const chainage = keys.includes("chainage_m") ? chainageAt(path, at) : null;
  return { ...(keys.includes("x_m") ? places : {}), ...(chainage === null ? {} : { chainage_m: Number(chainage.toFixed(1)) }) };
}

/** A field's text as a value. Throws a sentence. */
export function valueFrom(key: TableKey, text: string): TableValue {
  const given = text.trim();
  if (given === "") return null;
  if (key.is !== "number") return given;
  const value = Number(given.replace(",", "."));
  if (!Number.isFinite(value)) throw new Error(`${key.label}: “${given}” is not a number${key.allowed ? `; it must be ${key.allowed}${key.unit ? ` ${unitText(key.unit)}` : ""}` : ""}`);
  return value;
}

/** What a field says below it: the range, where it is one (a coordinate has any value), and what no value means. */
export function hintOf(key: TableKey): string {
  const range = key.is === "number" && key.allowed && !/1000000000$/.test(key.allowed) ? `${key.allowed}${key.unit ? ` ${unitText(key.unit)}` : ""}` : "";
  const none = key.required || key.absent === "" || key.absent === "none" ? "" : `if empty: ${key.absent.replaceAll("_", " ")}`;
  return [key.help, [range, none].filter(Boolean).join("; ")].filter(Boolean).join(" ");
}

/** "chainage; one of front velocity, debris speed": what the server refuses to do without. */
export function needsText(section: TableSection): string {
  const label = (name: string): string => section.keys.find(({ key }) => key === name)?.label ?? name;
  const required = section.keys.filter((k) => k.required && k.key !== "name").map((k) => k.label);
  return [...required, ...section.one_of.map((keys) => `one of ${keys.map(label).join(", ")}`)].join("; ");
}

/** The values that say most of an entry, in a line. */
export function summaryOf(section: TableSection | undefined, entry: TableEntry): string {
  return (section?.keys ?? []).filter(({ key }) => !["name", "source", "message", "building", "x_m", "y_m"].includes(key) && !key.startsWith("uncertainty"))
    .flatMap(({ key, label, unit, is, default: usual }) => {
      const value = entry.values[key];
      if (value === null || value === undefined || value === usual) return [];
      return [is === "number" ? `${label} ${quantity(value as number, unit)}` : is === "boolean" ? (value ? label : `not ${label}`) : `${value}`];
    }).join(", ");
}

/** Where an entry is: its place, or that of its chainage; null: it has none. */
export function placeOf(entry: TableEntry, onPath: (chainage: number) => Point | null): Point | null {
  const { x_m, y_m, chainage_m } = entry.values;
  if (typeof x_m === "number" && typeof y_m === "number") return [x_m, y_m];
  return typeof chainage_m === "number" ? onPath(chainage_m) : null;
}

/** Over its place: "Bend, debris 11.0 m/s". */
export function observationText({ section, name, values }: TableEntry): string {
  const told = section === "observation" ? (typeof values["debris_speed_mps"] === "number" ? `debris ${quantity(values["debris_speed_mps"], "m/s")}` : `front ${quantity(values["front_velocity_mps"] as number, "m/s")}`)
    : section === "arrival" ? quantity(values["time_s"] as number, "s") : section === "run_up" ? quantity(values["height_m"] as number, "m")
      : section === "deposit_depth" ? quantity(values["depth_m"] as number, "m") : "";
  return [name, told].filter(Boolean).join(", ");
}

/** Of the front's chart: velocities at chainages. */
export function observedVelocities(setup: Setup | null, key: "front_velocity_mps" | "debris_speed_mps"): { chainage_m: number; mps: number }[] {
  return entriesOf(setup, "observation").flatMap(({ section, values }) =>
    section === "observation" && typeof values[key] === "number" ? [{ chainage_m: values["chainage_m"] as number, mps: values[key] as number }] : []);
}
