// The worker of a published twin with an engine. The engine's script stands before this one (src/publish/page.cpp).
import { makeEngine, type EngineFactory } from "./engine/engine";
import { hostEngine, type Port } from "./protocol/engine_host";

const { talusEngine } = globalThis as unknown as { talusEngine: EngineFactory };

hostEngine(self as unknown as Port, (wasm) => makeEngine(talusEngine, wasm));
