// engine_test.mjs ENGINE_FOLDER PACKED_SCENE WRAPPER JOURNAL: the page's engine in node. Opens a packed scene, joins, changes
// friction, builds a barrier, runs, reads a frame and a map, and writes the journal, which the program replays.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';
import { resolve } from 'node:path';

const [folder, scene, wrapper, journal] = process.argv.slice(2);
const { makeEngine } = await import(pathToFileURL(resolve(wrapper)));
const { default: factory } = await import(pathToFileURL(resolve(folder, 'talus_engine.js')));
const wasm = readFileSync(resolve(folder, 'talus_engine.wasm'));
const engine = await makeEngine(factory, wasm.buffer.slice(wasm.byteOffset, wasm.byteOffset + wasm.byteLength));
const packed = new Uint8Array(readFileSync(scene));

const json = (answer) => JSON.parse(new TextDecoder().decode(answer.body));
const get = (path) => engine.request('GET', path, '');
const post = (path, body) => engine.request('POST', path, JSON.stringify(body));

// Damaged files are refused in a sentence, and the engine goes on.
assert.throws(() => engine.open(packed.slice(0, packed.length - 5)), /the packed scene is cut short or damaged/);
assert.throws(() => engine.open(new Uint8Array(0)), /the packed scene is cut short/);
assert.throws(() => engine.open(new TextEncoder().encode('<html></html>')), /is not a packed scene/);
assert.throws(() => engine.join('too early'), /no scene is open/);

const { hash } = engine.open(packed);
assert.match(hash, /^[0-9a-f]{16}$/);

const sent = [];
engine.onSend = (client, message) => sent.push({ client, message });
const client = engine.join('<b>Ada</b>');
const hello = JSON.parse(sent.find((one) => typeof one.message === 'string').message);
assert.equal(hello.type, 'hello');
assert.equal(hello.you.role, 'controller');
assert.throws(() => engine.message(client, '{"type":"nothing"}'), /protocol/);
engine.message(client, JSON.stringify({ type: 'view', scenarios: ['A'], rate_hz: 30, particle_cap: 100000 }));

const opened = json(get('/api/scene'));
assert.ok(opened.title.length > 0);
assert.equal(get('/api/terrain?max_cells=10000').type, 'application/octet-stream');
assert.equal(get('/api/terrain?max_cells=7').status, 400);
assert.equal(json(get('/api/session')).title, opened.title);
const absent = get('/api/ensembles');
assert.equal(absent.status, 404);
assert.match(json(absent).error, /needs the program on a machine/);
assert.equal(get('/api/scenarios/Z/state').status, 404);
assert.equal(get('/api/scenarios/A/layers/nonsense').status, 404);
assert.equal(get('/api/scenarios/A/layers/depth?time=3').status, 400);

const acted = post('/api/scenarios/A/actions', { action: 'set_parameters', values: { 'material.friction_coefficient': 0.3 } });
assert.equal(acted.status, 200, new TextDecoder().decode(acted.body));
const refused = post('/api/scenarios/A/actions', { action: 'set_parameters', values: { 'material.friction_coefficient': -3 } });
assert.equal(refused.status, 400);
assert.match(json(refused).error, /friction_coefficient/);

/** A line of 40 m across the middle of the flow path, or of the terrain. */
const [west, south, east, north] = opened.extent_m;
const path = opened.flow_path ?? [];
const middle = path.length > 2 ? path[Math.floor(path.length / 2)] : [(west + east) / 2, (south + north) / 2];
const line = [
    [middle[0] - 20, middle[1]],
    [middle[0] + 20, middle[1]],
];
const built = post('/api/scenarios/A/actions', { action: 'put_barrier', line, height_m: 3, thickness_m: 1 });
assert.equal(built.status, 200, new TextDecoder().decode(built.body));

assert.equal(post('/api/scenarios/A/actions', { action: 'set_speed', factor: null }).status, 200);
assert.equal(post('/api/scenarios/A/actions', { action: 'run' }).status, 200);
const begin = performance.now();
const until = Number(process.env.TALUS_RUN_S ?? 2);
const cpu = process.cpuUsage();
while (json(get('/api/scenarios/A/state')).time_s < until) {
    engine.tick(50);
    assert.ok(performance.now() - begin < 240000, 'it takes too long');
}
const user = process.cpuUsage(cpu).user / 1e6;
assert.equal(post('/api/scenarios/A/actions', { action: 'pause' }).status, 200);
const state = json(get('/api/scenarios/A/state'));
console.log(`${state.time_s.toFixed(2)} s of debris in ${user.toFixed(2)} s of processor time`);

const frames = sent.filter((one) => one.client === client && one.message instanceof ArrayBuffer);
assert.ok(frames.length > 0, 'frames were sent');
assert.ok(frames.at(-1).message.byteLength > 100);
assert.ok(get('/api/scenarios/A/frame').body.length > 100);
assert.equal(get('/api/scenarios/A/layers/peak_depth').status, 200);
assert.ok(json(get('/api/scenarios/A/series')) !== null);

const copied = post('/api/scenarios', { copy_of: 'A' });
assert.equal(copied.status, 200, new TextDecoder().decode(copied.body));
assert.equal(engine.request('DELETE', '/api/scenarios/B', '').status, 200);

const written = json(get('/api/scenarios/A/journal'));
assert.equal(written.last.step, state.step);
assert.equal(written.actions.length, 2);
writeFileSync(journal, JSON.stringify(written));
engine.leave(client);
