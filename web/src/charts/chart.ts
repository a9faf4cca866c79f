// A plot with axes that carry units; uPlot draws it, this file sets the page's style, size and texts.
import uPlot, { type AlignedData, type Options, type Series } from "uplot";
import { number, tick, unitText } from "../state/format";
import { h } from "../ui/dom";
import { chartInk, inkOf, onTheme } from "../ui/theme";

export interface Curve {
  label: string;
  unit: string;
  colour: string;
  dashed?: boolean;
  points?: boolean;
  /** Drawn as separate marks without a line. */
  marksOnly?: boolean;
  /** "ground": the colour of the ground in a section. */
  fill?: string;
  axis?: "left" | "right";
}
export interface ChartOptions {
  title: string;
  x: { label: string; unit: string };
  y: { label: string; unit: string };
  right?: { label: string; unit: string };
  curves: Curve[];
  height?: number;
  empty: string;
  /** One scale for both directions, as a cross-section needs: ratio of y to x in pixels per metre is then at most this. */
  legend?: boolean;
}

const font = "11px system-ui, 'Segoe UI', 'DejaVu Sans', sans-serif";

/** Ends of the horizontal axis. Separate marks at the first or last value would be cut in half there. */
export function xRange(low: number | null, high: number | null, marks: boolean): [number | null, number | null] {
  if (low === null || high === null || !marks) return [low, high];
  const margin = 0.03 * (high - low) || 1;
  return [low - margin, high + margin];
}

export class Chart {
  readonly element: HTMLElement;
  private readonly holder = h("div", { class: "chart-plot", role: "img" });
  private readonly blank: HTMLElement;
  private plot: uPlot | null = null;
  private data: AlignedData = [[]];
  private curves: Curve[];
  private cursor_s: number | null = null;
  private changes: readonly number[] = [];
  private readonly unwatch: () => void;

  constructor(private readonly options: ChartOptions) {
    this.curves = options.curves;
    this.blank = h("p", { class: "hint" }, options.empty);
    this.element = h("figure", { class: "chart" }, h("figcaption", {}, options.title), this.holder, this.blank);
    new ResizeObserver(() => this.fit()).observe(this.holder);
    this.unwatch = onTheme(() => {
      this.drop();
      this.fit();
    });
    this.update([[]]);
  }

  /** data: x and one column per curve. `curves` replaces the curves when their number changed. */
  update(data: AlignedData, curves: Curve[] = this.curves): void {
    // A plot has one column per curve for as long as it lives, also while it is hidden.
    if (curves !== this.curves && JSON.stringify(curves) !== JSON.stringify(this.curves)) this.drop();
    this.curves = curves;
    this.data = data;
    const empty = data[0].length === 0;
    this.holder.hidden = empty;
    this.blank.hidden = !empty;
    if (empty) return;
    this.holder.setAttribute("aria-label", this.sentence());
    if (this.plot) this.plot.setData(data);
    else this.build();
  }
  /** A vertical line at an x, such as the displayed time. */
  mark(x: number | null): void {
    if (x === this.cursor_s) return;
    this.cursor_s = x;
    this.plot?.redraw(false);
  }

  /** Dashed vertical lines where a run was changed on the way. */
  markChanges(xs: readonly number[]): void {
    if (xs.join() === this.changes.join()) return;
    this.changes = xs;
    if (!this.holder.hidden) this.holder.setAttribute("aria-label", this.sentence());
    this.plot?.redraw(false);
  }

  /** Must be called when its editor is removed: uPlot has listeners on the window. */
  destroy(): void {
    this.unwatch();
    this.drop();
  }
  private drop(): void {
    this.plot?.destroy();
    this.plot = null;
  }
  private build(): void {
    const width = this.holder.clientWidth;
    if (width < 40) return;
    const { x, y, right, height } = this.options;
    const ink = chartInk();
    const axis = (label: string, unit: string, side: 0 | 1 | 2 | 3): NonNullable<Options["axes"]>[number] => ({
      label: unit === "" ? label : `${label}, ${unitText(unit)}`, labelFont: font, font, stroke: ink.text, labelSize: 16, size: side === 2 ? 30 : 40, gap: 3, labelGap: 0,
      side, grid: { show: side !== 1, stroke: ink.grid, width: 1 }, ticks: { stroke: ink.ticks, size: 4, width: 1 },
      values: (_, values) => values.map((v) => tick(v)),
    });
    const series: Series[] = [{ label: x.label, value: (_, v) => (v === null ? "–" : `${number(v, 4)} ${unitText(x.unit)}`) },
      ...this.curves.map((c): Series => ({
        label: c.label, class: c.marksOnly ? "marks" : "line", stroke: inkOf(c.colour), width: c.marksOnly ? 0 : 1.6, scale: c.axis === "right" ? "right" : "y", spanGaps: true,
        ...(c.dashed ? { dash: [5, 4] } : {}), ...(c.fill ? { fill: c.fill === "ground" ? ink.ground : c.fill } : {}),
        points: c.marksOnly ? { show: true, size: 9, fill: ink.paper, stroke: inkOf(c.colour), width: 2 } : { show: c.points ?? false, size: 4, fill: inkOf(c.colour) },
        value: (_, v) => (v === null ? "–" : `${number(v, 3)} ${unitText(c.unit)}`),
      }))];
    const options: Options = {
      width, height: height ?? 190, padding: [8, right ? 0 : 10, 0, 0], series,
      scales: { x: { time: false, range: (_: uPlot, low: number | null, high: number | null) => xRange(low, high, this.curves.some((c) => c.marksOnly)) }, y: { range: (_, low, high) => [Math.min(0, low ?? 0), (high ?? 1) > 0 ? (high ?? 1) * 1.06 : 1] },
        ...(right ? { right: { range: (_u: uPlot, low: number, high: number) => [Math.min(0, low), high > 0 ? high * 1.06 : 1] } } : {}) } as Options["scales"] & object,
      axes: [axis(x.label, x.unit, 2), axis(y.label, y.unit, 3), ...(right ? [{ ...axis(right.label, right.unit, 1), scale: "right" }] : [])],
      cursor: { points: { size: 6 }, drag: { x: true, y: false } },
      legend: { show: this.options.legend ?? true, live: true, markers: { dash: (_, i) => (this.curves[i - 1]?.dashed ? "dashed" : "solid") } },
      hooks: { draw: [(plot) => this.drawMarks(plot)] },
    };
    this.plot = new uPlot(options, this.data, this.holder);
  }
  private drawMarks(plot: uPlot): void {
    for (const x of this.changes) this.drawMark(plot, x, inkOf("#a3262a"), [4, 4]);
    if (this.cursor_s !== null) this.drawMark(plot, this.cursor_s, "#d98a00", []);
  }
  private drawMark(plot: uPlot, x: number, colour: string, dash: readonly number[]): void {
    const at = plot.valToPos(x, "x", true);
    const { left, top, width, height } = plot.bbox;
    if (at < left || at > left + width) return;
    plot.ctx.save();
    plot.ctx.strokeStyle = colour;
    plot.ctx.setLineDash(dash.map((length) => length * devicePixelRatio));
    plot.ctx.lineWidth = 1.5 * devicePixelRatio;
    plot.ctx.beginPath();
    plot.ctx.moveTo(at, top);
    plot.ctx.lineTo(at, top + height);
    plot.ctx.stroke();
    plot.ctx.restore();
  }
  private fit(): void {
    const width = this.holder.clientWidth;
    if (width < 40 || this.holder.hidden) return;
    if (!this.plot) this.build();
    else if (Math.abs(this.plot.width - width) > 1) this.plot.setSize({ width, height: this.options.height ?? 190 });
  }
  private sentence(): string {
    const parts = this.curves.map((c, i) => {
      const column = (this.data[i + 1] ?? []) as (number | null | undefined)[];
      let low = Infinity;
      let high = -Infinity;
      for (const v of column) {
        if (v === null || v === undefined) continue;
        low = Math.min(low, v);
        high = Math.max(high, v);
      }
      return low <= high ? `${c.label} from ${number(low)} to ${number(high)} ${unitText(c.unit)}` : `${c.label} without values`;
    });
    const changed = this.changes.length > 0 ? ` Changed on the way at ${this.changes.map((x) => number(x)).join(", ")} ${unitText(this.options.x.unit)}.` : "";
    return `${this.options.title} over ${this.options.x.label}: ${parts.join("; ")}.${changed}`;
  }
}

/** Joins columns that have their own x into one table, as uPlot requires. */
export function joined(tables: { x: readonly (number | null)[]; y: readonly (number | null | undefined)[] }[]): AlignedData {
  const xs = [...new Set(tables.flatMap((t) => t.x.filter((v): v is number => v !== null)))].sort((a, b) => a - b);
  const place = new Map(xs.map((v, i) => [v, i]));
  const columns = tables.map((t) => {
    const column = new Array<number | null>(xs.length).fill(null);
    t.x.forEach((v, i) => {
      const k = v === null ? undefined : place.get(v);
      if (k !== undefined) column[k] = t.y[i] ?? null;
    });
    return column;
  });
  return [xs, ...columns];
}
