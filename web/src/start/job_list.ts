// The jobs of the start page: what runs, how far it is, and what is finished.
import type { Job } from "../protocol/start";
import { aboutTime } from "../state/time_left";
import { button, h, icon } from "../ui/dom";

export interface JobActions {
  cancel(job: Job): void;
  resume(job: Job): void;
  remove(job: Job): void;
  /** Opens a finished ensemble on its scene. */
  open(job: Job): void;
}

const names = { ensemble: "Ensemble", calibration: "Calibration", validation: "Validation", risk: "Risk", options: "Options", design: "Barrier design" } as const;
const isOpen = (job: Job): boolean => job.state === "waiting" || job.state === "running" || job.state === "cancelling";

/** How far a job is, or how it ended, in a sentence. */
export function jobText(job: Job): string {
  const what = job.kind === "validation" ? "cases" : "runs";
  const failed = job.failed > 0 ? `, ${job.failed} failed` : "";
  const done = job.done + job.failed;
  const so = job.count > 0 ? `${done} of ${job.kind === "calibration" || job.kind === "design" ? "at most " : ""}${job.count} ${what}${failed}` : "";
  const because = job.message === "" ? "" : `: ${job.message}`;
  switch (job.state) {
    case "waiting": return "Waiting for another job";
    case "running": {
      if (done === 0) return "Starting";
      const left = aboutTime(job.wall_remaining_s);
      return `${so}${left ? ` · ${left} left` : ""}`;
    }
    case "cancelling": return `${so} · stops after the current step`;
    case "done": return job.message !== "" ? job.message : `${done} ${what}${failed}`;
    case "cancelled": return `Cancelled${done > 0 ? ` after ${so}` : ""}`;
    case "interrupted": return `Not complete${because}`;
    case "failed": return `Failed${because}`;
  }
}

/** A job's row; it is kept while the job's state stays, so that the keyboard focus does. */
class Row {
  readonly element: HTMLElement;
  readonly state: string;
  private readonly text = h("span", { class: "job-text" });
  private readonly bar = h("progress", { max: 1, "aria-label": "Progress" });

  constructor(job: Job, actions: JobActions) {
    this.state = job.state;
    const name = `${names[job.kind]} · ${job.title}`;
    const bare = (label: string, sign: "close" | "remove" | "run", act: () => void): HTMLElement => button(`${label} ${name}`, { icon: sign, bare: true, class: "bare quiet", onclick: act });
    const ended = !isOpen(job);
    this.element = h("li", { class: "job", "data-job": job.id, "data-state": job.state },
      h("div", { class: "job-head" }, icon("bars"),
        h("div", { class: "grow" }, h("b", {}, name), this.text, isOpen(job) ? this.bar : null),
        h("div", { class: "job-acts" }, job.report !== null ? h("a", { class: "button", href: job.report, target: "_blank", rel: "noopener" }, "Report") : null,
        job.kind === "ensemble" && job.state === "done" ? button("Show on the scene", { class: "small", onclick: () => actions.open(job) }) : null,
        ended && job.state !== "done" ? button(job.kind === "validation" ? "Run again" : "Continue", { class: "small", onclick: () => actions.resume(job) }) : null,
        !ended ? button("Cancel", { class: "small", disabled: job.state === "cancelling", onclick: () => actions.cancel(job) }) : bare("Delete", "remove", () => actions.remove(job)))),
      h("details", { class: "job-more" }, h("summary", {}, "Command and files"), h("pre", {}, job.command), h("p", { class: "muted" }, job.folder)));
    this.show(job);
  }
  show(job: Job): void {
    const text = jobText(job);
    if (this.text.textContent !== text) this.text.textContent = text;
    this.text.classList.toggle("bad", job.state === "failed");
    if (job.count > 0 && job.done > 0) this.bar.value = (job.done + job.failed) / job.count;
    else this.bar.removeAttribute("value");
    this.bar.hidden = job.state === "waiting";
  }
}

export class JobList {
  readonly list = h("ul", { class: "start-list" });
  private rows = new Map<string, Row>();

  constructor(private readonly actions: JobActions) {}

  show(jobs: readonly Job[]): void {
    const rows = new Map<string, Row>();
    for (const job of jobs) {
      const before = this.rows.get(job.id);
      const row = before?.state === job.state ? before : new Row(job, this.actions);
      row.show(job);
      rows.set(job.id, row);
    }
    const same = rows.size === this.rows.size && [...rows].every(([id, row]) => this.rows.get(id) === row);
    this.rows = rows;
    if (!same) this.list.replaceChildren(...[...rows.values()].map((row) => row.element));
  }
}
