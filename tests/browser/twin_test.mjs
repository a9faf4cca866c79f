// The page of the live twin in Chromium, with real clicks and keys.
// Usage: node twin_test.mjs OUTPUT_FOLDER TALUS serve SCENE. TALUS_PARTS=PART,... runs those parts alone, TALUS_ONLY=PATTERN the checks
// whose name matches, TALUS_WAIT_S=SECONDS waits less than five minutes for what does not come. No check is a clock: what is waited for is a state of the server or the page, and a run that has to go on while
// the page is looked at goes slowly.
// Exit code 77: skipped, the browser or its driver is missing.
import { resolve } from "node:path";
import { end, findChromium, softwareWebGL } from "./chromium.mjs";
import { Run, waitedFor, within } from "./twin/harness.mjs";
import { testBackanalysis } from "./twin/backanalysis.mjs";
import { testBarrier } from "./twin/barrier.mjs";
import { testDepthAveraged } from "./twin/depth_averaged.mjs";
import { testDrawing } from "./twin/drawing.mjs";
import { testErosion } from "./twin/erosion.mjs";
import { testLayers } from "./twin/layers.mjs";
import { testLook } from "./twin/look.mjs";
import { testGround } from "./twin/ground.mjs";
import { testControls } from "./twin/controls.mjs";
import { testParts } from "./twin/parts.mjs";
import { testPhoto } from "./twin/photo.mjs";
import { testReadings } from "./twin/readings.mjs";
import { testRestart } from "./twin/restart.mjs";
import { testScenarios } from "./twin/scenarios.mjs";
import { testSharing } from "./twin/sharing.mjs";
import { testStart } from "./twin/start.mjs";
import { testTables } from "./twin/tables.mjs";
import { testTriggers } from "./twin/triggers.mjs";
import { testVisible } from "./twin/visible.mjs";

const [, , output, ...command] = process.argv;
const launch = await findChromium("twin");
const browser = await launch([...softwareWebGL, ...(process.env.TALUS_SITE ? ["--disable-features=LocalNetworkAccessChecks"] : [])]);
// Before the limit of ctest, which would not say where it stood.
setTimeout(() => {
  console.log(`FAILED  not over after 1100 s; last waited for: ${waitedFor()}`);
  process.exit(1);
}, 1_100_000).unref();
const run = new Run(browser, resolve(output), command, process.env.TALUS_ONLY);
const parts = { controls: testControls, readings: testReadings, restart: testRestart, scenarios: testScenarios, barrier: testBarrier, parts: testParts, erosion: testErosion, ground: testGround, layers: testLayers, look: testLook, photo: testPhoto,
  backanalysis: testBackanalysis, depth_averaged: testDepthAveraged, drawing: testDrawing, sharing: testSharing, start: testStart, tables: testTables, triggers: testTriggers, visible: testVisible };
try {
  for (const part of (process.env.TALUS_PARTS ?? Object.keys(parts).join()).split(",")) {
    if (!parts[part]) throw new Error(`TALUS_PARTS names ${part}; there are ${Object.keys(parts).join(", ")}`);
    await parts[part](run);
  }
  await run.check("nothing but the server is asked for, and the console is silent", async () => {
    const own = run.servers.flatMap(({ port }) => [`http://127.0.0.1:${port}/`, `ws://127.0.0.1:${port}/`]);
    const foreign = run.requests.filter((url) => !own.some((base) => url.startsWith(base)));
    if (foreign.length > 0) throw new Error(`asked for ${[...new Set(foreign)].join(", ")}`);
    if (run.problems.length > 0) throw new Error([...new Set(run.problems)].join("\n"));
  });
} finally {
  await within(browser.close(), "the end of the browser", 60_000).catch((error) => console.log(error.message));
  await run.stopServers();
}
end(run);
