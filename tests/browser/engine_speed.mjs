// How fast the engine of published twins computes in Chromium: simulated seconds per second in a worker, without a picture beside it.
// Usage: node engine_speed.mjs ENGINE_FOLDER SCENE.bin [RUNS] [depth_averaged]; SCENE.bin is of talus publish --folder. Prints the runs
// and their median. No test of the suite: what it says depends on the machine.
import { spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync } from "node:fs";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";

const [, , engine, scene, runs = "5", model = "particles"] = process.argv;
const web = fileURLToPath(new URL("../../web/", import.meta.url));
const wrapper = join(mkdtempSync(join(tmpdir(), "talus-engine-")), "engine.mjs");
const bundled = spawnSync(join(web, "node_modules/.bin/esbuild"), [join(web, "src/engine/engine.ts"), "--format=esm", "--log-level=warning", `--outfile=${wrapper}`], { encoding: "utf8" });
if (bundled.status !== 0) throw new Error(bundled.stderr);

const worker = `
import { makeEngine } from "/engine.mjs";
import factory from "/talus_engine.js";
onmessage = async ({ data: model }) => {
  const bytes = async (path) => await (await fetch(path)).arrayBuffer();
  const engine = await makeEngine(factory, await bytes("/talus_engine.wasm"));
  engine.onSend = () => undefined;
  engine.open(new Uint8Array(await bytes("/scene.bin")));
  const person = engine.join("Ada");
  const ask = (method, path, body) => JSON.parse(new TextDecoder().decode(engine.request(method, "/api/" + path, body ? JSON.stringify(body) : "", person).body));
  const particles = model === "particles";
  if (particles) for (const action of [{ action: "set_speed", factor: null }, { action: "run" }]) ask("POST", "scenarios/A/actions", action);
  else ask("POST", "depth_averaged", { on: true });
  const begun = performance.now();
  for (;;) {
    engine.tick(50);
    const now = ask("GET", particles ? "scenarios/A/state" : "scenarios/A/depth_averaged");
    if (particles ? now.status === "running" : now.state === "running" || now.state === "waiting") continue;
    if (!particles && now.state !== "done") throw new Error(now.message);
    postMessage((particles ? now.time_s : now.result.end_s) / ((performance.now() - begun) / 1e3));
    return;
  }
};`;
const script = "text/javascript";
const served = {
  "/": ["text/html", () => "<!doctype html><title>engine</title>"], "/worker.js": [script, () => worker], "/engine.mjs": [script, () => readFileSync(wrapper)],
  "/talus_engine.js": [script, () => readFileSync(join(engine, "talus_engine.js"))], "/talus_engine.wasm": ["application/wasm", () => readFileSync(join(engine, "talus_engine.wasm"))],
  "/scene.bin": ["application/octet-stream", () => readFileSync(resolve(scene))],
};
const server = createServer((request, response) => {
  const found = served[request.url];
  if (found === undefined) response.writeHead(404).end();
  else response.writeHead(200, { "Content-Type": found[0] }).end(found[1]());
});
await new Promise((done) => server.listen(0, "127.0.0.1", done));
const browser = await chromium.launch({ executablePath: process.env.TALUS_BROWSER ?? "/usr/bin/chromium", args: ["--headless", "--no-sandbox", "--no-first-run"] });
const rates = [];
try {
  for (let run = 0; run < Number(runs); ++run) {
    const page = await browser.newPage();
    await page.goto(`http://127.0.0.1:${server.address().port}/`);
    rates.push(await page.evaluate((asked) => new Promise((done, failed) => {
      const made = new Worker("/worker.js", { type: "module" });
      made.onmessage = ({ data }) => done(data);
      made.onerror = ({ message }) => failed(new Error(message));
      made.postMessage(asked);
    }), model));
    await page.close();
    console.log(`${rates.at(-1).toFixed(2)} s per s`);
  }
} finally {
  await browser.close();
  server.close();
}
console.log(`median of ${rates.length}: ${rates.sort((a, b) => a - b)[rates.length >> 1].toFixed(2)}`);
