// The shared state of the page. Panels and views read cells; only this file talks to the server's actions.
import { Api, Refused } from "../protocol/api";
import { scenarioNames, type Frame, type ScenarioName } from "../protocol/frame";
import { Live, type Connection } from "../protocol/live";
import type { ShownLayer } from "../protocol/layers";
import type { Possible, Transport } from "../protocol/transport";
import type { Action, Alerts, CalibrationStatus, DepthAveragedStatus, Done, Ensemble, GaugeReading, GaugeReadings, Impacts, Overlays, Person, Place, Point, ProbeSeries, SceneInfo, SectionReading, Series, ServerMessage, Session, Setup, State, You } from "../protocol/messages";
import { usualMoment, type Moment } from "../scene/natural/sun";
import type { StartPage } from "../protocol/start";
import type { Relief } from "../scene/relief";
import { Cell } from "./cell";
import { fields } from "../protocol/schema";
import type { BarrierSet } from "./barriers";
import { beginsScenario } from "./edits";
import { usualBed, usualZone, type ZoneSet } from "./ground";
import { usualHydrograph } from "./inflows";
import { runKey, runKeys } from "./alerts";
import { keepFormer } from "./former_session";
import type { OwnLooks } from "./overlays";
import { stateAt } from "./past";

export interface ScenarioCells {
  state: Cell<State | null>;
  setup: Cell<Setup | null>;
  series: Cell<Series | null>;
  impacts: Cell<Impacts | null>;
  gauges: Cell<readonly GaugeReading[] | null>;
  sections: Cell<readonly SectionReading[] | null>;
  /** Of the depth-averaged model of its setup; null, or off: not computed. */
  depthAveraged: Cell<DepthAveragedStatus | null>;
}

export type Shape = "release" | "barrier" | "building" | "zone" | "bed" | "inflow";
export type Tool = { kind: "none" } | { kind: "draw"; shape: Shape } | { kind: "probe" } | { kind: "section" } | { kind: "measure" } | { kind: "pin"; what: Pinned };
/** What is put at one place of the ground. */
export type Pinned = "gauge" | "note" | "observation";
export interface Selection { shape: Shape; id: string }
export interface Probe { at: Point; colour: string; series: Partial<Record<ScenarioName, ProbeSeries>> }
export type SurfaceColour = "off" | "depth" | "speed";
/** As it would look, or by colours that stand for values. */
export type Look = "natural" | "scientific";
/** How a run that has begun is edited: by a new scenario from the start, or on the way. */
export type Habit = "new" | "now";
export type HouseColour = "intensity" | "pressure";

export const probeColours = ["#0072b2", "#d55e00", "#009e73", "#b8428c", "#c78500", "#6b4a94"];

const nameKey = "talus-name";
const habitKey = "talus-edits";
const lookKey = "talus-look";

export class Twin {
  readonly connection = new Cell<{ state: Connection; retryIn_s: number }>({ state: "connecting", retryIn_s: 0 });
  readonly you = new Cell<You | null>(null);
  readonly people = new Cell<Person[]>([]);
  readonly controller = new Cell<string | null>(null);
  readonly request = new Cell<{ id: string; name: string } | null>(null);
  readonly links = new Cell<Session["links"]>({});
  readonly scenarios = new Cell<ScenarioName[]>(["A"]);
  /** One, or two side by side, in the order of their names. */
  readonly shown = new Cell<ScenarioName[]>(["A"]);
  /** Where two that are shown meet in one picture, as a share of its width; null: they stand side by side. */
  readonly divider = new Cell<number | null>(null);
  /** One of those shown, which the controls change. */
  readonly edited = new Cell<ScenarioName>("A");
  readonly cells = Object.fromEntries(scenarioNames.map((name) => [name, emptyCells()])) as Record<ScenarioName, ScenarioCells>;
  /** null: it is asked for at the first edit of a run that has begun. */
  readonly habit = new Cell<Habit | null>(sessionStorage.getItem(habitKey) as Habit | null);
  /** Asks which of the two; null: neither. */
  askHabit: (scenario: ScenarioName) => Promise<Habit | null> = async () => "new";
  /** Displayed time of the recording; null: live. */
  readonly replay_s = new Cell<number | null>(null);
  /** Whether the displayed frame of the recording is too compressed. */
  readonly replayOvercompressed = new Cell(false);
  readonly playing = new Cell(false);
  readonly layer = new Cell<ShownLayer | "none">("none");
  /** Finished ensembles whose maps can be shown. */
  readonly ensembles = new Cell<readonly Ensemble[]>([]);
  readonly difference = new Cell(false);
  readonly layerOpacity = new Cell(0.85);
  readonly look = new Cell<Look>(localStorage.getItem(lookKey) === "scientific" ? "scientific" : "natural");
  /** Date and hour of the natural look's light. */
  readonly moment = new Cell<Moment>(usualMoment);
  readonly particles = new Cell(true);
  readonly surface = new Cell<SurfaceColour>("off");
  readonly contours = new Cell(true);
  readonly names = new Cell(true);
  readonly photo = new Cell(false);
  readonly houseColour = new Cell<HouseColour>("intensity");
  readonly calibration = new Cell<CalibrationStatus | null>(null);
  readonly alerts = new Cell<Alerts | null>(null);
  /** Layers over the terrain, from bottom to top. */
  readonly overlays = new Cell<Overlays | null>(null);
  /** How this person sees layers otherwise than everybody, by id: one who cannot change them for all. */
  readonly ownOverlays = new Cell<OwnLooks>(new Map());
  /** Address of map tiles below the layers, of this browser alone; null: none. */
  readonly tileAddress = new Cell<string | null>(null);
  /** Addresses that the server had when this page was loaded: its policy allows no other hosts. null: not known yet. */
  tilesAtLoad: readonly string[] | null = null;
  readonly tool = new Cell<Tool>({ kind: "none" });
  readonly selection = new Cell<Selection | null>(null);
  /** Thickness, height and other initial values of the next drawn shape. */
  readonly newShape = { release: { thickness_m: fields.release.thickness_m.first as number },
    barrier: { height_m: fields.barrier.height_m.first, thickness_m: fields.barrier.thickness_m.first, passing_share: null } as BarrierSet,
    building: { height_m: fields.buildings.height_m.first as number }, zone: { ...usualZone.friction } as ZoneSet, bed: { ...usualBed }, inflow: { hydrograph: usualHydrograph } };
  /** Whether the next inflow is drawn as a line; otherwise as an area. */
  readonly inflowByLine = new Cell(true);
  readonly probes = new Cell<readonly Probe[]>([]);
  readonly section = new Cell<readonly Point[] | null>(null);
  /** Where something is put; null once its name is asked for. */
  readonly pinned = new Cell<{ what: Pinned; at: Point } | null>(null);
  /** Line or outline that is measured. */
  readonly measured = new Cell<readonly Point[] | null>(null);

  readonly api: Api;
  readonly live: Live;
  /** The one that this page shows, as the server names it. */
  private session: string | null = null;
  private beginning: Promise<unknown> = Promise.resolve();
  private readonly frameReaders: ((frame: Frame) => void)[] = [];
  private readonly noticeHandlers: ((sentence: string, kind: "error" | "done") => void)[] = [];

  constructor(transport: Transport, readonly scene: SceneInfo, readonly relief: Relief, api: Api, readonly place: StartPage) {
    this.api = api;
    this.live = new Live(transport, localStorage.getItem(nameKey) ?? "", {
      message: (message) => this.hear(message),
      frame: (frame) => {
        if (this.replay_s.value === null) for (const reader of this.frameReaders) reader(frame);
      },
      connection: (state, retryIn_s) => {
        this.connection.value = { state, retryIn_s };
        if (state !== "open") this.api.secret = null;
      },
      mayReturn: () => this.mayReturn(),
    });
  }
  private async mayReturn(): Promise<boolean> {
    try {
      const place = await this.api.start();
      if (place.available && place.open === null) {
        this.leave();
        return false;
      }
    } catch (error) {
      if (error instanceof Refused && (error.status === 401 || error.status === 403)) {
        this.connection.value = { state: "refused", retryIn_s: 0 };
        return false;
      }
    }
    return true;  // hello tells which session it is; a server that does not answer is tried again
  }
  /** To the session that is open now, or to the start page, where the person is told what is gone. */
  private leave(): void {
    keepFormer({ title: this.scene.title, runs: this.scenarios.value.map((scenario) => ({ scenario, time_s: this.cells[scenario].state.value?.time_s ?? 0 })) });
    location.reload();
  }
  /** A map layer and a surface by depth or speed are always drawn in the colours of their legends. */
  get natural(): boolean {
    return this.look.value === "natural" && this.layer.value === "none" && this.surface.value === "off";
  }
  setLook(look: Look): void {
    localStorage.setItem(lookKey, look);
    if (look === "natural") {
      this.layer.value = "none";
      this.surface.value = "off";
    }
    this.look.value = look;
  }
  onFrame(reader: (frame: Frame) => void): void {
    this.frameReaders.push(reader);
  }
  /** Shows a frame of the recording as if it had just been received. */
  showFrame(frame: Frame): void {
    for (const reader of this.frameReaders) reader(frame);
  }
  onNotice(handler: (sentence: string, kind: "error" | "done") => void): void {
    this.noticeHandlers.push(handler);
  }
  notice(sentence: string, kind: "error" | "done"): void {
    for (const handle of this.noticeHandlers) handle(sentence, kind);
  }

  askForFrames(): void {
    this.live.show({ scenarios: this.shown.value, rate_hz: 30, particle_cap: 100000 });
  }
  /** That cell of every scenario there can be. */
  every<K extends keyof ScenarioCells>(which: K): ScenarioCells[K][] {
    return scenarioNames.map((name) => this.cells[name][which]);
  }
  /** Shows one or two scenarios; the controls change `edited`. */
  show(names: readonly ScenarioName[], edited: ScenarioName): void {
    const ordered = [...new Set(names)].sort();
    if (ordered.join() !== this.shown.value.join()) {
      this.replay_s.value = null;
      this.shown.value = ordered;
      if (ordered.length < 2) this.difference.value = false;
      this.askForFrames();
    }
    this.edited.value = edited;
  }
  /** What a difference of the two scenarios shown is. */
  get differenceName(): string {
    return `${this.shown.value[1] ?? ""} − ${this.shown.value[0]}`;
  }
  /** Whether any of the scenarios shown runs. */
  get running(): boolean {
    return this.shown.value.some((name) => this.cells[name].state.value?.status === "running");
  }
  /** What structures, gauges and cross-sections have met until a time, or until now; a scenario without the latter two is not asked about them. */
  readings(s: ScenarioName, time_s: number | null): Promise<[Impacts, GaugeReadings]> {
    const measures = (this.cells[s].setup.value?.gauges.length ?? 0) > 0 || this.scene.cross_sections.length > 0;
    return Promise.all([this.api.impacts(s, time_s), measures ? this.api.gauges(s, time_s) : { gauges: [], cross_sections: [] }]);
  }
  showReadings(s: ScenarioName, [impacts, { gauges, cross_sections }]: readonly [Impacts, GaugeReadings]): void {
    const cells = this.cells[s];
    cells.impacts.value = impacts;
    cells.gauges.value = gauges;
    cells.sections.value = cross_sections;
  }
  /** The state at the displayed time. */
  shownState(scenario: ScenarioName = this.edited.value): State | null {
    const { state, series } = this.cells[scenario];
    return state.value && stateAt(state.value, series.value, this.replay_s.value);
  }
  get now(): ScenarioCells {
    return this.cells[this.edited.value];
  }
  /** What can be done where the page is. */
  get can(): Possible {
    return this.api.can;
  }
  /** Why this person cannot make changes now; null: they can. */
  get hindrance(): string | null {
    if (!this.can.change) return "This is a recording: it can be watched, not changed.";
    if (this.connection.value.state === "refused") return "This link is no longer valid.";
    if (this.connection.value.state !== "open") return "The connection is lost; reconnecting automatically.";
    const you = this.you.value;
    if (you === null) return "Joining the session.";
    if (you.role === "viewer") return "This is a viewer's link: you can see everything but change nothing.";
    if (this.controller.value === you.id) return null;
    const holder = this.people.value.find((p) => p.id === this.controller.value);
    return holder ? `${holder.name} has control. Ask for it to change anything.` : "Nobody has control. Take it to change anything.";
  }

  /** Requests a change; a refusal is shown to the user next to the control used last, and returns null, as does a change of mind. */
  async act(action: Action): Promise<Done | null> {
    try {
      if (action.action === "cancel") return await this.api.act(this.edited.value, action);
      await this.beginning; // a scenario that is being made is the one to change
      const scenario = this.edited.value;
      const begun = (this.cells[scenario].state.value?.step ?? 0) > 0;
      if (!begun || !beginsScenario(action)) return await this.api.act(scenario, action);
      const habit = this.habit.value ?? (await this.askHabit(scenario));
      if (habit === null) return null;
      this.setHabit(habit);
      return habit === "now" ? await this.api.act(scenario, action) : await this.begin(scenario, action);
    } catch (error) {
      this.refused(error);
      return null;
    }
  }
  setHabit(habit: Habit): void {
    sessionStorage.setItem(habitKey, habit);
    this.habit.value = habit;
  }
  /** A new scenario from time 0 with the setup of another, shown beside it; an action is applied to it first. */
  begin(from: ScenarioName, action: Action | null): Promise<Done> {
    const begun = this.api.addScenario(from, action).then(({ done, created, object }) => {
      if (!this.scenarios.value.includes(created)) this.scenarios.value = [...this.scenarios.value, created].sort();
      this.show([from, created], created);
      return { done, created: object };
    });
    this.beginning = begun.catch(() => null);
    return begun;
  }
  /** Run, pause, step or restart of the scenarios shown. */
  async drive(action: "run" | "pause" | "step" | "restart"): Promise<void> {
    await this.act({ action, scenarios: this.shown.value });
  }
  /** Back to time 0 with the current setup, also in the display. */
  async restart(): Promise<void> {
    if (this.replay_s.value !== null) {
      this.replay_s.value = null;
      this.askForFrames();
    }
    await this.drive("restart");
  }
  async attempt(work: () => Promise<void>): Promise<boolean> {
    try {
      await work();
      return true;
    } catch (error) {
      this.refused(error);
      return false;
    }
  }
  private refused(error: unknown): void {
    if (error instanceof Refused) this.notice(error.message, "error");
    else {
      console.error(error);
      this.notice("The page could not do that.", "error");
    }
  }
  rename(name: string): void {
    localStorage.setItem(nameKey, name);
    this.live.rename(name);
  }
  mark(at: Place | null): void {
    this.live.mark(at);
  }

  private hear(message: ServerMessage): void {
    switch (message.type) {
      case "hello":
        if (this.session !== null && this.session !== message.session.id) return this.leave();
        this.session = message.session.id;
        this.you.value = message.you;
        this.api.secret = this.live.secret = message.you.secret;
        this.controller.value = message.session.controller;
        this.people.value = message.session.people;
        for (const cell of this.every("depthAveraged")) cell.value = null;  // those that there are come next
        this.setScenarios(message.session.scenarios);
        this.askForFrames();
        void this.attempt(async () => {
          this.links.value = (await this.api.session()).links;
          if (this.ensembles.value.length === 0) this.ensembles.value = await this.api.ensembles();
        });
        break;
      case "state":
        this.cells[message.scenario].state.value = message;
        break;
      case "setup":
        this.cells[message.scenario].setup.value = message;
        break;
      case "people":
        this.people.value = message.people;
        this.controller.value = message.controller;
        this.request.value = message.request;
        break;
      case "calibration":
        this.calibration.value = message;
        break;
      case "alerts":
        this.hearAlerts(message);
        break;
      case "overlays":
        this.tilesAtLoad ??= message.tiles.map(({ address }) => address);
        this.overlays.value = message;
        break;
      case "depth_averaged":
        this.cells[message.scenario].depthAveraged.value = message;
        break;
      case "scenarios":
        this.setScenarios(message.scenarios);
        this.askForFrames();
        break;
      case "ended":
        location.reload();  // another scene has been opened in place of this one
        break;
      case "done":
        this.notice((message.by === this.you.value?.name ? "" : `${message.by}: `) + message.done +
          (this.scenarios.value.length > 1 ? ` (scenario ${message.scenario})` : ""), "done");
        break;
    }
  }
  /** A run that a trigger has just started is shown to everybody, live. */
  private hearAlerts(alerts: Alerts): void {
    const known = runKeys(this.alerts.value);
    const fresh = this.alerts.value === null ? undefined : alerts.runs.filter((run) => !known.includes(runKey(run))).at(-1);
    this.alerts.value = alerts;
    if (!fresh) return;
    if (!this.scenarios.value.includes(fresh.scenario)) this.scenarios.value = [...this.scenarios.value, fresh.scenario].sort();
    this.replay_s.value = null;
    this.show([fresh.scenario], fresh.scenario);
    this.askForFrames();
  }
  /** A scenario that somebody has made is shown beside the first one shown. */
  private setScenarios(scenarios: ScenarioName[]): void {
    const fresh = scenarios.filter((name) => !this.scenarios.value.includes(name)).at(-1);
    for (const name of scenarioNames) {
      if (!scenarios.includes(name)) Object.values(this.cells[name]).forEach((cell: { value: unknown }) => (cell.value = null));
    }
    if (scenarios.join() !== this.scenarios.value.join()) this.scenarios.value = scenarios;
    const kept = this.shown.value.filter((name) => scenarios.includes(name));
    const first = kept[0] ?? "A";
    const shown = fresh ? [first, fresh] : kept.length > 0 ? kept : [first];
    this.show(shown, shown.includes(this.edited.value) ? this.edited.value : first);
  }
}

function emptyCells(): ScenarioCells {
  return { state: new Cell<State | null>(null), setup: new Cell<Setup | null>(null), series: new Cell<Series | null>(null), impacts: new Cell<Impacts | null>(null),
    gauges: new Cell<readonly GaugeReading[] | null>(null), sections: new Cell<readonly SectionReading[] | null>(null), depthAveraged: new Cell<DepthAveragedStatus | null>(null) };
}
