// A twin: a packed scene with its runs, which an engine in the page computes.
import { Api, Refused } from "../../src/protocol/api";
import { absent, type Frame } from "../../src/protocol/frame";
import type { Grid } from "../../src/protocol/grid";
import type { Action, Done, Figure, GaugeReadings, Impacts, LayerName, ProbeSeries, Recording, SceneInfo, ScenarioName, Series, Setup, State } from "../../src/protocol/messages";
import type { Transport } from "../../src/protocol/transport";
import type { Computer } from "./computer";

/** A change of a run: its values, structures, ground and releases, `restart`, `undo`, `redo`. Time goes on with {@link Run.step} and {@link Run.advance}. */
export type Change = Exclude<Action, { action: "run" | "pause" | "step" } | { action: "set_speed" } | { action: "cancel" }>;

/** The debris of a run at one time. Those that have left the terrain are not among them. */
export interface Particles {
  /** Simulated, s. */
  time_s: number;
  /** Steps taken until then. */
  step: number;
  count: number;
  /** x (east), y (north), z (up) from `scene.origin`, m; three numbers per particle, to a 65,534th of the debris's extent. */
  positions: Float32Array;
  /** m/s, one per particle, to a 255th of the largest. */
  speeds: Float32Array;
  /** Which particle: the same number is the same debris at all times of a run. One per particle, ascending. */
  ids: Uint32Array;
}

function particlesOf(frame: Frame): Particles {
  const { particles: packed, origin, scale } = frame;
  const positions = new Float32Array(3 * frame.count);
  const speeds = new Float32Array(frame.count);
  const ids = new Uint32Array(frame.count);
  let count = 0;
  for (let i = 0; i < frame.count; ++i) {
    if (packed[4 * i] === absent && packed[4 * i + 1] === absent && packed[4 * i + 2] === absent) continue;
    for (let k = 0; k < 3; ++k) positions[3 * count + k] = origin[k]! + scale[k]! * packed[4 * i + k]!;
    speeds[count] = frame.speedUnit_mps * packed[4 * i + 3]!;
    ids[count++] = i * frame.stride;
  }
  return { time_s: frame.time_s, step: frame.step, count, positions: positions.subarray(0, 3 * count), speeds: speeds.subarray(0, count), ids: ids.subarray(0, count) };
}

/** The requests of the protocol, answered by a computer in place of a server. */
const transportTo = (computer: Computer): Transport => ({
  can: { change: true, server: false },
  ask: async (method, path, body) => {
    const { status, type, body: content } = await computer.ask(method, `/api/${path}`, body === undefined ? "" : JSON.stringify(body));
    return new Response(content as BodyInit, { status, headers: { "Content-Type": type } });
  },
  upload: () => Promise.reject(new Refused(409, "A twin in a page takes no files.")),
  connect: () => ({ send: () => undefined, close: () => undefined }),
});

/** Of a run that only {@link Run.step} and {@link Run.advance} move. */
const elsewhere = new Set(["run", "pause", "step", "set_speed", "cancel"]);

/**
 * One run of the scene. `time_s`, where a method takes it: as of the recorded moment at or before it; without it, now.
 * Every method rejects with a {@link Refused}: its message is one sentence that names what is wrong, and the range that is allowed.
 */
export class Run {
  /** @internal Use Twin.run and copy(). `name`: A to F. */
  constructor(private readonly api: Api, private readonly computer: Computer, readonly name: ScenarioName) {}

  /** Makes a change, which holds from the next step on; as actions of docs/protocol.md. `created` of the answer: the id of what is new. */
  async act(change: Change): Promise<Done> {
    if (elsewhere.has(change.action)) throw new Refused(400, `action = "${change.action}": step() and advance() move a run`);
    return this.api.act(this.name, change);
  }
  /** Takes so many steps of the solver, fewer where the run is over before. */
  async step(count = 1): Promise<State> {
    if (!Number.isInteger(count) || count < 1) throw new Refused(400, `count = ${count}; it is a whole number from 1`);
    for (let k = 0; k < count; ++k) {
      try {
        await this.api.act(this.name, { action: "step", scenarios: [this.name] });
      } catch (error) {
        const state = await this.state();
        if (state.status === "paused") throw error;
        return state;
      }
    }
    return this.state();
  }
  /**
   * Computes until `duration_s` of simulated time has passed (by less than a step more), or the run is over: see `status` of the answer,
   * which is "paused" as long as it can go on. As fast as it goes; other calls are answered between two steps.
   */
  advance(duration_s: number): Promise<State> {
    return this.computer.advance(this.name, duration_s);
  }
  /** Status, time, volumes, front, speeds, and the hash of time and particles. */
  state(): Promise<State> {
    return this.api.state(this.name);
  }
  /** Values, releases, barriers, buildings, zones as they are now, with the ids that changes name. */
  setup(): Promise<Setup> {
    return this.api.setup(this.name);
  }
  async particles(time_s: number | null = null): Promise<Particles> {
    return particlesOf(await this.api.frame(this.name, time_s));
  }
  /** A map: `values` by rows from the south, NaN where there is none; depths m, speeds m/s, pressures Pa, times s. Cells of `cell` m from the edges `west` and `south`, in the terrain's reference system. */
  map(name: LayerName, time_s: number | null = null): Promise<Grid> {
    return this.api.layer(this.name, name, time_s);
  }
  /** Per building and barrier: forces kN, pressures kPa, depths m; what barriers retain, m3. */
  impacts(time_s: number | null = null): Promise<Impacts> {
    return this.api.impacts(this.name, time_s);
  }
  gauges(time_s: number | null = null): Promise<GaugeReadings> {
    return this.api.gauges(this.name, time_s);
  }
  /** Time series, and the front over the chainage of the flow path. */
  series(): Promise<Series> {
    return this.api.series(this.name);
  }
  /** Key figures, as on a report. */
  figures(): Promise<Figure[]> {
    return this.api.figures(this.name);
  }
  /** Depth, speed and pressure at a place (m, in the terrain's reference system) over the run so far. */
  probe(east_m: number, north_m: number): Promise<ProbeSeries> {
    return this.api.probe(this.name, east_m, north_m);
  }
  /** Which moments are recorded. */
  recording(): Promise<Recording> {
    return this.api.recording(this.name);
  }
  /** Every change with its step, as JSON: `talus replay` repeats the run from it. */
  async journal(): Promise<string> {
    return (await this.api.journal(this.name)).text();
  }
  /** Another run of the same setup from time 0, with a change made first; there are six at most. */
  async copy(change: Change | null = null): Promise<Run> {
    return new Run(this.api, this.computer, (await this.api.addScenario(this.name, change)).created);
  }
  /** Ends this run; A stays. */
  end(): Promise<void> {
    return this.api.endScenario(this.name);
  }
}

export class Twin {
  /** The first run, A: the scene as it was packed, at time 0. {@link Run.copy} makes others. */
  readonly run: Run;

  private constructor(
    private readonly api: Api, private readonly computer: Computer,
    /** What does not change: title, extent, origin of local positions, flow path, parameters with their ranges. */
    readonly scene: SceneInfo,
    /** Of the state at time 0. */
    readonly hash: string,
  ) {
    this.run = new Run(api, computer, "A");
  }
  /** @internal Use openTwin. */
  static async open(computer: Computer, packed: Uint8Array, wasm: ArrayBuffer): Promise<Twin> {
    const hash = await computer.open(packed, wasm);
    const api = new Api(transportTo(computer));
    return new Twin(api, computer, await api.scene(), hash);
  }

  /** Elevations, m; with every so many columns and rows, so that at most `maxCells` (100 to 16 million) remain. */
  terrain(maxCells = 1_000_000): Promise<Grid> {
    return this.api.terrain(maxCells);
  }
  /** A picture of the ground from above, over `scene.extent_m`; null: the scene has none. */
  async orthophoto(): Promise<Blob | null> {
    return this.scene.orthophoto ? this.api.orthophoto() : null;
  }
  /** Ends the worker and frees its memory; what is asked afterwards is refused. */
  close(): void {
    this.computer.close();
  }
}
