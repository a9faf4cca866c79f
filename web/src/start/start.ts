// The start page: choose a scene, or a saved session, and wait until it is open.
import "../style/start.css";
import mark from "../style/mark.svg";
import { Refused, type Api } from "../protocol/api";
import type { Job, KnownScene, SavedSession, StartPage } from "../protocol/start";
import { takeFormer, whatIsGone } from "../state/former_session";
import { askFor } from "../ui/dialog";
import { button, h, icon } from "../ui/dom";
import { save } from "../ui/save";
import { Toasts } from "../ui/toast";
import { JobList } from "./job_list";
import { NewJob } from "./new_job";
import { NewScene } from "./new_scene";

const opening_ms = 250;
const idle_ms = 2000;

export function openStart(page: HTMLElement, api: Api, first: StartPage): void {
  document.title = "talus";
  page.classList.remove("starting");
  page.classList.add("start");
  new Start(page, api, first);
}

/** To the session that is open. */
export function toTwin(): void {
  history.replaceState(null, "", location.pathname);
  location.reload();
}

const day = new Intl.DateTimeFormat("en-GB", { day: "numeric", month: "short", year: "numeric", hour: "2-digit", minute: "2-digit" });
const fileName = (title: string): string => title.toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-|-$/g, "").slice(0, 60) || "scene";
const dateText = (iso: string): string => day.format(new Date(iso));

class Start {
  private readonly toasts = new Toasts();
  private readonly state = h("div", { class: "start-state", "aria-live": "polite" });
  private readonly lists = h("div", { class: "start-lists" });
  /** A session that is gone. */
  private readonly former = h("div", { class: "start-state" });
  /** A new scene, while one is made. */
  private readonly making = h("div", {});
  private readonly back = h("div", { class: "start-back" });
  private readonly foot = h("footer", { class: "start-foot muted" });
  private readonly jobs = new JobList({
    cancel: (job) => void this.attempt(() => this.api.cancelJob(job.id)),
    resume: (job) => void this.attempt(() => this.api.resumeJob(job.id)),
    remove: (job) => void this.removeJob(job),
    open: (job) => void this.open({ ensemble: job.id }, job.title),
  });
  /** What the lists show, as text: they are made again only if it is another. */
  private told = "";

  constructor(page: HTMLElement, private readonly api: Api, private now: StartPage) {
    const home = h("div", { class: "start-page" },
      h("header", { class: "start-head" }, h("img", { src: mark, alt: "", width: 44, height: 44 }),
        h("div", {}, h("h1", {}, "talus"), h("p", { class: "muted" }, "Landslides and debris flows on real terrain, live in the browser")), this.back),
      this.former, this.state, this.making, this.lists, this.foot);
    page.replaceChildren(h("main", { class: "start-scroll" }, home), this.toasts.polite, this.toasts.urgent);
    this.tellFormer();
    this.show(now);
    void this.watch();
  }

  private async watch(): Promise<void> {
    for (;;) {
      await new Promise((resolve) => setTimeout(resolve, this.now.opening ? opening_ms : idle_ms));
      let next: StartPage;
      try {
        next = await this.api.start();
      } catch (error) {
        this.lost(error);
        continue;
      }
      // A scene that somebody has opened is where everybody goes.
      if (next.count > this.now.count && next.open) return toTwin();
      this.show(next);
    }
  }

  /** Of the saved sessions the newest of the same scene is offered. */
  private tellFormer(): void {
    const former = takeFormer();
    if (former === null) return;
    const saved = (this.now.sessions ?? []).filter((s) => s.title === former.title).sort((a, b) => b.saved_at.localeCompare(a.saved_at))[0];
    this.former.replaceChildren(h("div", { class: "card bad former", role: "alert" }, h("b", {}, "talus was restarted"), h("p", {}, whatIsGone(former)),
      saved ? h("div", { class: "row answers" }, button(`Open “${saved.name}”, saved ${dateText(saved.saved_at)}`, { class: "primary", onclick: () => void this.open({ session: saved.id }, saved.name) })) : null));
  }
  private lost(error: unknown): void {
    if (error instanceof Refused && error.status === 401) {
      this.state.replaceChildren(h("div", { class: "card bad", role: "alert" }, h("b", {}, "This link is no longer valid"),
        h("p", {}, "talus was restarted, and its links have changed: open the new one.")));
      return;
    }
    this.state.replaceChildren(h("div", { class: "card bad", role: "alert" }, h("b", {}, "talus does not answer"),
      h("p", {}, "It has ended, or it is busy. Start it again with talus, or from the menu.")));
  }

  private show(next: StartPage): void {
    this.now = next;
    const busy = next.opening !== null;
    if (next.opening) {
      const bar = h("progress", { max: 1, "aria-label": "Share done" });
      if (next.opening.share > 0) bar.value = next.opening.share;
      this.state.replaceChildren(h("div", { class: "card opening" }, h("div", { class: "grow" }, h("b", {}, `Opening ${next.opening.what} …`), bar),
        next.role === "controller" ? button("Cancel", { onclick: () => void this.attempt(() => this.api.cancelOpening()) }) : null));
    } else if (next.error !== null && next.error !== "cancelled") {
      this.state.replaceChildren(h("div", { class: "card bad", role: "alert" }, h("b", {}, "That could not be opened"), h("p", {}, next.error)));
    } else this.state.replaceChildren();
    this.jobs.show(next.jobs ?? []);
    const told = JSON.stringify([next.open, next.scenes, next.sessions, busy, next.jobs?.length ?? null]);
    if (told === this.told) return;
    this.told = told;
    this.back.replaceChildren(next.open ? button(`Back to ${next.open.title}`, { icon: "run", class: "primary", onclick: toTwin }) : "");
    if (next.role === "viewer") {
      this.lists.replaceChildren(h("p", { class: "empty" }, next.open ? "You can watch the session that is open." : "No scene is open yet. The session appears here by itself."));
      return;
    }
    this.lists.replaceChildren(this.scenes(next.scenes ?? [], busy), this.sessions(next.sessions ?? [], busy), ...(next.jobs ? [this.jobSection(next.jobs)] : []));
    this.foot.replaceChildren(h("span", {}, `${next.program} · kept in ${next.folder ?? ""}`),
      button("End talus", { class: "quiet", onclick: () => void this.quit() }));
  }

  private scenes(list: KnownScene[], busy: boolean): HTMLElement {
    return h("section", { "aria-labelledby": "start-scenes" },
      h("div", { class: "start-title" }, h("h2", { id: "start-scenes" }, "Scenes"), button("New scene", { icon: "plus", class: "primary", disabled: busy, onclick: () => void this.make() })),
      h("ul", { class: "start-list" }, ...list.map((scene) => {
        const where = scene.kind === "builtin" ? "Built in: Hong Kong, 600 m³ through a village" : (scene.file ?? "");
        const open = h("button", { type: "button", class: "start-row", disabled: busy || scene.missing, "data-scene": scene.id, onclick: () => void this.open({ scene: scene.id }, scene.title) },
          icon("layers"), h("span", { class: "grow" }, h("b", {}, scene.title || "Scene without a title"), h("span", { class: "muted path" }, scene.missing ? `${where} is no longer there` : where)),
          scene.opened_at ? h("span", { class: "muted date" }, dateText(scene.opened_at)) : null);
        const forget = scene.kind === "recent" ? button(`Remove ${scene.title} from this list`, { icon: "close", bare: true, class: "bare quiet", onclick: () => void this.attempt(() => this.api.forgetScene(scene.id)) }) : null;
        const name = scene.title || "this scene";
        const fetch = scene.missing ? null : button(`Download ${name} with all its files`, { icon: "download", bare: true, class: "bare quiet", onclick: () => void this.attempt(async () => save(`${fileName(name)}.zip`, await this.api.sceneBundle(scene.id))) });
        const compute = scene.missing || !this.now.jobs ? null : button(`Ensemble or calibration of ${name}`, { icon: "bars", bare: true, class: "bare quiet", onclick: () => this.makeJob(scene.id) });
        const remove = scene.kind === "own" ? button(`Delete ${name}`, { icon: "remove", bare: true, class: "bare quiet", onclick: () => void this.removeScene(scene) }) : null;
        return h("li", {}, open, compute, fetch, remove, forget);
      })));
  }

  private jobSection(jobs: Job[]): HTMLElement {
    return h("section", { "aria-labelledby": "start-jobs" },
      h("div", { class: "start-title" }, h("h2", { id: "start-jobs" }, "Ensembles, calibrations, risk, barriers, validation"), button("New job", { icon: "plus", onclick: () => this.makeJob(null) })),
      jobs.length === 0 ? h("p", { class: "empty" }, "Many runs of a scene, in processes of their own, one job at a time. What is finished stays here.") : null, this.jobs.list);
  }
  private makeJob(scene: string | null): void {
    const made = new NewJob(this.api, this.now.scenes ?? [], scene, () => {
      this.making.replaceChildren();
      this.lists.hidden = false;
      void this.api.start().then((next) => this.show(next), () => undefined);
    });
    this.making.replaceChildren(made.element);
    this.lists.hidden = true;
  }
  private async removeJob(job: Job): Promise<void> {
    const answer = await askFor(`Delete this ${job.kind}?`, [`Its results are deleted: ${job.folder}`], [["remove", "Delete it"]] as const);
    if (answer !== null) await this.attempt(() => this.api.removeJob(job.id));
  }

  private sessions(list: SavedSession[], busy: boolean): HTMLElement {
    const file = h("input", { type: "file", accept: ".json,application/json", class: "unseen", tabindex: -1, "aria-label": "Saved session file", onchange: () => void this.upload(file) });
    return h("section", { "aria-labelledby": "start-sessions" },
      h("div", { class: "start-title" }, h("h2", { id: "start-sessions" }, "Saved sessions"), file, button("Add a file", { class: "quiet", onclick: () => file.click() })),
      list.length === 0 ? h("p", { class: "empty" }, "A session is saved on its page: its scenarios with all edits. Opened again, each is computed to the same result.") : null,
      h("ul", { class: "start-list" }, ...list.map((saved) => h("li", {},
        h("button", { type: "button", class: "start-row", disabled: busy, "data-session": saved.id, onclick: () => void this.open({ session: saved.id }, saved.name) },
          icon("save"), h("span", { class: "grow" }, h("b", {}, saved.name), h("span", { class: "muted path" }, `${saved.title} · ${saved.scenarios} ${saved.scenarios === 1 ? "scenario" : "scenarios"}`)),
          h("span", { class: "muted date" }, dateText(saved.saved_at))),
        button(`Remove ${saved.name}`, { icon: "remove", bare: true, class: "bare quiet", onclick: () => void this.remove(saved) })))));
  }

  private async open(what: { scene: string } | { session: string } | { ensemble: string }, name: string): Promise<void> {
    if (this.now.open) {
      const answer = await askFor(`Open ${name}?`, [`“${this.now.open.title}” is open. It ends for everybody who watches it, and what is not saved is lost.`], [["open", "End it and open this"]] as const);
      if (answer === null) return;
    }
    await this.attempt(async () => {
      for (let tries = 0; ; ++tries) {
        try {
          return await this.api.openScene({ ...what, replace: this.now.open !== null });
        } catch (error) {
          // Whoever comes here from the session keeps its control for some seconds.
          if (tries >= 10 || !(error instanceof Refused && error.status === 409 && /was here just now/.test(error.message))) throw error;
          await new Promise((resolve) => setTimeout(resolve, 500));
        }
      }
    });
  }
  private async make(): Promise<void> {
    await this.attempt(async () => {
      const id = await this.api.beginDraft();
      const close = (): void => {
        this.making.replaceChildren();
        this.lists.hidden = false;
      };
      const made = new NewScene(this.api, id, this.now.uploads ?? { bytes: Infinity, files: Infinity, cells: Infinity }, (scene, title) => {
        close();
        void this.open({ scene }, title);
      }, close);
      this.making.replaceChildren(made.element);
      this.lists.hidden = true;
    });
  }
  private async removeScene(scene: KnownScene): Promise<void> {
    const answer = await askFor(`Delete ${scene.title}?`, ["The scene is deleted with its files. Saved sessions of it can no longer be opened."], [["remove", "Delete it"]] as const);
    if (answer !== null) await this.attempt(() => this.api.removeScene(scene.id));
  }
  private async remove(saved: SavedSession): Promise<void> {
    const answer = await askFor(`Remove ${saved.name}?`, ["The saved session is deleted. Its scene stays."], [["remove", "Remove it"]] as const);
    if (answer !== null) await this.attempt(() => this.api.removeSession(saved.id));
  }
  private async upload(input: HTMLInputElement): Promise<void> {
    const file = input.files?.[0];
    input.value = "";
    if (!file) return;
    await this.attempt(async () => {
      let content: unknown;
      try {
        content = JSON.parse(await file.text());
      } catch {
        throw new Refused(0, `${file.name} is no saved session: it is not JSON.`);
      }
      await this.api.saveSession(file.name.replace(/\.json$/i, ""), content);
    });
  }
  private async quit(): Promise<void> {
    const answer = await askFor("End talus?", [this.now.open ? "The session that is open ends for everybody, and what is not saved is lost." : "This page closes its connection."], [["end", "End talus"]] as const);
    if (answer === null) return;
    if (await this.attempt(() => this.api.quit())) {
      document.getElementById("page")?.replaceChildren(h("div", { class: "boot", role: "status" }, h("h1", {}, "talus has ended"), h("p", {}, "This tab can be closed.")));
    }
  }
  /** Shows why something was refused. */
  private async attempt(act: () => Promise<void>): Promise<boolean> {
    try {
      await act();
      this.show(await this.api.start().catch(() => this.now));
      return true;
    } catch (error) {
      this.toasts.show(error instanceof Error ? error.message : String(error), "error");
      return false;
    }
  }
}
