// How a run stands, in words.
import type { State } from "../protocol/messages";
import { fixed, quantity } from "./format";

export const statusWords = { running: "Running", paused: "Paused", at_rest: "At rest", ended: "End reached", fault: "Stopped by a fault" } as const;

/** "End reached, 30.0 s; 12.6 m³ still moving". A run whose stop rule ended it while debris moves is not at rest. */
export function standingText(state: State, withTime = true): string {
  const over = state.status === "ended" || state.status === "at_rest";
  const moving = over && state.volume_moving_m3 > 0;
  return (moving && state.status === "at_rest" ? "Stopped" : statusWords[state.status]) + (withTime ? `, ${fixed(state.time_s, 1)} s` : "") +
    (moving ? `; ${quantity(state.volume_moving_m3, "m3")} still moving` : "");
}
