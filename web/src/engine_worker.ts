// The worker of a published twin with an engine.
import { hostEngine, type Port } from "./protocol/engine_host";
import type { Engine } from "./protocol/transport";

// A page that is built before the engine has none; it is then never asked for.
const built = import.meta.glob<{ loadEngine(wasm: ArrayBuffer): Promise<Engine> }>("./engine/engine.ts", { eager: true });

hostEngine(self as unknown as Port, (wasm) => {
  const [engine] = Object.values(built);
  return engine ? engine.loadEngine(wasm) : Promise.reject(new Error("This page was built without the engine."));
});
