// The map layers: names, units, colours, and how a grid becomes something that lies on the ground.
import { DataTexture, FloatType, LinearFilter, RGFormat, Vector4 } from "three";
import type { Grid } from "../protocol/grid";
import type { LayerName, Place } from "../protocol/messages";
import { ramps, roundStep, type Ramp } from "./colour";
import type { Draped } from "./ground";

export interface LayerInfo {
  title: string;
  unit: string;
  ramp: Ramp;
  help: string;
}

export const layerInfo: Record<LayerName, LayerInfo> = {
  depth: { title: "Depth now", unit: "m", ramp: ramps.depth, help: "Flow depth, vertical, at this moment" },
  peak_depth: { title: "Peak depth", unit: "m", ramp: ramps.peak_depth, help: "Largest flow depth so far, vertical" },
  peak_speed: { title: "Peak speed", unit: "m/s", ramp: ramps.peak_speed, help: "Largest depth-averaged speed so far" },
  peak_pressure: { title: "Peak pressure", unit: "kPa", ramp: ramps.peak_pressure, help: "Largest impact pressure so far: rest density times speed squared" },
  arrival_time: { title: "Arrival time", unit: "s", ramp: ramps.arrival_time, help: "When debris first came" },
  deposit_depth: { title: "Deposit depth", unit: "m", ramp: ramps.deposit_depth, help: "Depth of debris as it lies" },
};

/** Values below this are not drawn; times count from 0. */
const least: Record<LayerName, number> = {
  depth: 0.01, peak_depth: 0.01, peak_speed: 0.05, peak_pressure: 0.01, arrival_time: 0, deposit_depth: 0.02,
};

/** Values of the layer that are shown, NaN elsewhere. */
export function shownValues(name: LayerName, grid: Grid): Float32Array {
  return grid.values.map((v) => (v >= least[name] ? v : NaN));
}

/** Round end of the scale: at or above all but the largest half per cent of values, so that one odd cell does not set it. */
export function scaleEnd(values: Float32Array): number {
  const some = values.filter((v) => !Number.isNaN(v)).sort();
  if (some.length === 0) return 1;
  return roundStep(some[Math.floor(0.995 * (some.length - 1))]);
}

/** B - A on the same grid: a cell that only one of them reached counts as 0 in the other. Times: only where both have one. */
export function differenceOf(name: LayerName, a: Grid, b: Grid): Float32Array {
  const va = shownValues(name, a);
  const vb = shownValues(name, b);
  return vb.map((v, k) => {
    const w = va[k];
    if (Number.isNaN(v) && Number.isNaN(w)) return NaN;
    if (name === "arrival_time") return v - w;
    return (Number.isNaN(v) ? 0 : v) - (Number.isNaN(w) ? 0 : w);
  });
}

export function drapedFrom(grid: Grid, values: Float32Array, origin: Place): Draped {
  // Value times cover and cover: filtering the pair gives edges without a fringe of zeros.
  const pairs = new Float32Array(2 * values.length);
  for (let k = 0; k < values.length; ++k) {
    const v = values[k];
    if (Number.isNaN(v)) continue;
    pairs[2 * k] = v;
    pairs[2 * k + 1] = 1;
  }
  const texture = new DataTexture(pairs, grid.columns, grid.rows, RGFormat, FloatType);
  texture.internalFormat = "RG16F";
  texture.minFilter = texture.magFilter = LinearFilter;
  texture.needsUpdate = true;
  const placing = new Vector4(grid.west - origin[0], grid.south - origin[1], 1 / (grid.columns * grid.cell), 1 / (grid.rows * grid.cell));
  return { texture, placing };
}
