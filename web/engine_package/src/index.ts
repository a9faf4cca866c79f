// talus-engine: simulations of debris flows in a page or in Node.js, for twins of others.
import { loadEngine, makeEngine } from "../../src/engine/engine";
import { Refused } from "../../src/protocol/api";
import { Here, There, type Call, type Computer, type Port } from "./computer";
import { Twin } from "./twin";

export { loadEngine, makeEngine, Refused };
export { Run, Twin, type Change, type Particles } from "./twin";
export { earthMatrix, toEarth, type EarthMatrix } from "./earth";
export type { Engine, EngineAnswer, EngineFactory } from "../../src/engine/engine";
export type { Grid } from "../../src/protocol/grid";
export type * from "../../src/protocol/messages";

export interface OpenOptions {
  /** Where the engine computes: "worker", as it does wherever there are Workers, or "caller", in the thread of the caller. */
  thread?: "worker" | "caller";
  /** talus_engine.wasm, where it is not beside this module. It is not changed. */
  wasm?: ArrayBuffer;
}

async function ownEngine(): Promise<ArrayBuffer> {
  const address = new URL("./talus_engine.wasm", import.meta.url);
  if (address.protocol === "file:" && "process" in globalThis) {
    const files = "node:fs/promises";  // a name that bundlers do not look for
    const { readFile } = (await import(/* @vite-ignore */ /* webpackIgnore: true */ files)) as { readFile(from: URL): Promise<Uint8Array<ArrayBuffer>> };
    return new Uint8Array(await readFile(address)).buffer;
  }
  const response = await fetch(address);
  if (!response.ok) throw new Error(`${address.href}: ${response.status}; the engine's WebAssembly must lie there, or be given as wasm`);
  return response.arrayBuffer();
}

function inWorker(): Computer {
  const worker = new Worker(new URL("./worker.js", import.meta.url), { type: "module" });
  const computer = new There(worker as unknown as Port<Call>, () => worker.terminate());
  worker.onerror = (event) => computer.fail(`The engine's worker did not start: ${event.message || "its script could not be loaded"}.`);
  return computer;
}

/**
 * Opens a packed scene: `scene.bin` of `talus publish --folder`.
 *
 * @param packed its bytes; they stay as they are
 * @throws Error with one sentence: no packed scene, of another version of talus, damaged, or larger than a page has memory for
 */
export async function openTwin(packed: Uint8Array, options: OpenOptions = {}): Promise<Twin> {
  const wasm = options.wasm ?? await ownEngine();
  const there = (options.thread ?? (typeof Worker === "undefined" ? "caller" : "worker")) === "worker";
  const computer = there ? inWorker() : new Here(async (bytes) => makeEngine((await import("./talus_engine.js")).default, bytes));
  try {
    return await Twin.open(computer, packed, wasm);
  } catch (error) {
    computer.close();
    throw error;
  }
}
