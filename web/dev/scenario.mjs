// One scenario of the stand-in server: setup with undo, debris, recording.
import { Debris, pointInRing } from "./debris.mjs";
import { told } from "./ground_actions.mjs";
import { encodeFrame } from "./wire.mjs";

const clone = (value) => JSON.parse(JSON.stringify(value));
const ringArea = (ring) => Math.abs(ring.reduce((sum, [x, y], i) => {
  const [u, v] = ring[(i + 1) % ring.length];
  return sum + x * v - u * y;
}, 0)) / 2;
const middle = (ring) => ring.reduce(([a, b], [x, y]) => [a + x / ring.length, b + y / ring.length], [0, 0]);

export class Scenario {
  constructor(letter, valley, options, setup) {
    Object.assign(this, { letter, valley, options });
    this.ground = valley.ground;
    this.status = "paused";
    this.speedFactor = 1;
    this.revision = 1;
    this.past = [];
    this.future = [];
    this.nextId = 100;
    this.setup = setup ? clone(setup) : this.firstSetup();
    this.restart();
  }
  firstSetup() {
    const release = { id: "release-1", name: "main failure", polygons: [this.valley.release], thickness_m: 1.3,
      from_scene: true, status: "held", start_time_s: 0 };
    return {
      parameters: Object.fromEntries(this.options.parameters.map((p) => [p.key, p.default])),
      releases: [this.measured(release)],
      barriers: [],
      buildings: this.valley.houses.map((h, i) => this.based({ id: `building-${i + 1}`, name: h.name, footprint: [[h.ring]],
        height_m: h.height, from_scene: true })),
      zones: [], beds: [], inflows: [],
    };
  }
  measured(release) {
    const ring = release.polygons[0];
    const slope = this.ground.slope(...middle(ring));
    release.volume_m3 = ringArea(ring) * release.thickness_m * Math.hypot(1, slope);
    return release;
  }
  based(building) {
    const z = building.footprint[0][0].map(([x, y]) => this.ground.at(x, y));
    building.base_m = Math.min(...z);
    building.roof_m = Math.max(...z) + building.height_m;
    return building;
  }
  restart() {
    this.time = 0;
    this.steps = 0;
    this.debris = new Debris(this.ground);
    this.recorded = [];
    this.series = { time_s: [], front_chainage_m: [], volume_entrained_m3: [], volume_held_m3: [], volume_moving_m3: [], volume_deposited_m3: [],
      volume_left_m3: [], kinetic_energy_J: [], potential_energy_J: [], largest_speed_mps: [], mean_compression: [] };
    this.front = { chainage_m: [], arrival_time_s: [], front_velocity_mps: [], particle_speed_mps: [] };
    this.hits = new Map();
    for (const r of this.setup.releases) {
      r.status = "held";
      if (r.from_scene) this.release(r);
    }
    this.begin();
    this.block();
    this.sample();
  }
  /** Beds and inflows are those of the run's begin until it is restarted. */
  begin() {
    this.begun = clone({ beds: this.setup.beds, inflows: this.setup.inflows });
  }
  release(r) {
    r.status = "released";
    r.start_time_s = this.time;
    const spacing = Math.cbrt(r.volume_m3 / this.options.particles);
    this.debris.seed(r, Math.max(spacing, 0.12));
    this.debris.step(1e-6, 0, 0, this.time);
  }
  block() {
    const d = this.debris, g = this.ground;
    this.obstacles = [];
    d.blocked.fill(0);
    const mark = (id, test) => {
      const index = this.obstacles.push(id);
      for (let j = 0; j < g.rows; ++j) for (let i = 0; i < g.columns; ++i) {
        if (test(g.xMin + (i + 0.5) * g.cell, g.yMin + (j + 0.5) * g.cell)) d.blocked[j * g.columns + i] = index;
      }
    };
    for (const b of this.setup.buildings) mark(b.id, (x, y) => pointInRing(b.footprint[0][0], x, y));
    for (const b of this.setup.barriers) {
      mark(b.id, (x, y) => b.line.slice(1).some(([x1, y1], k) => {
        const [x0, y0] = b.line[k], l2 = (x1 - x0) ** 2 + (y1 - y0) ** 2;
        const t = Math.min(1, Math.max(0, ((x - x0) * (x1 - x0) + (y - y0) * (y1 - y0)) / l2));
        return Math.hypot(x - x0 - t * (x1 - x0), y - y0 - t * (y1 - y0)) < Math.max(b.thickness_m / 2, 0.8 * g.cell);
      }));
    }
    d.hit = (index, volume, speed, time, depth) => {
      const id = this.obstacles[index - 1];
      const h = this.hits.get(id) ?? { first: time, force: 0, pressure: 0, depth: 0, held: 0 };
      h.pressure = Math.max(h.pressure, 2 * speed * speed);
      h.force = Math.max(h.force, 40 * speed * speed);
      h.depth = Math.max(h.depth, depth);
      h.held = Math.min(h.held + volume * 0.02, 400);
      this.hits.set(id, h);
    };
  }
  change(sentence, edit) {
    this.past.push({ sentence, setup: clone(this.setup) });
    this.future = [];
    edit();
    if (this.steps === 0) this.begin();
    ++this.revision;
    this.block();
  }
  swap(from, to) {
    const entry = from.pop();
    if (!entry) return null;
    to.push({ sentence: entry.sentence, setup: clone(this.setup) });
    const before = this.setup.releases;
    this.setup = clone(entry.setup);
    for (const r of before) if (!this.setup.releases.some((s) => s.id === r.id)) this.debris.remove(r.id);
    for (const r of this.setup.releases) {
      if (before.find((s) => s.id === r.id)?.status === "released") r.status = "released";
    }
    if (this.steps === 0) this.begin();
    ++this.revision;
    this.block();
    return entry.sentence;
  }
  /** Advances by `seconds` of simulated time. */
  advance(seconds) {
    const dt = 0.025, p = this.setup.parameters;
    this.left = (this.left ?? 0) + seconds;
    let done = 0;
    while (this.left >= dt && this.status === "running" && done < 8) {
      this.debris.step(dt, p["material.friction_coefficient"], p["material.viscosity"], this.time);
      this.time += dt;
      this.left -= dt;
      ++done;
      if (++this.steps % 4 === 0) this.sample();
      if (this.time >= this.options.endTime) this.status = "ended";
    }
    if (done === 8) this.left = 0;
    this.lastSteps = done;
    return done;
  }
  sample() {
    const d = this.debris, f = this.frontNow();
    let moving = 0, deposited = 0, fastest = 0, kinetic = 0, potential = 0;
    for (let i = 0; i < d.n; ++i) {
      if (d.owner[i] === null) continue;
      const s = Math.hypot(d.u[i], d.v[i]);
      if (s > 0.3) moving += d.volume[i]; else deposited += d.volume[i];
      fastest = Math.max(fastest, s);
      kinetic += 1000 * d.volume[i] * s * s;
      potential += 2000 * 9.81 * d.volume[i] * (d.z[i] - this.ground.z[0]);
    }
    const held = this.setup.releases.filter((r) => r.status === "held").reduce((sum, r) => sum + r.volume_m3, 0);
    this.now = { moving, deposited, held, fastest, front: f, released: moving + deposited };
    const t = this.series;
    t.time_s.push(this.time);
    t.front_chainage_m.push(f);
    t.volume_entrained_m3.push(0);
    t.volume_held_m3.push(held);
    t.volume_moving_m3.push(moving);
    t.volume_deposited_m3.push(deposited);
    t.volume_left_m3.push(0);
    t.kinetic_energy_J.push(kinetic);
    t.potential_energy_J.push(potential);
    t.largest_speed_mps.push(fastest);
    t.mean_compression.push(0.004);
    const last = this.front.chainage_m.at(-1) ?? -5;
    if (f !== null && f > last + 5) {
      const before = this.front.arrival_time_s.at(-1) ?? 0;
      this.front.chainage_m.push(f);
      this.front.arrival_time_s.push(this.time);
      this.front.front_velocity_mps.push(this.time > before ? Math.min(20, (f - last) / (this.time - before)) : null);
      this.front.particle_speed_mps.push(fastest);
    }
    if (this.recorded.length === 0 || this.time - this.recorded.at(-1).time >= 0.099) {
      this.recorded.push({ time: this.time, bytes: this.frame(4) });
    }
  }
  frontNow() {
    const d = this.debris, path = this.options.path;
    let best = null;
    for (let i = 0; i < d.n; i += 7) {
      if (d.owner[i] === null) continue;
      for (let k = 0; k < path.points.length; k += 3) {
        const [x, y] = path.points[k];
        if (Math.hypot(d.x[i] - x, d.y[i] - y) < 4 && (best === null || path.chainage_m[k] > best)) best = path.chainage_m[k];
      }
    }
    return best;
  }
  frame(flags = 0) {
    const d = this.debris, g = this.ground, o = this.options.origin, n = d.n;
    const scale = [g.columns * g.cell / 60000, g.rows * g.cell / 60000, 0.005];
    const origin = [g.xMin - o[0], g.yMin - o[1], -100];
    const x = new Uint16Array(n).fill(65535), y = x.slice(), z = x.slice(), speed = new Uint8Array(n);
    for (let i = 0; i < n; ++i) {
      if (d.owner[i] === null) continue;
      x[i] = (d.x[i] - o[0] - origin[0]) / scale[0];
      y[i] = (d.y[i] - o[1] - origin[1]) / scale[1];
      z[i] = (d.z[i] - o[2] - origin[2]) / scale[2];
      speed[i] = Math.min(255, Math.hypot(d.u[i], d.v[i]) / 0.1);
    }
    let [c0, r0, c1, r1] = [g.columns, g.rows, -1, -1];
    for (let j = 0; j < g.rows; ++j) for (let i = 0; i < g.columns; ++i) {
      if (d.depth[j * g.columns + i] > 0.01) {
        c0 = Math.min(c0, i); c1 = Math.max(c1, i); r0 = Math.min(r0, j); r1 = Math.max(r1, j);
      }
    }
    const w = Math.max(0, c1 - c0 + 1), h = Math.max(0, r1 - r0 + 1);
    const depth = new Uint16Array(w * h), mapSpeed = new Uint8Array(w * h);
    for (let j = 0; j < h; ++j) for (let i = 0; i < w; ++i) {
      const k = (r0 + j) * g.columns + c0 + i;
      depth[j * w + i] = d.depth[k] / 0.001;
      mapSpeed[j * w + i] = Math.min(255, d.mapSpeed[k] / 0.1);
    }
    return encodeFrame({ scenario: this.letter === "A" ? 0 : 1, flags: flags | (this.status === "running" ? 1 : 0), time: this.time,
      step: this.steps, slots: n, stride: 1, origin, scale, speedScale: 0.1, window: w && h ? [c0, r0, w, h] : [0, 0, 0, 0],
      depthScale: 0.001, mapSpeedScale: 0.1, x, y, z, speed, depth, mapSpeed });
  }
  state() {
    const s = this.now;
    return { scenario: this.letter, status: this.status, message: "", time_s: this.time, end_time_s: this.options.endTime,
      step: this.steps, speed_factor: this.speedFactor, real_time_factor: this.status === "running" ? (this.speedFactor ?? 4) : 0,
      steps_per_second: this.status === "running" ? 40 * (this.speedFactor ?? 4) : 0, particles: this.debris.n,
      volume_released_m3: s.released, volume_entrained_m3: 0, volume_held_m3: s.held, volume_moving_m3: s.moving, volume_deposited_m3: s.deposited,
      volume_left_m3: 0, front_chainage_m: s.front, front_velocity_mps: this.front.front_velocity_mps.at(-1) ?? null,
      largest_speed_mps: s.fastest, mean_compression: 0.004, max_compression: 0.06,
      converged: this.setup.parameters["material.viscosity"] < 5,
      recording: { first_s: 0, last_s: this.recorded.at(-1).time, frames: this.recorded.length,
        bytes: this.recorded.reduce((sum, r) => sum + r.bytes.length, 0) },
      ...(this.status === "running" ? {} : { hash: (this.steps * 2654435761 % 2 ** 32).toString(16).padStart(16, "0") }) };
  }
  setupMessage() {
    return { scenario: this.letter, revision: this.revision, ...this.setup, ...told(this.setup, this.begun),
      undo: this.past.at(-1)?.sentence ?? null, redo: this.future.at(-1)?.sentence ?? null };
  }
}
