// talus_engine.js, which apps/web_engine/build.sh makes; the package has it beside this module.
import type { EngineFactory } from "../../src/engine/engine";

declare const factory: EngineFactory;
export default factory;
