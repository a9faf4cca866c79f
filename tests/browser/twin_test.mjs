// The page of the live twin in Chromium, with real clicks and keys.
// Usage: node twin_test.mjs OUTPUT_FOLDER SERVER [ARGUMENT ...]: the server prints a line of JSON with its links, as
// `talus serve --json --port 0 SCENE` does. TALUS_PARTS=PART,... runs those parts alone, TALUS_ONLY=PATTERN
// the checks whose name matches.
// Exit code 77: skipped, the browser or its driver is missing.
import { resolve } from "node:path";
import { existsSync, Run, startServer } from "./twin/harness.mjs";
import { testBackanalysis } from "./twin/backanalysis.mjs";
import { testBarrier } from "./twin/barrier.mjs";
import { testErosion } from "./twin/erosion.mjs";
import { testGround } from "./twin/ground.mjs";
import { testLevers } from "./twin/levers.mjs";
import { testParts } from "./twin/parts.mjs";
import { testPhoto } from "./twin/photo.mjs";
import { testReadings } from "./twin/readings.mjs";
import { testSharing } from "./twin/sharing.mjs";

const [, , output, ...command] = process.argv;
const browserPath = process.env.TALUS_BROWSER ?? "/usr/bin/chromium";
function skip(reason) {
  console.log(`SKIPPED browser.twin: ${reason}`);
  process.exit(77);
}
if (!existsSync(browserPath)) skip(`no browser at ${browserPath}; install chromium or set TALUS_BROWSER`);
let chromium;
try {
  ({ chromium } = await import("playwright-core"));
} catch {
  skip("playwright-core is not installed; run `npm ci` in tests/browser");
}

// WebGL without a graphics card: SwiftShader has to be asked for.
const browser = await chromium.launch({ executablePath: browserPath, args: ["--headless", "--no-sandbox", "--use-angle=swiftshader",
  "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--disable-background-networking", "--disable-component-update", "--no-first-run"] });
const run = new Run(browser, resolve(output), process.env.TALUS_ONLY);
const server = await startServer(command);
const parts = (process.env.TALUS_PARTS ?? "levers,readings,barrier,parts,erosion,ground,photo,backanalysis,sharing").split(",");
let sharing = server;
try {
  if (parts.includes("levers")) await (await testLevers(run, server)).context().close();
  if (parts.includes("readings")) await testReadings(run, server);
  if (parts.includes("barrier")) await testBarrier(run, command);
  if (parts.includes("parts")) await testParts(run, server, command);
  if (parts.includes("erosion")) await testErosion(run, command);
  if (parts.includes("ground")) await testGround(run, server, command);
  if (parts.includes("photo")) await testPhoto(run, server, command);
  if (parts.includes("backanalysis")) await testBackanalysis(run, command);
  if (parts.includes("sharing")) sharing = await testSharing(run, server, command);
  await run.check("nothing but the server is asked for, and the console is silent", async () => {
    const own = run.ports.flatMap((port) => [`http://127.0.0.1:${port}/`, `ws://127.0.0.1:${port}/`]);
    const foreign = run.requests.filter((url) => !own.some((base) => url.startsWith(base)));
    if (foreign.length > 0) throw new Error(`asked for ${[...new Set(foreign)].join(", ")}`);
    if (run.problems.length > 0) throw new Error([...new Set(run.problems)].join("\n"));
  });
} finally {
  await browser.close();
  await sharing.stop();
  await server.stop();
}
console.log(`${run.passed} passed, ${run.failed} failed`);
process.exit(run.failed === 0 && run.passed > 0 ? 0 : 1);
