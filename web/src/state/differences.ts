// What sets two scenarios apart, in a few words.
import type { ScenarioName } from "../protocol/frame";
import type { Parameter, Setup } from "../protocol/messages";
import { fields, type FieldDescription } from "../protocol/schema";
import { fixed, quantity, shownAs, tick, unitText } from "./format";
import type { Twin } from "./twin";

const shortLabel = (label: string): string => label.replace(/ coefficient$/, "");

const friction = "material.friction_coefficient";
/** Of one that follows another the other's difference says all. */
const follows = (key: string, setup: Setup): boolean => /friction/.test(key) && key !== friction && setup.parameters[key] === setup.parameters[friction];

/** Keys of the parameters whose values are not the same everywhere. */
export function changedKeys(setups: readonly Setup[]): string[] {
  const [first, ...others] = setups;
  return Object.keys(first?.parameters ?? {}).filter((key) => others.some((s) => s.parameters[key] !== first.parameters[key]));
}
function valueText(parameter: Parameter, setup: Setup): string {
  const value = setup.parameters[parameter.key] ?? null;
  return `${shortLabel(parameter.label)} ${value === null ? "none" : `${tick(value)}\u202f${unitText(parameter.unit)}`.trim()}`;
}

interface Named { id: string; name: string }
/** What a change of is no difference of the run from time 0. */
const passing = new Set(["name", "status", "start_time_s", "in_force"]);
const essence = (item: Named): string => JSON.stringify(item, (key, value: unknown) => (passing.has(key) ? undefined : value));

/** Where its values are described: see the schema. */
const sections = { releases: "release", barriers: "barrier", buildings: "buildings", zones: "zone", beds: "bed", inflows: "inflow" } as const;
type Kind = keyof typeof sections;

/** Its own values that the other one of that id has otherwise. No word of who was changed: of two scenarios either may be the one that was. */
function apart(kind: Kind, first: Named, other: Named): string {
  const [one, own] = [first, other].map((item) => item as unknown as Record<string, unknown>);
  const values = Object.entries<FieldDescription>(fields[sections[kind]]).flatMap(([key, about]) => {
    const value = own[key];
    return value === one[key] || typeof value !== "number" ? [] : [`${about.label.toLowerCase()} ${quantity(shownAs(about, value), about.unit)}`];
  });
  return values.length > 0 ? `${other.name} ${values.join(", ")}` : `${other.name} differs`;
}

function objectDifferences(kind: Kind, first: readonly Named[], other: readonly Named[]): string[] {
  const added = other.filter((o) => !first.some((f) => f.id === o.id)).map((o) => o.name);
  const gone = first.filter((f) => !other.some((o) => o.id === f.id)).map((f) => `no ${f.name}`);
  const both = other.flatMap((o) => first.filter((f) => f.id === o.id && essence(f) !== essence(o)).map((f) => apart(kind, f, o)));
  return [...added, ...gone, ...both];
}

/** Of `other` from `first`: "friction 0.27", "barrier 1", "no House 3". */
export function differences(first: Setup, other: Setup, parameters: readonly Parameter[]): string[] {
  if (first.scenario === other.scenario) return [];
  // In a title the friction that others follow stands for them; the table lists all.
  const keys = changedKeys([first, other]).filter((key) => ![first, other].every((s) => follows(key, s)));
  return [...parameters.filter((p) => keys.includes(p.key)).map((p) => valueText(p, other)),
    ...(Object.keys(sections) as Kind[]).flatMap((kind) => objectDifferences(kind, first[kind], other[kind]))];
}

const mostTold = 2;
/** "friction coefficient 0.4 -> 0.27 at 30.3 s", of many the last ones; empty: the run is that of its setup from time 0. */
export function changesText(setup: Setup | null): string {
  const changes = setup?.changes ?? [];
  const before = changes.length - mostTold;
  return (before > 0 ? `${before} ${before === 1 ? "change" : "changes"} from ${fixed(changes[0].time_s, 1)} s; ` : "") +
    changes.slice(-mostTold).map((c) => `${c.sentence} at ${fixed(c.time_s, 1)} s`).join("; ");
}

/** The name of a scenario with what sets it apart from the other one shown, or from the first. */
export function paneText(twin: Twin, name: ScenarioName): string {
  const setup = twin.cells[name].setup.value;
  const other = twin.cells[twin.shown.value.find((s) => s !== name) ?? "A"].setup.value;
  if (!setup || !other) return name;
  return [setup.name ? `${name} ${setup.name}` : name, ...differences(other, setup, twin.scene.parameters)].join(", ");
}
