// What the page shows on the ground: names of its own, made of those that the server has.
import type { LayerName, QuantityName } from "./messages";

/** A map of an ensemble: its id and its name. */
export type EnsembleLayer = `ensemble/${string}/${string}`;
export type DepthAveragedLayer = `depth_averaged/${QuantityName}`;
/** Of the run, of the depth-averaged model, or a map of an ensemble. */
export type ShownLayer = LayerName | DepthAveragedLayer | EnsembleLayer;
