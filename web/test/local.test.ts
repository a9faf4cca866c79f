// An engine behind two message ports, as in a worker.
import { MessageChannel } from "node:worker_threads";
import { afterEach, describe, expect, it } from "vitest";
import { Api, Refused } from "../src/protocol/api";
import { hostEngine, type Port } from "../src/protocol/engine_host";
import { Live } from "../src/protocol/live";
import { Local, type HostPort } from "../src/protocol/local";
import type { Engine } from "../src/engine/engine";
import type { Transport } from "../src/protocol/transport";

const ports: { close(): void }[] = [];
afterEach(() => ports.splice(0).forEach((port) => port.close()));

/** A worker that has `engine`. */
function worker(engine: Engine): HostPort {
  const { port1, port2 } = new MessageChannel();
  ports.push(port1, port2);
  hostEngine(port2 as unknown as Port, () => Promise.resolve(engine));
  return port1 as unknown as HostPort;
}
class Fake implements Engine {
  readonly said: string[] = [];
  ticks = 0;
  onSend: (client: number, message: string | ArrayBuffer) => void = () => undefined;
  open = (packed: Uint8Array): { hash: string } => {
    if (packed[0] !== 1) throw new Error("scene: is no packed scene");
    return { hash: "0f" };
  };
  join(name: string): number {
    this.onSend(7, JSON.stringify({ type: "hello", name }));
    return 7;
  }
  leave = (): void => undefined;
  message(client: number, text: string): void {
    this.said.push(`${client} ${text}`);
    this.onSend(client, JSON.stringify({ type: "done", done: "seen" }));
  }
  request(method: string, path: string, body: Uint8Array | string): { status: number; type: string; body: Uint8Array } {
    const answer = (status: number, content: object): { status: number; type: string; body: Uint8Array } =>
      ({ status, type: "application/json", body: new TextEncoder().encode(JSON.stringify(content)) });
    if (path === "/api/scenarios/A/actions") return answer(200, { done: `${method} ${String(body)}`, created: null });
    if (path === "/api/crash") throw new Error("the engine is out of memory: at most 2 GB");
    return answer(404, { error: "there is no such thing" });
  }
  tick(): number {
    ++this.ticks;
    return 0;
  }
}
const tape: Transport = {
  can: { change: false, server: false },
  ask: (_, path) => Promise.resolve(path === "orthophoto" ? new Response("picture") : new Response("{}", { status: 404 })),
  upload: () => Promise.reject(new Error()), connect: () => ({ send: () => undefined, close: () => undefined }),
};
const open = (engine: Engine, scene = [1], onfault: (sentence: string) => void = () => undefined): Promise<Local> =>
  Local.open(worker(engine), Uint8Array.from(scene), new ArrayBuffer(8), tape, onfault);
/** Resolves once `done` holds. */
async function until(done: () => boolean): Promise<void> {
  while (!done()) await new Promise((next) => setTimeout(next, 1));
}

describe("an engine in the page", () => {
  it("answers as a server does, changes included", async () => {
    const api = new Api(await open(new Fake()));
    expect(await api.act("A", { action: "run" } as never)).toEqual({ done: 'POST {"action":"run"}', created: null });
    await expect(api.series("A")).rejects.toThrow(new Refused(404, "there is no such thing"));
  });
  it("leaves to the recording what is of the whole session, and not what is of a run", async () => {
    const api = new Api(await open(new Fake()));
    expect(await (await api.orthophoto()).text()).toBe("picture");
    await expect(api.exported("A", "report.html")).rejects.toThrow(Refused);
  });
  it("is open before it says hello, and hears what the page says", async () => {
    const engine = new Fake();
    const heard: string[] = [];
    const live = new Live(await open(engine), "Ann", { frame: () => undefined, mayReturn: () => Promise.resolve(true),
      message: (message) => void heard.push(message.type), connection: (state) => void heard.push(state) });
    live.start();
    await until(() => heard.includes("hello"));
    live.mark(null);
    await until(() => heard.includes("done"));
    expect(heard).toEqual(["connecting", "open", "hello", "done"]);
    expect(engine.said).toEqual(['7 {"type":"mark","at":null}']);
  });
  it("goes on by itself", async () => {
    const engine = new Fake();
    await open(engine);
    await until(() => engine.ticks > 3);
  });
  it("that cannot open its scene says why", async () => {
    await expect(open(new Fake(), [2])).rejects.toThrow("scene: is no packed scene");
  });
  it("whose worker does not start says so", async () => {
    const dead: HostPort = { onmessage: null, onerror: null, postMessage: () => setTimeout(() => dead.onerror?.({} as ErrorEvent)) };
    await expect(Local.open(dead, new Uint8Array(1), new ArrayBuffer(1), tape, () => undefined)).rejects.toThrow("did not start the engine");
  });
  it("that fails ends in a sentence, which every later question gets too", async () => {
    const faults: string[] = [];
    const local = await open(new Fake(), [1], (sentence) => void faults.push(sentence));
    const sentence = "the engine is out of memory: at most 2 GB";
    for (const path of ["crash", "scene"]) expect(await (await local.ask("GET", path, undefined)).json()).toEqual({ error: sentence });
    expect(faults).toEqual([sentence]);
  });
});
