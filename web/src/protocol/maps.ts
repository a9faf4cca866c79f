// Made from src/core/hazard_maps.hpp: edit that; docs/protocol.md tells how this is made again.

/** The maps that every run has. `factor`: from what the server sends to `unit`; below `least`, in `unit`, nothing is drawn. */
export const maps = {
  peak_depth: {
    title: "Peak depth", unit: "m", factor: 1, kind: "peak", least: 0.01,
    ramp: { lowHue: 205, lowChroma: 0.05, highHue: 268, highChroma: 0.15, lowLightness: 0.9, highLightness: 0.28 },
    help: "Largest flow depth so far, vertical",
  },
  peak_speed: {
    title: "Peak speed", unit: "m/s", factor: 1, kind: "peak", least: 0.05,
    ramp: { lowHue: 104, lowChroma: 0.11, highHue: 8, highChroma: 0.13, lowLightness: 0.93, highLightness: 0.28 },
    help: "Largest depth-averaged speed so far",
  },
  peak_pressure: {
    title: "Peak dynamic pressure", unit: "kPa", factor: 0.001, kind: "peak", least: 0.01,
    ramp: { lowHue: 88, lowChroma: 0.08, highHue: -48, highChroma: 0.14, lowLightness: 0.93, highLightness: 0.26 },
    help: "Largest dynamic pressure of the free flow so far: density times speed squared",
  },
  arrival_time: {
    title: "Arrival time", unit: "s", factor: 1, kind: "arrival", least: 0,
    ramp: { lowHue: 215, lowChroma: 0.06, highHue: 118, highChroma: 0.1, lowLightness: 0.3, highLightness: 0.92 },
    help: "Time when debris first arrived",
  },
  deposit_depth: {
    title: "Deposit depth", unit: "m", factor: 1, kind: "present", least: 0.02,
    ramp: { lowHue: 92, lowChroma: 0.07, highHue: 42, highChroma: 0.09, lowLightness: 0.92, highLightness: 0.28 },
    help: "Depth of debris as it lies",
  },
} as const;
export type MapName = keyof typeof maps;
