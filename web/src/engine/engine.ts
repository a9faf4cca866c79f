/** The program's engine in this page: a session without a server (docs/web-engine.md). */

/** An answer of the session, as HTTP would have it. */
export interface EngineAnswer {
  status: number;
  type: string;
  body: Uint8Array;
}

export interface Engine {
  /** Opens a packed scene, in place of the one before. The hash is that of the state at time 0. Throws a sentence. */
  open(packed: Uint8Array): { hash: string };
  /** A person, as a connection is to the server. */
  join(name: string): number;
  leave(client: number): void;
  /** What a page sends on its connection. Throws where it violates the protocol. */
  message(client: number, text: string): void;
  /** `client`: who asks; without it the first person who is here. */
  request(method: string, path: string, body: Uint8Array | string, client?: number): EngineAnswer;
  /** Computes and sends what is due, for about so long. Returns the milliseconds until there is more to do; -1: not
   * before another call. Throws a sentence if the engine fails: it is of no use afterwards. */
  tick(budgetMs: number): number;
  /** What the server would send on the connection: a text, or a frame that may be transferred. */
  onSend: (client: number, message: string | ArrayBuffer) => void;
}

/** The functions of apps/web_engine/engine.cpp. */
interface Module {
  HEAPU8: Uint8Array;
  _malloc(size: number): number;
  _free(at: number): void;
  _talus_open(at: number, size: number): number;
  _talus_join(at: number, size: number): number;
  _talus_leave(client: number): void;
  _talus_message(client: number, at: number, size: number): number;
  _talus_request(client: number, method: number, methodSize: number, target: number, targetSize: number, body: number, bodySize: number): number;
  _talus_tick(budgetMs: number): number;
  _talus_next_message(): number;
  _talus_result(): number;
  _talus_result_size(): number;
  _talus_result_type(): number;
}

/** What emscripten makes of apps/web_engine: a function that makes a module. */
export type EngineFactory = (options: { wasmBinary?: ArrayBuffer }) => Promise<Module>;

const failed = -2;

class LoadedEngine implements Engine {
  onSend: Engine["onSend"] = () => undefined;
  private readonly encoder = new TextEncoder();
  private readonly decoder = new TextDecoder();
  private readonly clients: number[] = [];

  constructor(private readonly module: Module) {}

  open(packed: Uint8Array): { hash: string } {
    this.clients.length = 0;
    const opened = this.withBytes(packed, (at) => this.module._talus_open(at, packed.length));
    const result = this.resultText();
    if (opened === 0) throw new Error(result);
    return { hash: result };
  }

  join(name: string): number {
    const bytes = this.encoder.encode(name);
    const client = this.withBytes(bytes, (at) => this.module._talus_join(at, bytes.length));
    if (client === 0) throw new Error("no scene is open");
    this.clients.push(client);
    this.send();
    return client;
  }

  leave(client: number): void {
    const index = this.clients.indexOf(client);
    if (index >= 0) this.clients.splice(index, 1);
    this.module._talus_leave(client);
    this.send();
  }

  message(client: number, text: string): void {
    const bytes = this.encoder.encode(text);
    const welcome = this.withBytes(bytes, (at) => this.module._talus_message(client, at, bytes.length));
    if (welcome === 0) throw new Error("the message is none of the protocol");
    this.send();
  }

  request(method: string, path: string, body: Uint8Array | string, client?: number): EngineAnswer {
    const [how, where, what] = [this.encoder.encode(method), this.encoder.encode(path), typeof body === "string" ? this.encoder.encode(body) : body];
    const from = client ?? this.clients[0] ?? 0;
    const status = this.withBytes(how, (m) => this.withBytes(where, (p) => this.withBytes(what, (b) =>
      this.module._talus_request(from, m, how.length, p, where.length, b, what.length))));
    if (status === 0) throw new Error(this.resultText() || "no scene is open");
    const answer = { status, type: this.resultType(), body: this.resultBytes() };
    this.send();
    return answer;
  }

  tick(budgetMs: number): number {
    const wait = this.module._talus_tick(budgetMs);
    if (wait === failed) throw new Error(this.resultText());
    this.send();
    return wait;
  }

  private send(): void {
    for (let client = this.module._talus_next_message(); client !== 0; client = this.module._talus_next_message()) {
      this.onSend(Math.abs(client), client < 0 ? this.resultBytes().buffer : this.resultText());
    }
  }

  /** The engine's memory may move while it works: its views are taken anew. */
  private withBytes<T>(bytes: Uint8Array, use: (at: number) => T): T {
    const at = this.module._malloc(Math.max(1, bytes.length));
    if (at === 0) throw new Error("the page has no memory left");
    this.module.HEAPU8.set(bytes, at);
    try {
      return use(at);
    } finally {
      this.module._free(at);
    }
  }

  private resultBytes(): Uint8Array<ArrayBuffer> {
    const at = this.module._talus_result();
    return new Uint8Array(this.module.HEAPU8.subarray(at, at + this.module._talus_result_size()));
  }

  private resultText(): string {
    return this.decoder.decode(this.resultBytes());
  }

  private resultType(): string {
    const at = this.module._talus_result_type();
    return this.decoder.decode(this.module.HEAPU8.slice(at, this.module.HEAPU8.indexOf(0, at)));
  }
}

/** `factory`: the default export of talus_engine.js; `wasm`: talus_engine.wasm, otherwise loaded from beside that. */
export async function makeEngine(factory: EngineFactory, wasm?: ArrayBuffer): Promise<Engine> {
  return new LoadedEngine(await factory(wasm ? { wasmBinary: wasm } : {}));
}

/** `from`: where talus_engine.js is, relative to the page. */
export async function loadEngine(wasm?: ArrayBuffer, from = "./talus_engine.js"): Promise<Engine> {
  const { default: factory } = (await import(/* @vite-ignore */ from)) as { default: EngineFactory };
  return makeEngine(factory, wasm);
}
