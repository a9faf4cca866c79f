// The misfit over the first two parameters of a calibration: a dot per run, the emulators' field behind them.
import type { CalibrationRun, CalibrationStatus } from "../protocol/messages";
import { css, rampAt, ramps, roundStep } from "../scene/colour";
import { quantity, number, tick, unitText } from "../state/format";
import { MisfitScale } from "../state/misfit";
import { h } from "../ui/dom";

const plot = { left: 46, top: 8, width: 270, height: 226, right: 6, bottom: 36 };

function svg<K extends keyof SVGElementTagNameMap>(name: K, attributes: Record<string, string | number>, ...children: (Node | string)[]): SVGElementTagNameMap[K] {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, String(value));
  element.append(...children);
  return element;
}

interface Axis { label: string; low: number; high: number }

function ticksOf({ low, high }: Axis): number[] {
  const step = roundStep((high - low) / 4.5);
  const list = [];
  for (let v = Math.ceil(low / step - 1e-9) * step; v <= high + 1e-9 * step; v += step) list.push(v);
  return list;
}

export class MisfitMap {
  readonly element: HTMLElement;
  private readonly field = h("canvas", { class: "misfit-field", "aria-hidden": "true" });
  private readonly drawing: SVGSVGElement;
  private readonly bar = h("div", { class: "legend-bar" });
  private readonly ends = h("div", { class: "misfit-ends" });
  private readonly fastHint = h("span", { hidden: true }, " Small dots: runs of the depth-averaged model.");

  constructor() {
    const { left, top, width, height, right, bottom } = plot;
    this.drawing = svg("svg", { viewBox: `0 0 ${left + width + right} ${top + height + bottom}`, class: "misfit", role: "img" });
    const holder = h("div", { class: "misfit-plot" }, this.field, this.drawing);
    const share = (part: number, whole: number): string => `${(100 * part) / whole}%`;
    this.field.style.left = share(left, left + width + right);
    this.field.style.top = share(top, top + height + bottom);
    this.field.style.width = share(width, left + width + right);
    this.field.style.height = share(height, top + height + bottom);
    this.bar.style.background = `linear-gradient(to right, ${Array.from({ length: 17 }, (_, i) => css(rampAt(ramps.misfit, i / 16))).join(", ")})`;
    this.element = h("figure", { class: "misfit-map" }, holder,
      h("div", { class: "misfit-key" }, h("b", {}, "Misfit"), h("div", {}, this.bar, this.ends)),
      h("p", { class: "hint" }, "A dot is a run. Misfit: sum of squared deviations from the observations, in standard deviations; dark fits best. Ring: best run. Cross: the present values.", this.fastHint));
  }

  /** present: the live scenario's current values of the parameters. */
  update(status: CalibrationStatus, present: (number | null)[]): void {
    const [first, second] = status.parameters;
    if (!first) return;
    const scale = MisfitScale.of(status);
    this.ends.replaceChildren(...[0, 0.5, 1].map((s) => h("span", {}, number(scale.at(s), 2))));
    const label = (p: { label: string; unit: string }): string => p.label.charAt(0).toUpperCase() + p.label.slice(1) + (p.unit === "" ? "" : `, ${unitText(p.unit)}`);
    const x: Axis = { label: label(first), low: first.low, high: first.high };
    const y: Axis = second ? { label: label(second), low: second.low, high: second.high } : { label: "Misfit", low: 0, high: 1 };
    const px = (v: number): number => plot.left + (plot.width * (v - x.low)) / (x.high - x.low);
    const py = (v: number): number => plot.top + plot.height * (1 - (v - y.low) / (y.high - y.low));
    this.drawField(status, scale, second !== undefined);

    const marks: Node[] = [];
    if (!second && status.map) {
      const points = status.map.misfit.map((m, i) => (m === null ? "" : `${px(x.low + ((i + 0.5) / (status.map?.columns ?? 1)) * (x.high - x.low)).toFixed(1)},${py(scale.share(m)).toFixed(1)}`));
      marks.push(svg("polyline", { class: "emulated", points: points.join(" ") }));
    }
    const inside = (v: number | null | undefined, axis: Axis): v is number => v !== null && v !== undefined && v >= axis.low && v <= axis.high;
    const place = (values: readonly (number | null)[], misfit: number | null): [number, number] | null => {
      const [u, v] = [values[0], second ? values[1] : misfit === null ? 0 : scale.share(misfit)];
      return inside(u, x) && inside(v, y) ? [px(u), py(v)] : null;
    };
    const dot = (run: CalibrationRun, k: number, fast: boolean): void => {
      const at = place(run.values, run.misfit);
      if (!at) return;
      const words = status.parameters.map((p, i) => `${p.label} ${quantity(run.values[i], p.unit, 3)}`).join(", ");
      const title = svg("title", {}, `Run ${k + 1}${fast ? " of the depth-averaged model" : ""}, ${run.phase}: ${words}; ${run.misfit === null ? "failed" : `misfit ${number(run.misfit, 3)}`}`);
      if (run.misfit === null) {
        marks.push(svg("path", { class: "failed", d: `M${at[0] - 4} ${at[1] - 4}l8 8m0 -8l-8 8` }, title));
        return;
      }
      marks.push(svg("circle", { class: "halo", cx: at[0].toFixed(1), cy: at[1].toFixed(1), r: fast ? 3.8 : 5.6 }),
        svg("circle", { class: fast ? "run fast" : "run", cx: at[0].toFixed(1), cy: at[1].toFixed(1), r: fast ? 2.8 : 4.4, fill: css(rampAt(ramps.misfit, scale.share(run.misfit))) }, title));
    };
    // Particles lie above: they decide.
    status.fast_runs.forEach((run, k) => dot(run, k, true));
    status.runs.forEach((run, k) => dot(run, k, false));
    this.fastHint.hidden = status.fast_runs_at_most === 0;
    const best = status.best && place(status.best.values, status.best.misfit);
    if (best) marks.push(svg("circle", { class: "best", cx: best[0].toFixed(1), cy: best[1].toFixed(1), r: 9 }));
    if (second && inside(present[0], x) && inside(present[1], y)) {
      const [u, v] = [px(present[0]), py(present[1])];
      for (const kind of ["now-edge", "now"]) marks.push(svg("path", { class: kind, d: `M${u - 6} ${v}h12M${u} ${v - 6}v12` }));
    }
    this.drawing.replaceChildren(...this.axes(x, y, px, py, second !== undefined), ...marks);
    this.drawing.setAttribute("aria-label", `Misfit over ${first.label}${second ? ` and ${second.label}` : ""}: ${status.runs.length} runs${status.fast_runs.length > 0 ? `, ${status.fast_runs.length} of the depth-averaged model` : ""}` +
      (status.best ? `; best: ${status.parameters.map((p, i) => `${p.label} ${quantity(status.best?.values[i], p.unit, 3)}`).join(", ")}, misfit ${number(status.best.misfit, 3)}` : ""));
  }

  private axes(x: Axis, y: Axis, px: (v: number) => number, py: (v: number) => number, plane: boolean): Node[] {
    const { left, top, width, height } = plot;
    const list: Node[] = [svg("rect", { class: "frame", x: left, y: top, width, height })];
    for (const v of ticksOf(x)) {
      list.push(svg("path", { class: "tick", d: `M${px(v)} ${top + height}v4` }),
        svg("text", { x: px(v), y: top + height + 15, "text-anchor": "middle" }, tick(v)));
    }
    for (const v of plane ? ticksOf(y) : []) {
      list.push(svg("path", { class: "tick", d: `M${left} ${py(v)}h-4` }), svg("text", { x: left - 7, y: py(v) + 4, "text-anchor": "end" }, tick(v)));
    }
    list.push(svg("text", { class: "axis", x: left + width / 2, y: top + height + 31, "text-anchor": "middle" }, x.label),
      svg("text", { class: "axis", transform: `translate(11 ${top + height / 2}) rotate(-90)`, "text-anchor": "middle" }, y.label));
    return list;
  }
  private drawField(status: CalibrationStatus, scale: MisfitScale, plane: boolean): void {
    const { map } = status;
    this.field.hidden = map === null || !plane;
    if (!map || !plane) return;
    this.field.width = map.columns;
    this.field.height = map.rows;
    const context = this.field.getContext("2d");
    if (!context) return;
    const image = context.createImageData(map.columns, map.rows);
    map.misfit.forEach((m, k) => {
      const row = map.rows - 1 - Math.floor(k / map.columns); // rows come from the low end, pictures from the top
      const at = 4 * (row * map.columns + (k % map.columns));
      image.data.set(m === null ? [0, 0, 0, 0] : [...rampAt(ramps.misfit, scale.share(m)), 255], at);
    });
    context.putImageData(image, 0, 0);
  }
}
