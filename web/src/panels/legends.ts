// Legends with units, compass, scale bar, contour interval.
import { css, divergingAt, rampAt, ramps, roundStep, type Rgb } from "../scene/colour";
import { contourInterval } from "../scene/ground";
import type { Category } from "../protocol/messages";
import { colourOf, infoOf, isDepthAveragedLayer, isEnsembleLayer, layerInfo } from "../scene/layers";
import type { ShownLayers } from "../scene/shown_layers";
import type { Stage } from "../scene/stage";
import { watchAll } from "../state/cell";
import { largestPressure } from "./impacts";
import { sourceText } from "../state/depth_averaged";
import { changesText } from "../state/differences";
import { fixed, quantity, tick, unitText } from "../state/format";
import type { Twin } from "../state/twin";
import { h } from "../ui/dom";

/** categories: names of even classes from low to high, in place of a scale. */
export interface Legend { title: string; unit: string; low: number; high: number; at: (share: number) => Rgb; note?: string; from?: string; categories?: readonly Category[] }

const pastNote = "Rebuilt from the recording: peaks between recorded frames are missed, so values can be slightly low.";

/** Legends of the current display, also for pictures of the view. */
export function presentLegends(twin: Twin, stage: Stage, layers: ShownLayers): Legend[] {
  const list: Legend[] = [];
  if ((twin.particles.value && !twin.natural) || twin.surface.value === "speed") {
    list.push({ title: "Speed of debris", unit: "m/s", low: 0, high: stage.fastest_mps.value, at: (s) => rampAt(ramps.speed, s) });
  }
  if (twin.surface.value === "depth") {
    list.push({ title: "Flow depth", unit: "m", low: 0, high: layers.surfaceTop, at: (s) => rampAt(ramps.surface_depth, s) });
  }
  const most = Math.max(...twin.shown.value.map((s) => largestPressure(twin.cells[s].impacts.value)));
  if (twin.houseColour.value === "pressure" && most > 0) {
    list.push({ title: "Houses, impact pressure", unit: "kPa", low: 0, high: most, at: (s) => rampAt(ramps.impact_pressure, s) });
  }
  const name = twin.layer.value;
  if (name !== "none") {
    const info = infoOf(name, twin.ensembles.value);
    const [low, high] = layers.range.value;
    const time = layers.shown_s.value;
    if (isEnsembleLayer(name)) {
      list.push({ title: info.title, unit: info.unit, low, high, at: (s) => colourOf(info, s), note: info.help,
        ...(info.from ? { from: info.from } : {}), ...(info.categories ? { categories: info.categories } : {}) });
      return list;
    }
    if (isDepthAveragedLayer(name)) {
      list.push({ title: info.title + (layers.isDifference ? `, ${twin.differenceName}` : ""), unit: info.unit, low, high, note: info.help,
        at: (s) => (layers.isDifference ? divergingAt(2 * s - 1) : rampAt(info.ramp, s)), from: [...new Set(twin.shown.value.map((s) => sourceText(twin.cells[s].depthAveraged.value)))].join("; ") });
      return list;
    }
    const { kind } = layerInfo[name];
    const title = (name === "depth" && time !== null ? "Depth" : info.title) + (layers.isDifference ? `, ${twin.differenceName}` : "") +
      (time === null ? "" : kind === "present" || name === "pore_pressure_ratio" ? ` at ${fixed(time, 1)} s` : ` until ${fixed(time, 1)} s`);
    list.push(layers.isDifference ? { title, unit: info.unit, low, high, at: (s) => divergingAt(2 * s - 1) }
      : { title, unit: info.unit, low, high, at: (s) => rampAt(info.ramp, s), ...(time !== null && kind === "peak" ? { note: pastNote } : {}) });
  }
  return list;
}

function ticks(low: number, high: number): number[] {
  const step = roundStep((high - low) / 4.5);
  const list = [];
  for (let v = Math.ceil(low / step - 1e-9) * step; v <= high + 1e-9 * step; v += step) list.push(Math.abs(v) < 1e-9 ? 0 : v);
  return list;
}

export function legends(twin: Twin, stage: Stage, layers: ShownLayers): HTMLElement {
  const holder = h("div", { class: "legends", role: "group", "aria-label": "Legends" });
  const classes = h("div", { class: "legend classes-legend" }, h("div", { class: "legend-title" }, h("b", {}, "Houses, intensity")),
    ...twin.scene.intensity.classes.map((c) => {
      const dot = h("i", { class: "dot" });
      dot.style.background = c.colour;
      return h("span", {}, dot, c.name);
    }));
  classes.title = twin.scene.intensity.rule;
  watchAll([twin.look, twin.particles, twin.surface, twin.layer, twin.difference, layers.range, layers.shown_s, stage.fastest_mps, twin.houseColour, twin.shown, ...twin.every("impacts"), ...twin.every("setup"), ...twin.every("depthAveraged")], () => {
    const anyHit = twin.shown.value.some((s) => twin.cells[s].impacts.value?.buildings.some((b) => b.hit));
    const present = presentLegends(twin, stage, layers);
    classes.hidden = twin.houseColour.value !== "intensity" || !anyHit;
    const changed = twin.shown.value.filter((s) => (twin.cells[s].setup.value?.changes.length ?? 0) > 0);
    const note = h("div", { class: "legend on-the-way" }, `${twin.shown.value.length > 1 ? `${changed.join(", ")} c` : "C"}hanged on the way: not the results of one setup`);
    note.title = changed.map((s) => changesText(twin.cells[s].setup.value)).join("; ");
    note.hidden = changed.length === 0;
    holder.hidden = classes.hidden && note.hidden && present.length === 0;
    holder.replaceChildren(note, classes, ...present.map((legend) => {
      const from = legend.from ? h("div", { class: "legend-from" }, legend.from) : null;
      if (legend.categories) {
        const list = legend.categories.map((c) => {
          const dot = h("i", { class: "dot" });
          dot.style.background = c.colour;
          return h("div", { class: "legend-category" }, dot, c.name);
        });
        return h("div", { class: "legend", ...(legend.note ? { title: legend.note } : {}) }, h("div", { class: "legend-title" }, h("b", {}, legend.title)), ...list.reverse(), from);
      }
      const bar = h("div", { class: "legend-bar" });
      const stops = Array.from({ length: 17 }, (_, i) => css(legend.at(i / 16)));
      bar.style.background = `linear-gradient(to right, ${stops.join(", ")})`;
      const scale = h("div", { class: "legend-ticks" });
      for (const value of ticks(legend.low, legend.high)) {
        const mark = h("span", {}, tick(value));
        mark.style.left = `${(100 * (value - legend.low)) / (legend.high - legend.low)}%`;
        scale.append(mark);
      }
      return h("div", { class: "legend", role: "img", ...(legend.note ? { title: legend.note } : {}),
        "aria-label": `${legend.title}: colours from ${quantity(legend.low, legend.unit)} to ${quantity(legend.high, legend.unit)}${legend.from ? `; ${legend.from}` : ""}` },
      h("div", { class: "legend-title" }, h("b", {}, legend.title), h("span", {}, unitText(legend.unit))), bar, scale,
      from);
    }));
  });
  return holder;
}

export function scaleAndCompass(twin: Twin, stage: Stage, readOut: HTMLElement): HTMLElement {
  const needle = h("div", { class: "needle" }, h("i", {}), h("b", {}, "N"));
  const compass = h("button", { type: "button", class: "compass", "aria-label": "Compass: turn the view north up", title: "North; click for the top view",
    onclick: () => stage.rig.top() }, needle);
  const bar = h("div", { class: "scale-bar" });
  const text = h("span", {});
  const scale = h("div", { class: "scale" }, text, bar);
  stage.onCamera(() => {
    needle.style.transform = `rotate(${stage.rig.turn}rad)`;
    scale.title = stage.rig.mode === "plan" ? "Scale of the plan" : "Scale at the middle of the view";
    const perPixel = stage.metresPerPixel;
    const length = roundStep(perPixel * 60);
    bar.style.width = `${Math.round(length / perPixel)}px`;
    text.textContent = length >= 1000 ? `${tick(length / 1000)}\u202fkm` : `${tick(length)}\u202fm`;
  });
  const note = h("div", { class: "map-note" });
  watchAll([twin.contours, twin.look, twin.layer, twin.surface], () => {
    // The natural look draws none.
    const drawn = twin.contours.value && !twin.natural;
    note.textContent = `${drawn ? `Contours every ${tick(contourInterval(stage.relief))}\u202fm · ` : ""}${twin.scene.crs}`;
  });
  return h("div", { class: "map-marks" }, compass, scale, readOut, note);
}
