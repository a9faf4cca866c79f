// The map layers: names, units, colours, and the conversion of a grid to a texture on the ground.
import { DataTexture, FloatType, LinearFilter, NearestFilter, RGFormat, Vector4 } from "three";
import type { Grid } from "../protocol/grid";
import type { DepthAveragedLayer, EnsembleLayer, ShownLayer } from "../protocol/layers";
import { maps, type MapName } from "../protocol/maps";
import { quantityNames, type Category, type Ensemble, type EnsembleMap, type LayerName, type Place } from "../protocol/messages";
import { fromHex, rampAt, ramps, roundStep, type Ramp, type Rgb } from "./colour";
import type { Draped } from "./ground";

export interface LayerInfo {
  title: string;
  unit: string;
  ramp: Ramp;
  help: string;
  /** For a map of an ensemble: its source. */
  from?: string;
  /** Of the values 1, 2, ...; then the ramp is not used. */
  categories?: readonly Category[];
}

/** A layer of a run. */
interface RunLayer extends LayerInfo {
  /** From what the server sends, SI units, to the unit. */
  factor: number;
  /** Of a map, and of the depth of the moment; null: of none. */
  kind: (typeof maps)[MapName]["kind"] | null;
  /** Values below this are not drawn; times count from 0. */
  least: number;
}

export const layerInfo: Record<LayerName, RunLayer> = {
  depth: { title: "Depth now", unit: "m", factor: 1, kind: "present", least: 0.01, ramp: ramps.depth, help: "Flow depth, vertical, at this moment" },
  ...maps,
  pore_pressure_ratio: { title: "Pore-pressure ratio", unit: "", factor: 1, kind: null, least: 0, ramp: ramps.pore_pressure_ratio, help: "Pore pressure at this moment, over the weight of the debris above: 1 bears all of it" },
  erosion_depth: { title: "Erosion", unit: "m", factor: 1, kind: null, least: 0, ramp: ramps.erosion_depth, help: "Depth that debris entrained from the bed, vertical: the ground is lower by it" },
};

export const isEnsembleLayer = (name: ShownLayer | "none"): name is EnsembleLayer => name.startsWith("ensemble/");
const ofDepthAveraged = "depth_averaged/";
export const isDepthAveragedLayer = (name: ShownLayer | "none"): name is DepthAveragedLayer => name.startsWith(ofDepthAveraged);
/** The map of the depth-averaged model that shows what this one of the run does; null: it has none. */
export function depthAveragedLayer(name: LayerName): DepthAveragedLayer | null {
  const quantity = quantityNames.find((q) => q === name);
  return quantity ? `${ofDepthAveraged}${quantity}` : null;
}
/** What a layer of either model shows. */
export const quantityOf = (name: LayerName | DepthAveragedLayer): LayerName => (isDepthAveragedLayer(name) ? name.slice(ofDepthAveraged.length) as LayerName : name);
export const ensembleLayer = (ensemble: Ensemble, map: EnsembleMap): EnsembleLayer => `ensemble/${ensemble.id}/${map.name}`;
const plural = (count: number, what: string): string => `${count} ${what}${count === 1 ? "" : "s"}`;

export function ensembleTitle(ensemble: Ensemble): string {
  return `${ensemble.name}, ${plural(ensemble.runs, "run")}${ensemble.failed > 0 ? `, ${ensemble.failed} failed` : ""}`;
}
export function findMap(ensembles: readonly Ensemble[], name: EnsembleLayer): { ensemble: Ensemble; map: EnsembleMap } | null {
  for (const ensemble of ensembles) {
    for (const map of ensemble.maps) if (ensembleLayer(ensemble, map) === name) return { ensemble, map };
  }
  return null;
}
/** Name and colours of a layer. */
export function infoOf(name: ShownLayer, ensembles: readonly Ensemble[]): LayerInfo {
  if (isDepthAveragedLayer(name)) {
    const info = layerInfo[quantityOf(name)];
    return { ...info, title: `${info.title}, depth-averaged`, help: `${info.help.replace(/ so far/, "")}, of the depth-averaged model of the present setup, from time 0` };
  }
  if (!isEnsembleLayer(name)) return layerInfo[name];
  const found = findMap(ensembles, name);
  if (!found) return { title: "Map of an ensemble", unit: "", ramp: ramps.probability, help: "" };
  const { ensemble, map } = found;
  const runs = `${plural(ensemble.runs, "run")} of the ensemble ${ensemble.name}, with ${ensemble.factors.map((f) => `${f.key} ${f.distribution}`).join(", ")}`;
  const what = map.title.replace(/^Probability of /, "");
  const help = map.kind === "zones" ? `${map.description}; from ${runs}`
    : map.kind === "percentile" ? `${map.percentile} % of ${runs}, do not exceed this`
    : `Share of ${runs}, ${map.threshold === null ? `with ${what}` : `in which ${what} is exceeded`}`;
  return {
    title: map.title, unit: map.unit, ramp: map.kind === "percentile" && map.of !== "intensity" ? layerInfo[map.of].ramp : ramps.probability,
    ...(map.categories.length > 0 ? { categories: map.categories } : {}),
    help: help + (ensemble.same_terrain ? "" : ". Computed on another terrain file than this scene's") + (map.greatest === null ? ". Nowhere in any run" : ""),
    from: ensembleTitle(ensemble) + (ensemble.same_terrain ? "" : ", other terrain") + (map.greatest === null ? ": nowhere" : ""),
  };
}
/** Display options of an ensemble's map, NaN elsewhere; a place that no run reached is not part of it. */
export function shownOfMap(map: EnsembleMap, grid: Grid): Float32Array {
  const shown = map.kind === "percentile" && map.of !== "intensity" ? layerInfo[map.of].least : 1e-6;
  return grid.values.map((v) => (v >= shown ? v : NaN));
}
/** Ends of its scale: every probability has the same, so that thresholds can be compared; of zones, half a class beyond the first and the last. */
export function rangeOfMap(map: EnsembleMap, values: Float32Array): [number, number] {
  if (map.kind === "zones") return [0.5, map.categories.length + 0.5];
  return [0, map.kind === "probability" ? 100 : scaleEnd(values)];
}
/** Colour at a share of a layer's scale. */
export function colourOf(info: LayerInfo, share: number): Rgb {
  const { categories } = info;
  if (!categories) return rampAt(info.ramp, share);
  return fromHex(categories[Math.min(categories.length - 1, Math.max(0, Math.floor(share * categories.length)))].colour);
}

/** A layer of the run in the unit of its legend: the server sends SI units. */
export function inUnit(name: LayerName, grid: Grid): Grid {
  const { factor } = layerInfo[name];
  return factor === 1 ? grid : { ...grid, values: grid.values.map((v) => factor * v) };
}

/** Values of the layer that are shown, NaN elsewhere. */
export function shownValues(name: LayerName, grid: Grid): Float32Array {
  const { least } = layerInfo[name];
  return grid.values.map((v) => (v >= least ? v : NaN));
}

/**
 * Round end of the scale: at or above all but the largest half per cent of values, so that a single outlier does not
 * set it.
 */
export function scaleEnd(values: Float32Array): number {
  const some = values.filter((v) => !Number.isNaN(v)).sort();
  if (some.length === 0) return 1;
  return roundStep(some[Math.floor(0.995 * (some.length - 1))]);
}

/**
 * B - A on the smallest grid that holds both: a server sends a layer only as far as debris spread. A cell that only
 * one of them reached counts as 0 in the other. Times: only where both have one.
 */
export function differenceOf(name: LayerName, a: Grid, b: Grid): Grid {
  const { cell } = a;
  const west = Math.min(a.west, b.west);
  const south = Math.min(a.south, b.south);
  const columns = Math.round((Math.max(a.west + a.columns * cell, b.west + b.columns * cell) - west) / cell);
  const rows = Math.round((Math.max(a.south + a.rows * cell, b.south + b.rows * cell) - south) / cell);
  const spread = (grid: Grid): Float32Array => {
    const out = new Float32Array(columns * rows).fill(NaN);
    const shown = shownValues(name, grid);
    const left = Math.round((grid.west - west) / cell);
    const low = Math.round((grid.south - south) / cell);
    for (let j = 0; j < grid.rows; ++j) out.set(shown.subarray(j * grid.columns, (j + 1) * grid.columns), (low + j) * columns + left);
    return out;
  };
  const va = spread(a);
  const values = spread(b).map((v, k) => {
    const w = va[k];
    if (Number.isNaN(v) && Number.isNaN(w)) return NaN;
    // There is none of these where there is no debris.
    if (layerInfo[name].kind === "arrival" || name === "pore_pressure_ratio") return v - w;
    return (Number.isNaN(v) ? 0 : v) - (Number.isNaN(w) ? 0 : w);
  });
  return { west, south, cell, columns, rows, values };
}

/** smooth: interpolated between cells, as classes must not be. */
export function drapedFrom(grid: Grid, origin: Place, smooth = true): Draped {
  const { values } = grid;
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
  texture.minFilter = texture.magFilter = smooth ? LinearFilter : NearestFilter;
  texture.needsUpdate = true;
  const placing = new Vector4(grid.west - origin[0], grid.south - origin[1], 1 / (grid.columns * grid.cell), 1 / (grid.rows * grid.cell));
  return { texture, placing };
}
