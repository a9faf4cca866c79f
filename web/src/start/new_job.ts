// A new ensemble, calibration, validation, risk, comparison of options or design of a barrier: what it varies, how many runs, and how long that takes.
import type { Api } from "../protocol/api";
import type { JobEstimate, JobForm, JobKind, KnownScene, ValidationCase, WantedDesign, WantedEnsemble, WantedJob, WantedRisk } from "../protocol/start";
import { bytes } from "../state/format";
import { firstRange, freeAtFirst } from "../state/misfit";
import { aboutTime } from "../state/time_left";
import { choice } from "../ui/choice";
import { button, h } from "../ui/dom";
import { rangeRow, rangesOf, type RangeRow } from "../ui/range_row";

const presets: Record<Exclude<JobKind, "validation">, readonly (readonly [string, number])[]> = {
  ensemble: [["Quick look", 16], ["Usual", 64], ["Thorough", 256]],
  calibration: [["Two values", 60], ["Usual", 100], ["Thorough", 200]],
  risk: [["Quick look", 16], ["Usual", 64], ["Thorough", 256]],
  options: [["Quick look", 16], ["Usual", 64], ["Thorough", 256]],
  design: [["Quick look", 8], ["Usual", 32], ["Thorough", 128]],
};
const designs: readonly (readonly [string, string])[] = [["latin_hypercube", "Latin hypercube"], ["sobol", "Sobol sequence"], ["monte_carlo", "Monte Carlo"],
  ["saltelli", "Sobol indices (Saltelli)"], ["morris", "Elementary effects (Morris)"]];
const about: Record<JobKind, string> = {
  ensemble: "Many runs of a scene with values from these ranges: probability maps, run-out, hits per building, sensitivity.",
  calibration: "Finds the values that explain the field observations of a scene, with their uncertainty.",
  risk: "What the events of a scene do to buildings, roads and people in a year: impact, loss, individual and societal risk, with a map.",
  options: "The same for each option of measures, with the same draws: differences, and cost against risk averted.",
  design: "The least height of a barrier of the scene for which no more passes than you allow, what it holds and what it must bear, as a sheet.",
  validation: "Computes cases with known results and compares.",
};
const usualCases = "Quick cases: under two minutes on two cores. All cases: about 40 minutes on two cores.";

export class NewJob {
  readonly element: HTMLElement;
  private kind: JobKind = "ensemble";
  private readonly scene: HTMLSelectElement;
  private readonly runs = h("input", { type: "number", min: 1, max: 2000, step: 1, "aria-label": "Number of runs", oninput: () => this.showTime() });
  private readonly design = h("select", { "aria-label": "Design" }, ...designs.map(([value, text]) => h("option", { value }, text)));
  private readonly barrier = h("select", { "aria-label": "Barrier" });
  private readonly share = h("input", { type: "number", min: 0, max: 99, step: 1, value: 5, "aria-label": "Share that may pass, %" });
  private readonly of = h("select", { "aria-label": "Share of" }, h("option", { value: "runs" }, "of the runs"), h("option", { value: "volume" }, "of the volume"));
  private readonly least = h("input", { type: "number", min: 0.5, step: 0.5, value: 1, "aria-label": "Least height, m", oninput: () => this.showTime() });
  private readonly greatest = h("input", { type: "number", min: 0.5, step: 0.5, value: 10, "aria-label": "Greatest height, m", oninput: () => this.showTime() });
  private readonly factors = h("div", { class: "job-factors" });
  private readonly body = h("div", { class: "job-body" });
  private readonly time = h("p", { class: "job-time", role: "status" });
  private readonly problem = h("p", { class: "field-note", role: "alert" });
  private readonly begin = button("Start", { icon: "run", class: "primary", onclick: () => void this.start() });
  private form: JobForm | null = null;
  private estimate: JobEstimate | string | null = null;
  private rows: RangeRow[] = [];
  private cases: { about: ValidationCase; tick: HTMLInputElement }[] = [];
  private which: "quick" | "all" | "chosen" = "quick";
  /** Counts what was asked, so that an answer about another scene is not shown. */
  private asked = 0;

  constructor(private readonly api: Api, scenes: readonly KnownScene[], first: string | null, private readonly onclose: () => void) {
    this.scene = h("select", { "aria-label": "Scene", onchange: () => void this.load() },
      ...scenes.filter((scene) => !scene.missing).map((scene) => h("option", { value: scene.id, selected: scene.id === first }, scene.title || "Scene without a title")));
    this.element = h("section", { class: "new-scene new-job", "aria-labelledby": "new-job" },
      h("div", { class: "start-title" }, h("h2", { id: "new-job" }, "New job"), button("Discard", { class: "quiet", onclick: onclose })),
      choice("Kind of job", [["ensemble", "Ensemble"], ["calibration", "Calibration"], ["risk", "Risk"], ["options", "Options"], ["design", "Barrier design"], ["validation", "Validation"]], this.kind, (kind: JobKind) => {
        this.kind = kind;
        this.show();
      }), this.body, this.problem, this.time, h("div", { class: "row new-last" }, h("span", { class: "spring" }), this.begin));
    this.show();
    void this.load();
  }

  private async load(): Promise<void> {
    const asked = ++this.asked;
    this.form = null;
    this.estimate = null;
    this.problem.textContent = "";
    this.show();
    try {
      const form = await this.api.jobForm(this.scene.value);
      if (asked !== this.asked) return;
      this.form = form;
      this.show();
      this.estimate = await this.api.jobEstimate(this.scene.value);
    } catch (error) {
      if (asked !== this.asked) return;
      const sentence = error instanceof Error ? error.message : String(error);
      if (this.form === null) this.problem.textContent = sentence;
      else this.estimate = sentence;
    }
    if (asked === this.asked) this.showTime();
  }

  /** The parts of this kind of job. */
  private show(): void {
    this.problem.textContent = "";
    const hint = h("p", { class: "muted" }, about[this.kind]);
    if (this.kind === "validation") {
      this.body.replaceChildren(hint, choice("Cases", [["quick", "Quick cases"], ["all", "All cases"], ["chosen", "Chosen cases"]], this.which, (which) => {
        this.which = which;
        void this.showCases();
      }), this.factors);
      void this.showCases();
    } else {
      this.runs.value = String(presets[this.kind][1][1]);
      this.showFactors();
      this.body.replaceChildren(hint, h("label", { class: "row wrap" }, "Scene", this.scene), this.factors,
        h("div", { class: "row wrap" }, h("label", { class: "row" }, this.kind === "calibration" ? "Runs at most" : this.kind === "design" ? "Runs of each height" : this.ensembles() > 1 ? `Runs, ${this.ensembles()} times` : "Runs", this.runs),
          ...presets[this.kind].map(([name, count]) => button(`${name}: ${count}`, { class: "small", onclick: () => {
            this.runs.value = String(count);
            this.showTime();
          } }))), ...(this.kind === "ensemble" ? [h("label", { class: "row wrap" }, "Design", this.design)] : []), ...(this.kind === "design" ? this.barrierRows() : []));
    }
    this.showTime();
  }
  private showFactors(): void {
    const { form } = this;
    this.rows = [];
    if (form === null) return this.factors.replaceChildren(h("p", { class: "muted" }, "The scene is read …"));
    if (this.kind === "calibration" && form.observations.length === 0) {
      return this.factors.replaceChildren(h("p", { class: "empty" }, "This scene has no field observations to calibrate against. Add [[observation]], [[run_up]] or another of the sections in docs/ensembles.md to its file."));
    }
    if (this.kind === "risk" && form.events.length === 0) {
      return this.factors.replaceChildren(h("p", { class: "empty" }, "This scene does not say how often events come and what is at risk. Add [[risk_scenario]] and [[exposure]] to its file, as docs/risk.md shows."));
    }
    if (this.kind === "options" && form.options.length === 0) {
      return this.factors.replaceChildren(h("p", { class: "empty" }, "This scene has no options to compare. Add [[option]] to its file, as docs/risk.md shows."));
    }
    if (this.kind === "design") {
      if (form.barriers.length === 0) return this.factors.replaceChildren(h("p", { class: "empty" }, "This scene has no barrier to design. Add [[barrier]] to its file, or draw one in a session and save the scene."));
      this.barrier.replaceChildren(...form.barriers.map((name) => h("option", { value: name }, name)));
    }
    this.rows = form.parameters.map((p) => {
      // An ensemble asks what the scene's own values are uncertain by; a calibration looks for them in a wide range.
      const [low, high] = firstRange(p, p.value);
      const near: [number, number] = p.value !== null && p.value > 0 ? [Math.max(low, Number((0.75 * p.value).toPrecision(3))), Math.min(Math.max(high, 1.25 * p.value), Number((1.25 * p.value).toPrecision(3)))] : [low, high];
      const chosen = this.kind === "calibration" ? freeAtFirst.includes(p.key) : p.key === "material.friction_coefficient" || p.key.startsWith("release");
      return rangeRow(p, p.value, chosen, this.kind === "calibration" ? [low, high] : near);
    });
    const first = this.rows.filter((row) => row.free.checked);
    const others = this.rows.filter((row) => !row.free.checked);
    this.factors.replaceChildren(h("h3", {}, this.kind === "calibration" ? "Free values and their ranges" : "Factors and their ranges"), ...first.map((row) => row.element),
      ...(others.length === 0 ? [] : [h("details", {}, h("summary", {}, "More values"), ...others.map((row) => row.element))]),
      ...(this.kind === "calibration" ? [h("p", { class: "muted" }, `Observed: ${form.observations.join(", ")}`)] : []),
      ...(this.kind === "risk" || this.kind === "options" ? [h("p", { class: "muted" }, `Events: ${form.events.join(", ") || "one class, without a frequency"}`)] : []),
      ...(this.kind === "options" ? [h("p", { class: "muted" }, `Options: as it is, ${form.options.join(", ")}`)] : []));
  }
  private barrierRows(): HTMLElement[] {
    return [h("div", { class: "row wrap" }, h("label", { class: "row" }, "Barrier", this.barrier), h("label", { class: "row" }, "May pass, %", this.share), this.of),
      h("div", { class: "row wrap" }, h("label", { class: "row" }, "Heights from, m", this.least), h("label", { class: "row" }, "to, m", this.greatest))];
  }
  /** How many heights a search tries at most, and one without the barrier: it halves a grid of half metres. */
  private trials(): number {
    const heights = Math.floor((this.greatest.valueAsNumber - this.least.valueAsNumber) / 0.5 + 1e-9) + 1;
    if (!(heights >= 1)) return 1;
    return 1 + (heights < 3 ? heights : 2 + Math.ceil(Math.log2(heights - 1)));
  }
  /** How many ensembles a job runs: one for each class of events, and for each option. */
  private ensembles(): number {
    if (this.kind === "design") return this.trials();
    if (this.kind !== "risk" && this.kind !== "options") return 1;
    const events = Math.max(1, this.form?.events.length ?? 1);
    return this.kind === "risk" ? events : events * (1 + (this.form?.options.length ?? 0));
  }
  private async showCases(): Promise<void> {
    this.showTime();
    if (this.which !== "chosen") return this.factors.replaceChildren();
    if (this.cases.length === 0) {
      this.factors.replaceChildren(h("p", { class: "muted" }, "The cases are read …"));
      try {
        this.cases = (await this.api.validationCases()).map((about) => ({ about, tick: h("input", { type: "checkbox", "data-case": about.name }) }));
      } catch (error) {
        this.problem.textContent = error instanceof Error ? error.message : String(error);
      }
      if (this.kind !== "validation" || this.which !== "chosen") return;
    }
    this.factors.replaceChildren(h("ul", { class: "job-cases" }, ...this.cases.map(({ about, tick }) => h("li", {}, h("label", { class: "check" }, tick, h("span", {}, about.title, about.quick ? h("span", { class: "muted" }, " · quick") : null))))));
  }
  /** How long it takes, before it starts. */
  private showTime(): void {
    this.problem.textContent = "";
    const impossible = this.kind !== "validation" && (this.form === null || this.rows.length === 0);
    this.begin.disabled = impossible;
    if (this.kind === "validation") {
      this.time.textContent = this.which === "chosen" ? "The longest cases take some minutes on two cores." : usualCases;
      return;
    }
    const runs = this.runs.valueAsNumber * this.ensembles();
    const { estimate } = this;
    if (impossible || !(runs > 0)) this.time.textContent = "";
    else if (estimate === null) this.time.textContent = "How fast this computer runs the scene is being measured …";
    else if (typeof estimate === "string") this.time.textContent = estimate;
    else if (estimate.run_s === null) this.time.textContent = "There is no estimate of the time.";
    else {
      const memory = estimate.memory_bytes * Math.min(estimate.cores, runs);
      this.time.textContent = `${this.kind === "design" ? "At most " : ""}${runs} runs with ${estimate.particles.toLocaleString("en-GB")} particles: ${aboutTime(runs * estimate.run_s)} on this computer within a factor of two, ${bytes(memory)} of memory.`;
    }
  }

  private wanted(): WantedJob | string {
    if (this.kind === "validation") {
      if (this.which !== "chosen") return { kind: this.kind, quick: this.which === "quick" };
      const cases = this.cases.filter(({ tick }) => tick.checked).map(({ about }) => about.name);
      return cases.length === 0 ? "Choose at least one case." : { kind: this.kind, cases };
    }
    const factors = rangesOf(this.rows);
    if (typeof factors === "string") return factors;
    const runs = this.runs.valueAsNumber;
    if (!Number.isInteger(runs) || runs < 1 || runs > (this.form?.limits.runs ?? Infinity)) return `The number of runs is a whole number from 1 to ${this.form?.limits.runs ?? ""}.`;
    const common = { scene: this.scene.value, factors, runs };
    if (this.kind === "risk" || this.kind === "options") {
      const risk: WantedRisk = { kind: this.kind, ...common };
      return risk;
    }
    if (this.kind === "design") {
      const [share, low, high] = [this.share.valueAsNumber / 100, this.least.valueAsNumber, this.greatest.valueAsNumber];
      if (!(share >= 0 && share < 1)) return "The share that may pass is a number from 0 to below 100 %.";
      if (!(low > 0 && low <= high)) return "The least height is above 0 and not above the greatest.";
      const design: WantedDesign = { kind: "design", ...common, barrier: this.barrier.value, share, of: this.of.value as NonNullable<WantedDesign["of"]>, min_height_m: low, max_height_m: high };
      return design;
    }
    return this.kind === "ensemble" ? { kind: "ensemble", ...common, design: this.design.value as NonNullable<WantedEnsemble["design"]> } : { kind: "calibration", ...common };
  }
  private async start(): Promise<void> {
    const wanted = this.wanted();
    this.problem.textContent = typeof wanted === "string" ? wanted : "";
    if (typeof wanted === "string") return;
    this.begin.disabled = true;
    try {
      await this.api.addJob(wanted);
      this.onclose();
    } catch (error) {
      this.problem.textContent = error instanceof Error ? error.message : String(error);
      this.begin.disabled = false;
    }
  }
}
