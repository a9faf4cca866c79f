// What sets two scenarios apart, in a few words.
import type { ScenarioName } from "../protocol/frame";
import type { Parameter, Setup } from "../protocol/messages";
import { fixed, tick, unitText } from "./format";
import type { Twin } from "./twin";

const shortLabel = (label: string): string => label.replace(/ coefficient$/, "");

const friction = "material.friction_coefficient";
/** Of one that follows another the other's difference says all. */
const follows = (key: string, setup: Setup): boolean => /friction/.test(key) && key !== friction && setup.parameters[key] === setup.parameters[friction];

/** Keys of the parameters whose values are not the same everywhere. */
export function differingKeys(setups: readonly Setup[]): string[] {
  const [first, ...others] = setups;
  return Object.keys(first?.parameters ?? {}).filter((key) =>
    others.some((s) => s.parameters[key] !== first.parameters[key]) && !setups.every((s) => follows(key, s)));
}
function valueText(parameter: Parameter, setup: Setup): string {
  const value = setup.parameters[parameter.key] ?? null;
  return `${shortLabel(parameter.label)} ${value === null ? "none" : `${tick(value)}\u202f${unitText(parameter.unit)}`.trim()}`;
}

interface Named { id: string; name: string }
/** What a change of is no difference of the run from time 0. */
const passing = new Set(["name", "status", "start_time_s", "in_force"]);
const essence = (item: Named): string => JSON.stringify(item, (key, value: unknown) => (passing.has(key) ? undefined : value));

function objectDifferences(first: readonly Named[], other: readonly Named[]): string[] {
  const added = other.filter((o) => !first.some((f) => f.id === o.id)).map((o) => o.name);
  const gone = first.filter((f) => !other.some((o) => o.id === f.id)).map((f) => `no ${f.name}`);
  const changed = other.filter((o) => first.some((f) => f.id === o.id && essence(f) !== essence(o))).map((o) => `${o.name} changed`);
  return [...added, ...gone, ...changed];
}

/** Of `other` from `first`: "friction 0.27", "barrier 1", "no House 3". */
export function differences(first: Setup, other: Setup, parameters: readonly Parameter[]): string[] {
  if (first.scenario === other.scenario) return [];
  const keys = differingKeys([first, other]);
  return [...parameters.filter((p) => keys.includes(p.key)).map((p) => valueText(p, other)),
    ...(["releases", "barriers", "buildings", "zones", "beds", "inflows"] as const).flatMap((kind) => objectDifferences(first[kind], other[kind]))];
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
