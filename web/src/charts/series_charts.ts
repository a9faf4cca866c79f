// Front velocity against chainage, and quantities over time.
import type { Column } from "../protocol/messages";
import { watchAll } from "../state/cell";
import { seriesUntil } from "../state/past";
import { observedVelocities } from "../state/tables";
import { probeColours, type Twin } from "../state/twin";
import { h } from "../ui/dom";
import { besideColour } from "../ui/theme";
import { Chart, joined, type Curve } from "./chart";

/** Of the two that are shown. */
const colours = ["#0b5fa5", "#d1640f"];
const debrisColours = ["#2a9fc9", "#b08900"];
const depthAveragedColours = ["#7b3fa0", "#2f7d4f"];
const observed = [["front_velocity_mps", "Field, front velocity", "#a3262a"], ["debris_speed_mps", "Field, debris speed", "#1c2126"]] as const;

/** Every n-th value of a long column, few enough to plot. */
function thinned(column: Column, most = 600): number[] {
  const every = Math.max(1, Math.ceil(column.length / most));
  const picked = [];
  for (let k = 0; k < column.length; k += every) picked.push(k);
  if (column.length > 0 && picked[picked.length - 1] !== column.length - 1) picked.push(column.length - 1);
  return picked;
}

/** beside: what stands under the first chart; below: under all. */
export function frontCharts(twin: Twin, beside: HTMLElement, below: HTMLElement): HTMLElement {
  const velocity = new Chart({ title: "Front velocity along the flow path", x: { label: "Chainage", unit: "m" }, y: { label: "Front velocity", unit: "m/s" }, curves: [],
    height: 230, empty: "The front has not moved yet. Run the simulation: velocities appear as it passes each chainage." });
  const arrival = new Chart({ title: "Arrival of the front", x: { label: "Chainage", unit: "m" }, y: { label: "Time", unit: "s" }, curves: [], height: 170,
    empty: "No arrivals yet." });
  watchAll([twin.shown, ...twin.every("series"), ...twin.every("setup"), ...twin.every("depthAveraged"), twin.replay_s], () => {
    const tables: { x: Column; y: Column }[] = [];
    const curves: Curve[] = [];
    const times: { x: Column; y: Column }[] = [];
    const timeCurves: Curve[] = [];
    for (const [i, name] of twin.shown.value.entries()) {
      const front = seriesUntil(twin.cells[name].series.value, twin.replay_s.value)?.front;
      const suffix = twin.shown.value.length > 1 ? ` ${name}` : "";
      // The whole run of the other model, also ahead of the particles.
      const other = twin.cells[name].depthAveraged.value?.result?.front;
      if (other && other.chainage_m.length > 0) {
        const like = { colour: depthAveragedColours[i], dashed: true };
        tables.push({ x: other.chainage_m, y: other.front_velocity_mps });
        curves.push({ label: `Depth-averaged${suffix}`, unit: "m/s", ...like });
        times.push({ x: other.chainage_m, y: other.arrival_time_s });
        timeCurves.push({ label: `Depth-averaged${suffix}`, unit: "s", ...like });
      }
      if (!front || front.chainage_m.length === 0) continue;
      tables.push({ x: front.chainage_m, y: front.front_velocity_mps }, { x: front.chainage_m, y: front.particle_speed_mps });
      curves.push({ label: `Front${suffix}`, unit: "m/s", colour: colours[i], points: front.chainage_m.length < 40 },
        { label: `Debris at front${suffix}`, unit: "m/s", colour: debrisColours[i], dashed: true });
      times.push({ x: front.chainage_m, y: front.arrival_time_s });
      timeCurves.push({ label: `Arrival${suffix}`, unit: "s", colour: colours[i] });
    }
    const field = twin.cells[twin.shown.value[0]].setup.value;
    for (const [key, label, colour] of observed) {
      const own = observedVelocities(field, key);
      if (own.length === 0) continue;
      tables.push({ x: own.map((o) => o.chainage_m), y: own.map((o) => o.mps) });
      curves.push({ label, unit: "m/s", colour, marksOnly: true });
    }
    velocity.update(tables.length > 0 ? joined(tables) : [[]], curves);
    arrival.update(times.length > 0 ? joined(times) : [[]], timeCurves);
  });
  const note = twin.scene.flow_path ? null : h("p", { class: "hint" }, "This scene has no flow path: there is no chainage to plot against.");
  return h("div", {}, note, velocity.element, beside, arrival.element, below);
}

interface Plotted { column: string; label: string; colour: string }
const volumes: Plotted[] = [
  { column: "volume_moving_m3", label: "Moving", colour: "#3b83b5" },
  { column: "volume_deposited_m3", label: "Deposited", colour: "#8a6d3b" },
  { column: "volume_held_m3", label: "Held", colour: "#8b949c" },
  { column: "volume_left_m3", label: "Outflow", colour: "#a3262a" },
];

export function timeCharts(twin: Twin): HTMLElement {
  const time = { label: "Time", unit: "s" };
  const volume = new Chart({ title: "Volumes", x: time, y: { label: "Volume", unit: "m3" }, curves: [], empty: "No time series yet: run the simulation." });
  const speed = new Chart({ title: "Speed", x: time, y: { label: "Speed", unit: "m/s" }, curves: [], empty: "No speeds yet." });
  const energy = new Chart({ title: "Energy", x: time, y: { label: "Energy", unit: "MJ" }, curves: [], empty: "No energies yet." });
  const gauges = new Chart({ title: "Depth at the gauges", x: time, y: { label: "Depth", unit: "m" }, curves: [], empty: "No debris at the gauges yet." });
  const all = [volume, speed, energy, gauges];
  watchAll([twin.shown, ...twin.every("series"), ...twin.every("setup"), ...twin.every("gauges"), twin.replay_s], () => {
    const two = twin.shown.value.length > 1;
    const put = (chart: Chart, list: Plotted[], unit: string, factor = 1): void => {
      const tables: { x: Column; y: Column }[] = [];
      const curves: Curve[] = [];
      for (const [i, name] of twin.shown.value.entries()) {
        const table = seriesUntil(twin.cells[name].series.value, twin.replay_s.value)?.time;
        const picked = thinned(table?.["time_s"] ?? []);
        const pick = (column: Column | undefined, by: number): Column => picked.map((k) => (column?.[k] ?? null) === null ? null : (column?.[k] ?? 0) * by);
        for (const { column, label, colour } of list) {
          if (!table?.[column] || picked.length === 0) continue;
          tables.push({ x: pick(table["time_s"], 1), y: pick(table[column], factor) });
          curves.push({ label: two ? `${label} ${name}` : label, colour: i === 1 ? besideColour(colour) : colour, unit, dashed: i === 1 });
        }
      }
      chart.update(tables.length > 0 ? joined(tables) : [[]], curves);
      chart.markChanges(twin.shown.value.flatMap((name) => twin.cells[name].setup.value?.changes.map((c) => c.time_s) ?? []));
    };
    const depths = twin.shown.value.flatMap((name, i) => {
      const series = seriesUntil(twin.cells[name].series.value, twin.replay_s.value);
      return probeColours.slice(0, series?.gauges.depth_m.length ?? 0).map((colour, k) => ({ table: { x: series?.gauges.time_s ?? [], y: series?.gauges.depth_m[k] ?? [] },
        curve: { label: `${twin.cells[name].gauges.value?.[k]?.name ?? `gauge ${k + 1}`}${two ? ` ${name}` : ""}`, colour: i === 1 ? besideColour(colour) : colour, unit: "m", dashed: i === 1 } }));
    });
    gauges.element.hidden = twin.shown.value.every((name) => (twin.cells[name].setup.value?.gauges.length ?? 0) === 0);
    gauges.update(depths.length > 0 ? joined(depths.map((d) => d.table)) : [[]], depths.map((d) => d.curve));
    put(volume, volumes, "m3");
    put(speed, [{ column: "largest_speed_mps", label: "Largest speed", colour: "#0b5fa5" }], "m/s");
    put(energy, [{ column: "kinetic_energy_J", label: "Kinetic", colour: "#d1640f" }, { column: "potential_energy_J", label: "Potential", colour: "#11795a" }], "MJ", 1e-6);
  });
  return h("div", {}, ...all.map((c) => c.element));
}
