// A cross-section: ground, debris as displayed now, and the peak so far, along a line that the user drew.
import type { Frame } from "../protocol/frame";
import { gridAt, type Grid } from "../protocol/grid";
import type { Point, SceneInfo } from "../protocol/messages";
import type { Stage } from "../scene/stage";
import { watchAll } from "../state/cell";
import { fixed, quantity } from "../state/format";
import { length } from "../state/shapes";
import type { Twin } from "../state/twin";
import { button, h } from "../ui/dom";
import { Chart } from "./chart";

/** Depth at a world place in a frame's window, m; 0 outside it. */
export function frameDepthAt(frame: Frame, scene: SceneInfo, x: number, y: number): number {
  const { column, row, columns, rows } = frame.window;
  const u = (x - scene.map.x_min_m) / scene.map.cell_m - 0.5 - column;
  const v = (y - scene.map.y_min_m) / scene.map.cell_m - 0.5 - row;
  const i = Math.floor(u);
  const j = Math.floor(v);
  let sum = 0;
  for (let dj = 0; dj < 2; ++dj) {
    for (let di = 0; di < 2; ++di) {
      const c = i + di;
      const r = j + dj;
      if (c < 0 || r < 0 || c >= columns || r >= rows) continue;
      sum += (di ? u - i : 1 - u + i) * (dj ? v - j : 1 - v + j) * frame.depth[r * columns + c];
    }
  }
  return sum * frame.depthUnit_m;
}

export function sectionStations(line: readonly Point[], count = 160): { along: number; at: Point }[] {
  const whole = length(line);
  const stations: { along: number; at: Point }[] = [];
  let k = 1;
  let before = 0;
  for (let s = 0; s < count; ++s) {
    const along = (whole * s) / (count - 1);
    for (;;) {
      const part = Math.hypot(line[k][0] - line[k - 1][0], line[k][1] - line[k - 1][1]);
      if (along <= before + part + 1e-9 || k === line.length - 1) {
        const t = part > 0 ? Math.min(1, (along - before) / part) : 0;
        stations.push({ along, at: [line[k - 1][0] + t * (line[k][0] - line[k - 1][0]), line[k - 1][1] + t * (line[k][1] - line[k - 1][1])] });
        break;
      }
      before += part;
      ++k;
    }
  }
  return stations;
}

export function sectionPanel(twin: Twin, stage: Stage): { element: HTMLElement; refresh(): void } {
  const heights = new Chart({ title: "Section, heights", x: { label: "Distance", unit: "m" }, y: { label: "Height", unit: "m" }, curves: [], height: 230,
    empty: "Choose “Draw a section”, then click two points on the ground, across the channel. “Measure” makes one along any line." });
  const depths = new Chart({ title: "Depth along the section", x: { label: "Distance", unit: "m" }, y: { label: "Depth", unit: "m" }, curves: [], height: 150,
    empty: "The depth along the line is plotted here." });
  const draw = button("Draw a section", { icon: "section", class: "small", onclick: () =>
    (twin.tool.value = twin.tool.value.kind === "section" ? { kind: "none" } : { kind: "section" }) });
  const clear = button("Remove", { class: "small quiet", onclick: () => (twin.section.value = null) });
  const note = h("output", { class: "measure" });
  let peak: Grid | null = null;
  let asked = 0;
  let shown_ms = 0;

  const plot = (): void => {
    const line = twin.section.value;
    clear.hidden = line === null;
    if (!line) {
      note.value = "";
      heights.update([[]]);
      depths.update([[]]);
      return;
    }
    const frame = stage.views.get(twin.edited.value)?.clock.next ?? null;
    const stations = sectionStations(line);
    const xs = stations.map((s) => s.along);
    const relief = stage.reliefOf(twin.edited.value);
    const ground = stations.map((s) => relief.at(...s.at));
    const now = stations.map((s) => (frame ? frameDepthAt(frame, twin.scene, ...s.at) : 0));
    const most = stations.map((s) => {
      const v = peak ? gridAt(peak, ...s.at) : NaN;
      return Number.isFinite(v) ? v : 0;
    });
    const lowest = Math.min(...ground);
    // Heights are plotted above the lowest point of the ground, so that the axis starts at zero.
    heights.update([xs, ground.map((z) => z - lowest), ground.map((z, i) => (now[i] > 0.01 ? z - lowest + now[i] : null)), ground.map((z, i) => (most[i] > 0.01 ? z - lowest + most[i] : null))], [
      { label: "Ground", unit: "m", colour: "#6a5b41", fill: "ground" },
      { label: twin.replay_s.value === null ? "Debris now" : "Debris then", unit: "m", colour: "#0b5fa5" },
      { label: "Peak", unit: "m", colour: "#d1640f", dashed: true },
    ]);
    depths.update([xs, now, most], [
      { label: twin.replay_s.value === null ? "Now" : "Then", unit: "m", colour: "#0b5fa5", fill: "#0b5fa522" },
      { label: "Peak", unit: "m", colour: "#d1640f", dashed: true },
    ]);
    const width = (line.length > 1 ? length(line) : 0) / (stations.length - 1);
    const flowArea = now.reduce((sum, d) => sum + d * width, 0);
    note.value = `${quantity(length(line), "m")} long · heights above ${quantity(lowest, "m", 4)} · debris ${quantity(flowArea, "m2")} ${twin.replay_s.value === null ? "now" : `at ${fixed(twin.replay_s.value, 2)} s`}`;
  };
  const refresh = (): void => {
    if (!twin.section.value) return;
    void twin.attempt(async () => {
      const own = ++asked;
      const grid = await twin.api.layer(twin.edited.value, "peak_depth", twin.replay_s.value);
      if (own !== asked) return;  // a later request is pending
      peak = grid;
      plot();
    });
  };
  watchAll([twin.section, twin.edited], () => {
    peak = null;
    plot();
    refresh();
  });
  watchAll([twin.replay_s], refresh);
  watchAll([stage.sinkings], plot);
  watchAll([twin.tool], () => draw.setAttribute("aria-pressed", String(twin.tool.value.kind === "section")));
  twin.onFrame((frame) => {
    const now = performance.now();
    if (frame.scenario !== twin.edited.value || !twin.section.value || now - shown_ms < 250 || element.hidden || !element.offsetParent) return;
    shown_ms = now;
    plot();
  });
  const element = h("div", {}, h("div", { class: "row" }, draw, clear), note, heights.element, depths.element);
  return { element, refresh };
}
