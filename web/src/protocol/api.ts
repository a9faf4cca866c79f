// The HTTP half of docs/protocol.md.
import type { Possible, Transport } from "./transport";
import { decodeFrame, type Frame, type ScenarioName } from "./frame";
import { decodeGrid, type Grid } from "./grid";
import type { Action, DepthAveragedComparison, Done, Ensemble, ExportFile, Figure, FlowExport, FlowFormat, FlowOffer, GaugeReadings, Impacts, LayerName, NewScenario, Observed, OverlayData, ProbeSeries, Recording, SceneInfo, Series, Session, Setup, Share, State, Tiles, WantedOverlay, WantedShare } from "./messages";
import type { Checked, Draft, DraftRole, JobEstimate, JobForm, MendingOfTerrain, StartPage, ValidationCase, WantedJob, WantedScene } from "./start";

/** The server's answer to a request that it refused. */
export class Refused extends Error {
  constructor(readonly status: number, message: string) {
    super(message);
  }
}

const at = (time_s: number | null): string => (time_s === null ? "" : `?time_s=${time_s.toFixed(4)}`);

/** What the server says against a request, or its status. */
function refusal(status: number, path: string, text: string): Refused {
  try {
    const told = JSON.parse(text) as { error?: unknown };
    if (typeof told.error === "string") return new Refused(status, told.error);
  } catch {
    // The answer was not JSON: use the status.
  }
  return new Refused(status, `The server answered ${status} to ${path}.`);
}

/** The connection broke, before the answer or inside it: browsers say both with a TypeError of their own words. */
function noAnswer(error: unknown): never {
  throw error instanceof TypeError ? new Refused(0, "The server does not answer.") : error;
}

export class Api {
  /** Of this page's person, once the WebSocket has said hello. */
  secret: string | null = null;
  /** How many answers were asked for, and how many have been read or refused. */
  readonly reads = { begun: 0, ended: 0 };

  constructor(private readonly transport: Transport) {}

  get can(): Possible {
    return this.transport.can;
  }
  private async ask(method: string, path: string, body?: object): Promise<Response> {
    const response = await this.transport.ask(method, path, body, method === "GET" ? null : this.secret).catch(noAnswer);
    if (!response.ok) throw refusal(response.status, path, await response.text().catch(() => ""));
    return response;
  }
  /** Sends a file; `onshare` is told which share of it has been sent. */
  private async upload<T>(path: string, file: File, onshare: (share: number) => void): Promise<T> {
    const response = await this.transport.upload(path, file, this.secret, onshare).catch(noAnswer);
    if (!response.ok) throw refusal(response.status, path, await response.text());
    return response.json() as Promise<T>;
  }
  private async get<T>(path: string, read: (response: Response) => Promise<T>): Promise<T> {
    ++this.reads.begun;
    try {
      return await read(await this.ask("GET", path)).catch(noAnswer);
    } finally {
      ++this.reads.ended;
    }
  }
  /** Asks for a change, and for what the server says came of it. */
  private async told<T>(method: string, path: string, body?: object): Promise<T> {
    return (await this.ask(method, path, body)).json().catch(noAnswer) as Promise<T>;
  }
  private readonly json = <T>(path: string): Promise<T> => this.get(path, (response) => response.json() as Promise<T>);
  private readonly binary = (path: string): Promise<ArrayBuffer> => this.get(path, (response) => response.arrayBuffer());
  private readonly blob = (path: string): Promise<Blob> => this.get(path, (response) => response.blob());

  session = (): Promise<Session> => this.json("session");
  scene = (): Promise<SceneInfo> => this.json("scene");
  terrain = async (maxCells: number): Promise<Grid> => decodeGrid(await this.binary(`terrain?max_cells=${maxCells}`));
  state = (s: ScenarioName): Promise<State> => this.json(`scenarios/${s}/state`);
  setup = (s: ScenarioName): Promise<Setup> => this.json(`scenarios/${s}/setup`);
  series = (s: ScenarioName): Promise<Series> => this.json(`scenarios/${s}/series`);
  /** Now, or at a time of the recording. */
  impacts = (s: ScenarioName, time_s: number | null = null): Promise<Impacts> => this.json(`scenarios/${s}/impacts${at(time_s)}`);
  gauges = async (s: ScenarioName, time_s: number | null = null): Promise<GaugeReadings> =>
    this.json<GaugeReadings>(`scenarios/${s}/gauges${at(time_s)}`);
  observed = (s: ScenarioName): Promise<Observed> => this.json(`scenarios/${s}/observed`);
  figures = async (s: ScenarioName): Promise<Figure[]> => (await this.json<{ figures: Figure[] }>(`scenarios/${s}/figures`)).figures;
  recording = (s: ScenarioName): Promise<Recording> => this.json(`scenarios/${s}/recording`);
  layer = async (s: ScenarioName, name: LayerName, time_s: number | null = null): Promise<Grid> =>
    decodeGrid(await this.binary(`scenarios/${s}/layers/${name}${at(time_s)}`));
  /** Of the depth-averaged model. */
  depthAveragedLayer = async (s: ScenarioName, name: LayerName, time_s: number | null): Promise<Grid> =>
    decodeGrid(await this.binary(`scenarios/${s}/depth_averaged/layers/${name}${at(time_s)}`));
  depthAveragedComparison = (s: ScenarioName): Promise<DepthAveragedComparison> => this.json(`scenarios/${s}/depth_averaged/comparison`);
  turnDepthAveraged = async (on: boolean): Promise<void> => void (await this.ask("POST", "depth_averaged", { on }));
  ensembles = async (): Promise<Ensemble[]> => (await this.json<{ ensembles: Ensemble[] }>("ensembles")).ensembles;
  ensembleMap = async (ensemble: string, name: string): Promise<Grid> => decodeGrid(await this.binary(`ensembles/${ensemble}/maps/${name}`));
  orthophoto = (): Promise<Blob> => this.blob("orthophoto");
  frame = async (s: ScenarioName, time_s: number | null): Promise<Frame> =>
    (time_s === null ? null : await this.transport.frame?.(s, time_s)) ?? decodeFrame(await this.binary(`scenarios/${s}/frame${at(time_s)}`));
  probe = (s: ScenarioName, x: number, y: number): Promise<ProbeSeries> =>
    this.json(`scenarios/${s}/probe?x_m=${x.toFixed(2)}&y_m=${y.toFixed(2)}`);
  exports = async (s: ScenarioName): Promise<ExportFile[]> => (await this.json<{ files: ExportFile[] }>(`scenarios/${s}/exports`)).files;
  exported = (s: ScenarioName, name: string): Promise<Blob> => this.blob(`scenarios/${s}/exports/${name}`);
  /** The moving flow as files: what there would be, how far they are. */
  flowOffer = (s: ScenarioName, interval_s: number | null): Promise<FlowOffer> => this.json(`scenarios/${s}/flow${interval_s === null ? "" : `?interval_s=${interval_s}`}`);
  startFlow = (s: ScenarioName, formats: FlowFormat[], interval_s: number): Promise<FlowExport> => this.told("POST", `scenarios/${s}/flow`, { formats, interval_s });
  flow = (): Promise<FlowExport> => this.json("flow");
  cancelFlow = (): Promise<FlowExport> => this.told("DELETE", "flow");
  flowFile = (name: string): Promise<Blob> => this.blob(`flow/${name}`);
  journal = (s: ScenarioName): Promise<Blob> => this.blob(`scenarios/${s}/journal`);

  act = (s: ScenarioName, action: Action): Promise<Done> =>
    this.told("POST", `scenarios/${s}/actions`, action);
  /** Another scenario from time 0, with an action applied to it first. */
  addScenario = (of: ScenarioName, action: Action | null): Promise<NewScenario> =>
    this.told("POST", "scenarios", { copy_of: of, ...(action === null ? {} : { action }) });
  endScenario = async (s: ScenarioName): Promise<void> => void (await this.ask("DELETE", `scenarios/${s}`));
  calibrate = async (parameters: { key: string; low: number; high: number }[], runs: number, searchWith: "depth_averaged" | null): Promise<void> =>
    void (await this.ask("POST", "calibration", { parameters, runs, search_with: searchWith }));
  cancelCalibration = async (): Promise<void> => void (await this.ask("DELETE", "calibration"));
  overlay = (id: string): Promise<OverlayData> => this.json(`overlays/${id}`);
  overlayPicture = (id: string): Promise<Blob> => this.blob(`overlays/${id}/picture`);
  tiles = (): Promise<Tiles> => this.json("tiles");
  addTiles = (address: string): Promise<Done> => this.told("POST", "tiles", { address });
  removeTiles = (id: string): Promise<Done> => this.told("DELETE", `tiles/${id}`);
  addOverlay = (file: File, onshare: (share: number) => void): Promise<Done> => this.upload(`overlays?name=${encodeURIComponent(file.name)}`, file, onshare);
  changeOverlay = (id: string, wanted: WantedOverlay): Promise<Done> => this.told("POST", `overlays/${id}`, wanted);
  removeOverlay = (id: string): Promise<Done> => this.told("DELETE", `overlays/${id}`);
  restoreOverlay = (): Promise<Done> => this.told("POST", "overlays", {});
  start = (): Promise<StartPage> => this.json("start");
  openScene = async (what: { scene?: string; session?: string; ensemble?: string; replace: boolean }): Promise<void> => void (await this.ask("POST", "open", what));
  cancelOpening = async (): Promise<void> => void (await this.ask("DELETE", "open"));
  forgetScene = async (id: string): Promise<void> => void (await this.ask("DELETE", `recent/${id}`));
  /** The open session, or the content of a file of one. */
  saveSession = async (name: string, file?: unknown): Promise<void> => void (await this.ask("POST", "sessions", { name, ...(file === undefined ? {} : { file }) }));
  removeSession = async (id: string): Promise<void> => void (await this.ask("DELETE", `sessions/${id}`));
  beginDraft = async (): Promise<string> => (await this.told<{ created: string }>("POST", "draft", {})).created;
  uploadToDraft = (id: string, role: DraftRole, file: File, onshare: (share: number) => void): Promise<Draft> =>
    this.upload(`draft/${id}/files/${role}?name=${encodeURIComponent(file.name)}`, file, onshare);
  removeFromDraft = (id: string, role: DraftRole): Promise<Draft> => this.told("DELETE", `draft/${id}/files/${role}`);
  mendDraft = (id: string, mending: MendingOfTerrain): Promise<Draft> => this.told("POST", `draft/${id}/mend`, mending);
  reliefOfDraft = async (id: string): Promise<Grid> => decodeGrid(await this.binary(`draft/${id}/relief`));
  /** Checks it, or makes it a scene. */
  makeOfDraft = (id: string, wanted: WantedScene): Promise<Checked> => this.told("POST", `draft/${id}/scene`, wanted);
  discardDraft = async (id: string): Promise<void> => void (await this.ask("DELETE", `draft/${id}`));
  removeScene = async (id: string): Promise<void> => void (await this.ask("DELETE", `scenes/${id}`));
  /** A scene with all its files, as an archive. */
  sceneBundle = (id: string): Promise<Blob> => this.blob(`scenes/${id}/bundle`);
  jobForm = (scene: string): Promise<JobForm> => this.json(`jobs/form/${scene}`);
  jobEstimate = (scene: string): Promise<JobEstimate> => this.json(`jobs/estimate/${scene}`);
  validationCases = async (): Promise<ValidationCase[]> => (await this.json<{ cases: ValidationCase[] }>("jobs/cases")).cases;
  addJob = async (wanted: WantedJob): Promise<void> => void (await this.ask("POST", "jobs", wanted));
  cancelJob = async (id: string): Promise<void> => void (await this.ask("POST", `jobs/${id}/cancel`));
  resumeJob = async (id: string): Promise<void> => void (await this.ask("POST", `jobs/${id}/resume`));
  removeJob = async (id: string): Promise<void> => void (await this.ask("DELETE", `jobs/${id}`));
  sessionFile = (): Promise<Blob> => this.blob("session/file");
  shared = (): Promise<Share> => this.json("share");
  share = (wanted: WantedShare): Promise<Share> => this.told("POST", "share", wanted);
  unshare = (): Promise<Share> => this.told("DELETE", "share");
  quit = async (): Promise<void> => void (await this.ask("POST", "quit"));
  control = async (what: "request" | "release" | "grant" | "decline"): Promise<void> =>
    void (await this.ask("POST", "control", { do: what }));
}
