// package_test.mjs PACKAGE SCENE README: the npm package talus-engine in node, unpacked at node_modules/talus-engine of PACKAGE, with the built
// engine, and the example of its README. Exit code 77: skipped, there is no package.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { copyFileSync, existsSync, readFileSync, writeFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [folder, scene, readme] = process.argv.slice(2);
const module = resolve(folder, "node_modules/talus-engine/index.js");
if (!existsSync(module)) {
  console.log(`SKIPPED web_engine.package: ${module} is not there; scripts/test.sh publish builds the engine and packs it`);
  process.exit(77);
}
const { openTwin, Refused } = await import(pathToFileURL(module));
const packed = new Uint8Array(readFileSync(scene));

// What is no scene is refused in a sentence.
await assert.rejects(openTwin(packed.slice(0, packed.length - 5)), /the packed scene is cut short or damaged/);
await assert.rejects(openTwin(new TextEncoder().encode("<html></html>")), /is not a packed scene/);

const twin = await openTwin(packed);
const { run } = twin;
assert.ok(twin.scene.title.length > 0);
assert.match(twin.hash, /^[0-9a-f]{16}$/);
const terrain = await twin.terrain(10_000);
assert.ok(terrain.values instanceof Float32Array && terrain.columns * terrain.rows === terrain.values.length && terrain.values.length <= 10_000);
await assert.rejects(twin.terrain(7), (error) => error instanceof Refused && error.status === 400 && /max_cells = 7/.test(error.message));
assert.equal(await twin.orthophoto(), null);

// Time goes on by steps and by seconds; the particles move.
const first = await run.particles();
assert.equal(first.positions.length, 3 * first.count);
assert.equal((await run.step(2)).step, 2);
const state = await run.advance(0.5);
assert.ok(state.time_s >= 0.5 && state.time_s < 0.7, `${state.time_s} s`);
const moved = await run.particles();
assert.equal(moved.time_s, state.time_s);
assert.ok(moved.speeds.some((speed) => speed > 0.1), "nothing moves");
const [west, south, east, north] = twin.scene.extent_m;
for (let i = 0; i < moved.count; ++i) {
  const [x, y] = [moved.positions[3 * i] + twin.scene.origin[0], moved.positions[3 * i + 1] + twin.scene.origin[1]];
  assert.ok(x > west && x < east && y > south && y < north, `particle ${i} at ${x}, ${y}`);
}
assert.equal((await run.particles(0)).time_s, 0);

// Maps and readings.
const depth = await run.map("peak_depth");
assert.ok(depth.values.some((value) => value > 0), "no depth");
await assert.rejects(run.map("nonsense"), (error) => error.status === 404);
const impacts = await run.impacts();
assert.ok(Array.isArray(impacts.buildings) && Array.isArray(impacts.barriers));
assert.ok((await run.series()).time.time_s.length > 1);
assert.ok((await run.figures()).length > 0);

// Changes: made, refused in a sentence, kept in the journal; steps are the same every time.
const built = await run.act({ action: "put_barrier", line: [[(west + east) / 2 - 20, (south + north) / 2], [(west + east) / 2 + 20, (south + north) / 2]], height_m: 3, thickness_m: 1 });
assert.equal(typeof built.created, "string");
await assert.rejects(run.act({ action: "put_barrier", id: built.created, height_m: -1 }), (error) => error instanceof Refused && /height_m = -1/.test(error.message));
await assert.rejects(run.act({ action: "run" }), /advance/);
await run.act({ action: "restart" });
const once = await run.advance(0.3);
const other = await run.copy();
const again = await other.advance(0.3);
assert.equal(again.hash, once.hash);
assert.equal((await run.setup()).barriers.length, (await other.setup()).barriers.length);
await other.end();
await assert.rejects(other.state(), (error) => error.status === 404);
assert.equal(JSON.parse(await run.journal()).talus_journal, 1);

// It does not begin again by itself after it was closed.
twin.close();
await assert.rejects(run.state(), /closed/);

// The README's example is a program that works.
const example = /```js\n(import [\s\S]*?)```/.exec(readFileSync(readme, "utf8"))[1];
copyFileSync(scene, join(folder, "scene.bin"));
writeFileSync(join(folder, "example.mjs"), example);
const ran = spawnSync(process.execPath, ["example.mjs"], { cwd: folder, encoding: "utf8" });
assert.equal(ran.status, 0, ran.stderr);
assert.match(ran.stdout, /particles at 2\.\d+ s, the fastest at [0-9.]+ m\/s\n\d+ x \d+ cells of/);
console.log("the npm package works in node, and so does the example of its README");
