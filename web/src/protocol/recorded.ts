// The transport of a recording: the tape answers as the session did, to one reader who changes nothing.
import { decodeFrame, type Frame } from "./frame";
import { between } from "./between";
import type { ProbeSeries, SceneInfo } from "./messages";
import type { Tape } from "./tape";
import type { Possible, Transport, Wire, WireEvents } from "./transport";

/** Two each of two scenarios, and some beyond. */
const mostDecoded = 6;
const refused = (status: number, sentence: string): Response =>
  new Response(JSON.stringify({ error: sentence }), { status, headers: { "Content-Type": "application/json" } });
const json = (content: unknown): Response => new Response(JSON.stringify(content), { headers: { "Content-Type": "application/json" } });
/** A copy in a buffer of its own: it may be handed on. */
const bufferOf = (bytes: Uint8Array): ArrayBuffer => bytes.slice().buffer as ArrayBuffer;

export class Recorded implements Transport {
  readonly can: Possible = { change: false, server: false };

  /** Those on both sides of the time shown last, by address and time: playing goes from one to the next. */
  private readonly decoded = new Map<string, Promise<Frame | null>>();

  constructor(private readonly tape: Tape) {}

  /** Frames are farther apart than the pictures of the page: between two of them it draws the straight way. */
  async frame(scenario: string, time_s: number): Promise<Frame | null> {
    const address = `scenarios/${scenario}/frame`;
    const times = this.tape.around(address, time_s);
    if (times === null) return null;
    const [from, to] = await Promise.all(times.map((time) => this.decode(address, time)));
    if (!from || !to) return null;
    return between(from, to, time_s);
  }
  private decode(address: string, time_s: number): Promise<Frame | null> {
    const key = `${address} ${time_s}`;
    const known = this.decoded.get(key) ?? this.tape.find(address, time_s).then((found) => (found ? decodeFrame(bufferOf(found.body)) : null));
    this.decoded.delete(key);
    this.decoded.set(key, known);
    for (const oldest of this.decoded.keys()) {
      if (this.decoded.size <= mostDecoded) break;
      this.decoded.delete(oldest);
    }
    return known;
  }

  async ask(method: string, path: string): Promise<Response> {
    if (method !== "GET") return refused(409, "This is a recording: it can be watched, not changed.");
    const asked = new URL(path, "http://tape/");
    const address = decodeURIComponent(asked.pathname.slice(1));
    if (address.endsWith("/probe")) return json(await this.probe(address.replace(/probe$/, "frame"), Number(asked.searchParams.get("x_m")), Number(asked.searchParams.get("y_m"))));
    const time = asked.searchParams.get("time_s");
    const found = await this.tape.find(address, time === null ? null : Number(time));
    return found ? new Response(bufferOf(found.body), { headers: { "Content-Type": found.type } }) : refused(404, "The recording does not hold this.");
  }
  upload(): Promise<Response> {
    return Promise.resolve(refused(409, "This is a recording: it can be watched, not changed."));
  }
  connect(_name: string, _secret: string | null, events: WireEvents): Wire {
    let open = true;
    queueMicrotask(() => {
      events.opened();
      for (const message of this.tape.messages) events.message(JSON.stringify(message));
    });
    return {
      send: (text) => {
        const message = JSON.parse(text) as { type: string; scenarios?: string[] };
        // What is live in a recording is its end.
        if (message.type === "view") for (const name of message.scenarios ?? []) void this.tape.find(`scenarios/${name}/frame`, null).then((found) => {
          if (open && found) events.message(bufferOf(found.body));
        });
      },
      close: () => {
        if (open) events.closed();
        open = false;
      },
    };
  }

  /** What passed at a point: from the frames, as the session reads it. They do not hold the density of a mixture, so there is no pressure, nor that of the pores. */
  private async probe(address: string, x: number, y: number): Promise<ProbeSeries> {
    const scene = JSON.parse(new TextDecoder().decode((await this.tape.find("scene", null))?.body ?? new Uint8Array())) as SceneInfo;
    const column = Math.floor((x - scene.map.x_min_m) / scene.map.cell_m);
    const row = Math.floor((y - scene.map.y_min_m) / scene.map.cell_m);
    const series: ProbeSeries = { time_s: [], depth_m: [], speed_mps: [], pressure_kPa: [], pore_pressure_ratio: [] };
    for (const time of this.tape.times(address)) {
      const found = await this.tape.find(address, time);
      if (!found) continue;
      const here = debrisAt(await decodeFrame(bufferOf(found.body)), column, row);
      series.time_s.push(time);
      series.depth_m.push(here.depth_m);
      series.speed_mps.push(here.speed_mps);
      series.pressure_kPa.push(null);
      series.pore_pressure_ratio.push(null);
    }
    return series;
  }
}

export function debrisAt(frame: Frame, column: number, row: number): { depth_m: number; speed_mps: number } {
  const { window: w } = frame;
  const [i, j] = [column - w.column, row - w.row];
  if (i < 0 || j < 0 || i >= w.columns || j >= w.rows) return { depth_m: 0, speed_mps: 0 };
  const at = j * w.columns + i;
  return { depth_m: (frame.depth[at] ?? 0) * frame.depthUnit_m, speed_mps: (frame.mapSpeed[at] ?? 0) * frame.mapSpeedUnit_mps };
}
