// Above each of two views: which scenario it is, at what time, and whether its map is a difference. The one that the controls edit is marked.
import type { ScenarioName } from "../protocol/frame";
import type { ShownLayers } from "../scene/shown_layers";
import type { Stage } from "../scene/stage";
import { watchAll } from "../state/cell";
import { paneText } from "../state/differences";
import { fixed } from "../state/format";
import type { Twin } from "../state/twin";
import { h } from "../ui/dom";

export function paneNames(twin: Twin, stage: Stage, layers: ShownLayers): void {
  const times = new Map<ScenarioName, { element: HTMLElement; tenths: number }>();
  // Written only where a tenth of a second has passed: a picture makes no text.
  const put = (): void => {
    for (const [name, time] of times) {
      const tenths = Math.round(10 * (stage.timeOf(name) ?? NaN));
      if (Object.is(tenths, time.tenths)) continue;
      time.tenths = tenths;
      time.element.textContent = Number.isNaN(tenths) ? "" : `, ${fixed(tenths / 10, 1)}\u202fs`;
    }
  };
  watchAll([twin.shown, twin.edited, twin.layer, twin.difference, ...twin.every("setup")], () => {
    times.clear();
    for (const name of twin.shown.value) {
      const pane = stage.pane(name);
      pane?.querySelector(".pane-name")?.remove();
      if (twin.shown.value.length < 2) continue;
      const element = h("span", { class: "pane-time" });
      times.set(name, { element, tenths: NaN });
      const map = layers.isDifference ? h("div", { class: "pane-map" }, `Map: ${twin.differenceName}; debris of ${name}`) : null;
      pane?.append(h("div", { class: `pane-name${name === twin.edited.value ? " edited" : ""}` }, h("span", {}, paneText(twin, name)), element, map));
    }
    put();
  });
  stage.onPicture(put);
}
