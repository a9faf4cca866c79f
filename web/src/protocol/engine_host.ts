// The worker's side of an engine in the page: opens it, answers, and lets the session go on between the page's messages.
import type { Engine } from "../engine/engine";

/** To the worker. */
export type ToHost =
  | { kind: "open"; scene: Uint8Array; wasm: ArrayBuffer }
  | { kind: "ask"; id: number; method: string; path: string; body: string }
  | { kind: "join"; name: string }
  | { kind: "say"; text: string };
/** From it. `sentence`: why it cannot go on. */
export type FromHost =
  | { kind: "opened"; hash: string }
  | { kind: "answer"; id: number; status: number; type: string; body: ArrayBuffer }
  | { kind: "joined" }
  | { kind: "sent"; data: string | ArrayBuffer }
  | { kind: "fault"; sentence: string };

/** What a worker and a MessagePort have in common. */
export interface Port {
  postMessage(message: FromHost, transfer: Transferable[]): void;
  onmessage: ((event: MessageEvent) => void) | null;
}

/** Of computing without looking at the page's messages: a click must not wait longer for its answer. */
const budget_ms = 20;
/** Between two looks at what is due, at most: a message may have made something due. */
const pause_ms = 15;

const sentenceOf = (error: unknown): string => (error instanceof Error && error.message !== "" ? error.message : "The engine of this page has failed; reload the page.");

/** Serves one page at `port`. `load`: of the built engine. */
export function hostEngine(port: Port, load: (wasm: ArrayBuffer) => Promise<Engine>): void {
  let engine: Engine | null = null;
  let client: number | null = null;
  const tell = (message: FromHost, transfer: Transferable[] = []): void => port.postMessage(message, transfer);
  /** One that has failed is in an unknown state: it is not asked again. */
  const guarded = (work: () => void): void => {
    try {
      work();
    } catch (error) {
      engine = null;
      tell({ kind: "fault", sentence: sentenceOf(error) });
    }
  };
  const goOn = (): void => guarded(() => {
    if (engine === null) return;
    const wait_ms = engine.tick(budget_ms);
    setTimeout(goOn, wait_ms < 0 ? pause_ms : Math.min(wait_ms, pause_ms));
  });

  const open = async (scene: Uint8Array, wasm: ArrayBuffer): Promise<void> => {
    try {
      const loaded = await load(wasm);
      // A frame lies in a buffer of its own, which goes over without a copy.
      loaded.onSend = (_, data) => tell({ kind: "sent", data }, typeof data === "string" ? [] : [data]);
      const { hash } = loaded.open(scene);
      engine = loaded;
      tell({ kind: "opened", hash });
      goOn();
    } catch (error) {
      tell({ kind: "fault", sentence: sentenceOf(error) });
    }
  };
  port.onmessage = (event: MessageEvent): void => {
    const message = event.data as ToHost;
    if (message.kind === "open") return void open(message.scene, message.wasm);
    guarded(() => {
      if (engine === null) return;
      if (message.kind === "ask") {
        const { status, type, body } = engine.request(message.method, message.path, message.body);
        const own = body.slice().buffer as ArrayBuffer;  // its memory is the engine's, which grows
        tell({ kind: "answer", id: message.id, status, type, body: own }, [own]);
      } else if (message.kind === "join") {
        tell({ kind: "joined" });
        client = engine.join(message.name);
      } else if (client !== null) engine.message(client, message.text);
    });
  };
}
