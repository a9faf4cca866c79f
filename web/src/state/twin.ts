// The shared state of the page. Panels and views read cells; only this file talks to the server's actions.
import { Api, Refused } from "../protocol/api";
import type { Frame, ScenarioName } from "../protocol/frame";
import { Live, type Connection } from "../protocol/live";
import type { Action, CalibrationStatus, Done, Ensemble, Impacts, Person, Place, Point, ProbeSeries, SceneInfo, Series, ServerMessage, Session, Setup, ShownLayer, State, You } from "../protocol/messages";
import type { Relief } from "../scene/relief";
import { Cell } from "./cell";
import { fields } from "../protocol/schema";
import type { BarrierSet } from "./barriers";
import { usualBed, usualZone, type ZoneSet } from "./ground";
import { usualHydrograph } from "./inflows";
import { stateAt } from "./past";

export interface ScenarioCells {
  state: Cell<State | null>;
  setup: Cell<Setup | null>;
  series: Cell<Series | null>;
  impacts: Cell<Impacts | null>;
}

export type Shape = "release" | "barrier" | "building" | "zone" | "bed" | "inflow";
export type Tool = { kind: "none" } | { kind: "draw"; shape: Shape } | { kind: "probe" } | { kind: "section" };
export interface Selection { shape: Shape; id: string }
export interface Probe { at: Point; colour: string; series: Partial<Record<ScenarioName, ProbeSeries>> }
export type SurfaceColour = "off" | "depth" | "speed";
export type HouseColour = "intensity" | "pressure";

export const probeColours = ["#0072b2", "#d55e00", "#009e73", "#b8428c", "#c78500", "#6b4a94"];

const nameKey = "talus-name";

export class Twin {
  readonly connection = new Cell<{ state: Connection; retryIn_s: number }>({ state: "connecting", retryIn_s: 0 });
  readonly you = new Cell<You | null>(null);
  readonly people = new Cell<Person[]>([]);
  readonly controller = new Cell<string | null>(null);
  readonly request = new Cell<{ id: string; name: string } | null>(null);
  readonly links = new Cell<NonNullable<Session["links"]>>({});
  readonly scenarios = new Cell<ScenarioName[]>(["A"]);
  readonly edited = new Cell<ScenarioName>("A");
  readonly cells: Record<ScenarioName, ScenarioCells> = { A: emptyCells(), B: emptyCells() };
  /** Displayed time of the recording; null: live. */
  readonly replay_s = new Cell<number | null>(null);
  /** Whether the displayed frame of the recording is too compressed. */
  readonly replaySqueezed = new Cell(false);
  readonly playing = new Cell(false);
  readonly layer = new Cell<ShownLayer | "none">("none");
  /** Finished ensembles whose maps can be shown. */
  readonly ensembles = new Cell<readonly Ensemble[]>([]);
  readonly difference = new Cell(false);
  readonly layerOpacity = new Cell(0.85);
  readonly particles = new Cell(true);
  readonly surface = new Cell<SurfaceColour>("off");
  readonly contours = new Cell(true);
  readonly names = new Cell(true);
  readonly photo = new Cell(false);
  readonly houseColour = new Cell<HouseColour>("intensity");
  readonly calibration = new Cell<CalibrationStatus | null>(null);
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

  readonly api: Api;
  readonly live: Live;
  private readonly frameReaders: ((frame: Frame) => void)[] = [];
  private readonly noticeHandlers: ((sentence: string, kind: "error" | "done") => void)[] = [];

  constructor(token: string, readonly scene: SceneInfo, readonly relief: Relief, api: Api) {
    this.api = api;
    this.live = new Live(token, localStorage.getItem(nameKey) ?? "", {
      message: (message) => this.hear(message),
      frame: (frame) => {
        if (this.replay_s.value === null) for (const reader of this.frameReaders) reader(frame);
      },
      connection: (state, retryIn_s) => {
        this.connection.value = { state, retryIn_s };
        if (state !== "open") this.api.secret = null;
      },
    });
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
    this.live.show({ scenarios: this.scenarios.value, rate_hz: 30, particle_cap: 100000 });
  }
  /** The state at the displayed time. */
  shownState(scenario: ScenarioName = this.edited.value): State | null {
    const { state, series } = this.cells[scenario];
    return state.value && stateAt(state.value, series.value, this.replay_s.value);
  }
  get now(): ScenarioCells {
    return this.cells[this.edited.value];
  }
  /** Why this person cannot make changes now; null: they can. */
  get hindrance(): string | null {
    if (this.connection.value.state !== "open") return "The connection is lost; reconnecting automatically.";
    const you = this.you.value;
    if (you === null) return "Joining the session.";
    if (you.role === "viewer") return "This is a viewer's link: you can see everything but change nothing.";
    if (this.controller.value === you.id) return null;
    const holder = this.people.value.find((p) => p.id === this.controller.value);
    return holder ? `${holder.name} has control. Ask for it to change anything.` : "Nobody has control. Take it to change anything.";
  }

  /** Requests a change; a refusal is shown to the user next to `anchor`, and returns null. */
  async act(action: Action, scenario: ScenarioName = this.edited.value): Promise<Done | null> {
    try {
      return await this.api.act(scenario, action);
    } catch (error) {
      this.refused(error);
      return null;
    }
  }
  /** Back to time 0 with the current setup, also in the display. */
  async restart(): Promise<void> {
    if (this.replay_s.value !== null) {
      this.replay_s.value = null;
      this.askForFrames();
    }
    await this.act({ action: "restart" });
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
        this.you.value = message.you;
        this.api.secret = this.live.secret = message.you.secret;
        this.controller.value = message.session.controller;
        this.people.value = message.session.people;
        this.setScenarios(message.session.scenarios);
        this.askForFrames();
        void this.attempt(async () => {
          this.links.value = (await this.api.session()).links ?? {};
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
      case "scenarios":
        this.setScenarios(message.scenarios);
        this.askForFrames();
        break;
      case "done":
        this.notice((message.by === this.you.value?.name ? "" : `${message.by}: `) + message.done +
          (this.scenarios.value.length > 1 ? ` (scenario ${message.scenario})` : ""), "done");
        break;
    }
  }
  private setScenarios(scenarios: ScenarioName[]): void {
    if (!scenarios.includes("B")) {
      this.edited.value = "A";
      this.difference.value = false;
      Object.values(this.cells.B).forEach((cell: { value: unknown }) => (cell.value = null));
    }
    if (scenarios.join() !== this.scenarios.value.join()) this.scenarios.value = scenarios;
  }
}

function emptyCells(): ScenarioCells {
  return { state: new Cell<State | null>(null), setup: new Cell<Setup | null>(null), series: new Cell<Series | null>(null), impacts: new Cell<Impacts | null>(null) };
}
