// The worker in which a twin computes.
import { makeEngine } from "../../src/engine/engine";
import { answerCalls, Here, type Answer, type Port } from "./computer";
import factory from "./talus_engine.js";

answerCalls(self as unknown as Port<Answer>, new Here((wasm) => makeEngine(factory, wasm)));
