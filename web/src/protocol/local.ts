// The transport to an engine in the page's own worker: the same messages, without a network.
import type { FromHost, ToHost } from "./engine_host";
import type { Possible, Transport, Wire, WireEvents } from "./transport";

/** What a Worker and a MessagePort have in common. */
export interface HostPort {
  postMessage(message: ToHost, transfer: Transferable[]): void;
  onmessage: ((event: MessageEvent) => void) | null;
  /** Of a worker whose script did not run. */
  onerror?: ((event: ErrorEvent) => void) | null;
}
interface Asked { resolve(response: Response): void; reject(why: Error): void }

export class Local implements Transport {
  readonly can: Possible = { change: true, server: false };
  private readonly asked = new Map<number, Asked>();
  private asks = 0;
  private events: WireEvents | null = null;
  private fault: string | null = null;

  private constructor(private readonly port: HostPort, private readonly beside: Transport, private readonly onfault: (sentence: string) => void) {}

  /** `beside`: what answers where the engine has nothing, such as pictures of the recording. `onfault`: told why the engine has ended. */
  static open(port: HostPort, scene: Uint8Array, wasm: ArrayBuffer, beside: Transport, onfault: (sentence: string) => void): Promise<Local> {
    return new Promise((resolve, reject) => {
      const local = new Local(port, beside, onfault);
      port.onmessage = (event: MessageEvent) => {
        const message = event.data as FromHost;
        if (message.kind === "opened") {
          port.onmessage = (next: MessageEvent) => local.hear(next.data as FromHost);
          resolve(local);
        } else if (message.kind === "fault") reject(new Error(message.sentence));
      };
      port.onerror = () => reject(new Error("This browser did not start the engine; a newer one may, and the recording needs none."));
      port.postMessage({ kind: "open", scene, wasm }, [scene.buffer, wasm]);
    });
  }

  async ask(method: string, path: string, body: object | undefined): Promise<Response> {
    const response = await this.askEngine(method, path, body === undefined ? "" : JSON.stringify(body));
    return method === "GET" && response.status === 404 ? await this.orBeside(response, path) : response;
  }
  upload(): Promise<Response> {
    return Promise.resolve(new Response(JSON.stringify({ error: "A published twin takes no files." }), { status: 409 }));
  }
  connect(name: string, _secret: string | null, events: WireEvents): Wire {
    this.events = events;
    this.port.postMessage({ kind: "join", name }, []);
    return { send: (text) => this.port.postMessage({ kind: "say", text }, []), close: () => undefined };
  }

  private askEngine(method: string, path: string, body: string): Promise<Response> {
    if (this.fault !== null) return Promise.resolve(new Response(JSON.stringify({ error: this.fault }), { status: 500 }));
    const id = ++this.asks;
    return new Promise((resolve, reject) => {
      this.asked.set(id, { resolve, reject });
      this.port.postMessage({ kind: "ask", id, method, path: `/api/${path}`, body }, []);
    });
  }
  /** What the recording holds of the session as a whole; of its runs it knows another one. */
  private async orBeside(refused: Response, path: string): Promise<Response> {
    if (path.startsWith("scenarios/")) return refused;
    const other = await this.beside.ask("GET", path, undefined, null);
    return other.ok ? other : refused;
  }
  private hear(message: FromHost): void {
    switch (message.kind) {
      case "answer": {
        const asked = this.asked.get(message.id);
        this.asked.delete(message.id);
        asked?.resolve(new Response(message.body, { status: message.status, headers: { "Content-Type": message.type } }));
        break;
      }
      case "joined":
        this.events?.opened();
        break;
      case "sent":
        this.events?.message(message.data);
        break;
      case "fault":
        this.fault = message.sentence;
        for (const { resolve } of this.asked.values()) resolve(new Response(JSON.stringify({ error: message.sentence }), { status: 500 }));
        this.asked.clear();
        this.onfault(message.sentence);
        break;
      case "opened":
        break;
    }
  }
}
