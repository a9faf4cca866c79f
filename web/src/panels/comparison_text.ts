// What the panel that compares two scenarios and the report of it both say.
import type { ScenarioName } from "../protocol/messages";
import { changesText } from "../state/differences";
import { fixed, tick } from "../state/format";
import { standingText } from "../state/standing";
import type { Twin } from "../state/twin";

export const shownValue = (value: number | string | null): string => (typeof value === "string" ? value : tick(value ?? NaN));
/** "End reached, 30.0 s"; and what was changed on the way. */
export function standing(twin: Twin, name: ScenarioName): string {
  const { state, setup } = twin.cells[name];
  const changes = changesText(setup.value);
  return `${state.value ? standingText(state.value) : ""}${changes ? `; changed on the way: ${changes}` : ""}`;
}

/** How far a run has come, which its figures are of. */
export const timeSoFar = (twin: Twin, name: ScenarioName): string => `${fixed(twin.cells[name].state.value?.time_s, 1)}\u202fs`;
