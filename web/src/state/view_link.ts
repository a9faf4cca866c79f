// A view that a link opens: camera, map layer and scenarios, as text in the fragment of the link.
import { scenarioNames, type ScenarioName } from "../protocol/frame";
import { layerNames, type LayerName } from "../protocol/messages";
import type { Viewpoint } from "../scene/rig";

export interface LinkedView {
  camera: Viewpoint;
  layer: LayerName | "none";
  shown: ScenarioName[];
  /** See Twin.divider. */
  divider: number | null;
}

/** "x,y,z,x,y,z~peak_depth~AB~0.4": position and target, in a plan also its height, in metres from the scene's origin. */
export function viewText({ camera, layer, shown, divider }: LinkedView): string {
  const numbers = [...camera.position, ...camera.target, ...(camera.plan_m === undefined ? [] : [camera.plan_m])];
  return [numbers.map((v) => String(Math.round(10 * v) / 10)).join(","), layer, shown.join(""), ...(divider === null ? [] : [divider.toFixed(2)])].join("~");
}

/** null: no view that this program writes. */
export function viewOf(text: string): LinkedView | null {
  const [places, layer, names, share, ...more] = text.split("~");
  const numbers = places.split(",").map(Number);
  const shown = [...new Set(names)];
  const divider = share === undefined ? null : Number(share);
  const farthest_m = 1e6;
  if (more.length > 0 || (numbers.length !== 6 && numbers.length !== 7) || !numbers.every((v) => Math.abs(v) < farthest_m) || (numbers.length === 7 && numbers[6] <= 0)) return null;
  if (layer !== "none" && !layerNames.some((name) => name === layer)) return null;
  if (shown.length < 1 || shown.length > 2 || !shown.every((name) => scenarioNames.some((known) => known === name))) return null;
  if (divider !== null && !(divider > 0 && divider < 1)) return null;
  const [x, y, z, u, v, w, plan_m] = numbers;
  return { camera: { position: [x, y, z], target: [u, v, w], ...(plan_m === undefined ? {} : { plan_m }) }, layer: layer as LayerName | "none", shown: shown as ScenarioName[], divider };
}
