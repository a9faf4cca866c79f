// Where the engine computes: in the caller's thread, or in a worker. Both answer the same.
import type { Engine, EngineAnswer } from "../../src/engine/engine";
import { Refused } from "../../src/protocol/api";
import type { Done, State } from "../../src/protocol/messages";

export interface Computer {
  /** The hash of the state at time 0. */
  open(scene: Uint8Array, wasm: ArrayBuffer): Promise<string>;
  ask(method: string, path: string, body: string): Promise<EngineAnswer>;
  /** Takes steps until so much time has passed in a scenario, or its run is over. What is asked meanwhile is answered between two steps. */
  advance(scenario: string, duration_s: number): Promise<State>;
  close(): void;
}

/** Of computing without a look at what else is asked. */
const budget_ms = 20;
/** Between two looks at the state. */
const mostSteps = 8;
const longest_s = 1e7;
const text = new TextDecoder();

/** Lets what waits go first. No timer: browsers make those that follow each other wait. */
const others = (): Promise<void> => new Promise((resolve) => {
  const { port1, port2 } = new MessageChannel();
  port1.onmessage = () => {
    port1.close();
    resolve();
  };
  port2.postMessage(null);
});

/** Computes in this thread. `load`: of the built engine. */
export class Here implements Computer {
  private engine: Engine | null = null;
  private fault = "The twin is not open.";

  constructor(private readonly load: (wasm: ArrayBuffer) => Promise<Engine>) {}

  async open(scene: Uint8Array, wasm: ArrayBuffer): Promise<string> {
    const engine = await this.load(wasm);
    const { hash } = engine.open(scene);
    this.engine = engine;
    return hash;
  }

  async ask(method: string, path: string, body: string): Promise<EngineAnswer> {
    return this.request(method, path, body);
  }

  async advance(scenario: string, duration_s: number): Promise<State> {
    if (!(duration_s >= 0 && duration_s <= longest_s)) throw new Refused(400, `duration_s = ${duration_s}; it is a number from 0 to ${longest_s}`);
    const run = `/api/scenarios/${scenario}`;
    const step = JSON.stringify({ action: "step", scenarios: [scenario] });
    const state = (): State => this.told<State>("GET", `${run}/state`);
    let now = state();
    const until = now.time_s + duration_s;
    let length_s = Infinity;
    let looked = performance.now();
    while (now.status === "paused" && now.time_s < until) {
      const from_s = now.time_s;
      // A state costs a good part of a step, so there is not one for each. Half of what is left: the steps may become longer.
      const wanted = Math.min(mostSteps, Math.max(1, Math.floor((until - from_s) / (2 * length_s))));
      let taken = 0;
      try {
        do this.told<Done>("POST", `${run}/actions`, step);
        while (++taken < wanted && performance.now() - looked < budget_ms);
      } catch (error) {
        // A run that is over refuses to step.
        now = state();
        if (now.status === "paused") throw error;
        break;
      }
      now = state();
      length_s = (now.time_s - from_s) / taken;
      if (performance.now() - looked < budget_ms) continue;
      await others();
      looked = performance.now();
    }
    return now;
  }

  close(): void {
    this.engine = null;
    this.fault = "The twin was closed.";
  }

  /** One that has failed is in an unknown state: it is not asked again. */
  private request(method: string, path: string, body: string): EngineAnswer {
    if (this.engine === null) throw new Refused(500, this.fault);
    try {
      return this.engine.request(method, path, body);
    } catch (error) {
      this.engine = null;
      this.fault = error instanceof Error && error.message !== "" ? error.message : "The engine has failed.";
      throw new Refused(500, this.fault);
    }
  }
  private told<T>(method: string, path: string, body = ""): T {
    const answer = this.request(method, path, body);
    const content = JSON.parse(text.decode(answer.body)) as T & { error?: string };
    if (answer.status >= 400) throw new Refused(answer.status, content.error ?? `${path}: ${answer.status}`);
    return content;
  }
}

/** To a worker: a call of a Computer. */
export type Call =
  | { id: number; call: "open"; given: Parameters<Computer["open"]> }
  | { id: number; call: "ask"; given: Parameters<Computer["ask"]> }
  | { id: number; call: "advance"; given: Parameters<Computer["advance"]> };
/** From it: what the call gives, or the sentence of a Refused. */
export type Answer = { id: number; value: unknown } | { id: number; sentence: string; status: number };

/** What a Worker and a MessagePort have in common. */
export interface Port<Sent> {
  postMessage(message: Sent, transfer: Transferable[]): void;
  onmessage: ((event: MessageEvent) => void) | null;
}

/** The worker's side: answers calls that come over `port`. */
export function answerCalls(port: Port<Answer>, computer: Computer): void {
  const answer = async ({ id, call, given }: Call): Promise<void> => {
    try {
      const value = call === "open" ? await computer.open(...given) : call === "ask" ? await computer.ask(...given) : await computer.advance(...given);
      // An answer lies in a buffer of its own, which goes over without a copy.
      port.postMessage({ id, value }, typeof value === "object" && "body" in value ? [value.body.buffer as ArrayBuffer] : []);
    } catch (error) {
      port.postMessage({ id, sentence: error instanceof Error ? error.message : String(error), status: error instanceof Refused ? error.status : 500 }, []);
    }
  };
  port.onmessage = (event: MessageEvent) => void answer(event.data as Call);
}

/** Computes behind a port. */
export class There implements Computer {
  private readonly waiting = new Map<number, { resolve(value: unknown): void; reject(why: Error): void }>();
  private ids = 0;
  private fault: string | null = null;

  /** `end`: ends what is behind the port. */
  constructor(private readonly port: Port<Call>, private readonly end: () => void) {
    port.onmessage = (event: MessageEvent) => {
      const answer = event.data as Answer;
      const asked = this.waiting.get(answer.id);
      this.waiting.delete(answer.id);
      if ("sentence" in answer) asked?.reject(new Refused(answer.status, answer.sentence));
      else asked?.resolve(answer.value);
    };
  }

  open = (...given: Parameters<Computer["open"]>): Promise<string> => this.call<string>({ id: ++this.ids, call: "open", given });
  ask = (...given: Parameters<Computer["ask"]>): Promise<EngineAnswer> => this.call<EngineAnswer>({ id: ++this.ids, call: "ask", given });
  advance = (...given: Parameters<Computer["advance"]>): Promise<State> => this.call<State>({ id: ++this.ids, call: "advance", given });
  close(): void {
    this.end();
    this.fail("The twin was closed.");
  }
  /** Nothing will answer any more. */
  fail(sentence: string): void {
    this.fault = sentence;
    for (const { reject } of this.waiting.values()) reject(new Refused(500, sentence));
    this.waiting.clear();
  }

  private call<T>(call: Call): Promise<T> {
    if (this.fault !== null) return Promise.reject(new Refused(500, this.fault));
    return new Promise<T>((resolve, reject) => {
      this.waiting.set(call.id, { resolve: resolve as (value: unknown) => void, reject });
      this.port.postMessage(call, []);
    });
  }
}
