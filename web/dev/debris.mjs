// Debris for the stand-in server: points that slide with friction and spread down the gradient of their own depth.
// It looks like a flow and is none; results mean nothing.
const GRAVITY = 9.81;

export function pointInRing(ring, x, y) {
  let inside = false;
  for (let i = 0, j = ring.length - 1; i < ring.length; j = i++) {
    const [xi, yi] = ring[i], [xj, yj] = ring[j];
    if ((yi > y) !== (yj > y) && x < ((xj - xi) * (y - yi)) / (yj - yi) + xi) inside = !inside;
  }
  return inside;
}

export class Debris {
  constructor(ground, walls) {
    this.ground = ground;
    this.walls = walls;
    this.n = 0;
    for (const name of ["x", "y", "z", "u", "v", "rise", "volume"]) this[name] = new Float64Array(1024);
    this.owner = [];
    const cells = ground.columns * ground.rows;
    this.depth = new Float32Array(cells);
    this.mapSpeed = new Float32Array(cells);
    for (const name of ["peakDepth", "peakSpeed", "peakPressure", "arrival", "deposit"]) {
      this[name] = new Float32Array(cells).fill(NaN);
    }
    this.blocked = new Uint8Array(cells);
  }
  grow(size) {
    if (size <= this.x.length) return;
    for (const name of ["x", "y", "z", "u", "v", "rise", "volume"]) {
      const larger = new Float64Array(2 * size);
      larger.set(this[name]);
      this[name] = larger;
    }
  }
  seed(release, spacing) {
    const ring = release.polygons[0];
    const xs = ring.map((p) => p[0]), ys = ring.map((p) => p[1]);
    const layers = Math.max(1, Math.round(release.thickness_m / spacing));
    for (let y = Math.min(...ys); y <= Math.max(...ys); y += spacing) {
      for (let x = Math.min(...xs); x <= Math.max(...xs); x += spacing) {
        if (!pointInRing(ring, x, y)) continue;
        for (let k = 0; k < layers; ++k) {
          this.grow(this.n + 1);
          const i = this.n++;
          this.x[i] = x + (Math.random() - 0.5) * 0.6 * spacing;
          this.y[i] = y + (Math.random() - 0.5) * 0.6 * spacing;
          this.rise[i] = (k + 0.5) / layers;
          this.u[i] = this.v[i] = 0;
          this.volume[i] = (spacing * spacing * release.thickness_m) / layers;
          this.owner[i] = release.id;
        }
      }
    }
    this.raster(0);
  }
  remove(id) {
    for (let i = 0; i < this.n; ++i) if (this.owner[i] === id) { this.owner[i] = null; this.volume[i] = 0; }
  }
  cellOf(x, y) {
    const g = this.ground, i = Math.floor((x - g.xMin) / g.cell), j = Math.floor((y - g.yMin) / g.cell);
    return i < 0 || j < 0 || i >= g.columns || j >= g.rows ? -1 : j * g.columns + i;
  }
  raster(time) {
    const { depth, mapSpeed, ground } = this;
    const area = ground.cell * ground.cell, w = ground.columns;
    depth.fill(0);
    mapSpeed.fill(0);
    for (let i = 0; i < this.n; ++i) {
      if (this.owner[i] === null) continue;
      const c = this.cellOf(this.x[i], this.y[i]);
      if (c < w + 1 || c >= depth.length - w - 1) continue;
      const part = this.volume[i] / area, speed = Math.hypot(this.u[i], this.v[i]);
      for (const [o, s] of [[0, 0.36], [1, 0.12], [-1, 0.12], [w, 0.12], [-w, 0.12], [w + 1, 0.04], [w - 1, 0.04], [-w + 1, 0.04], [-w - 1, 0.04]]) {
        depth[c + o] += s * part;
        mapSpeed[c + o] += s * part * speed;
      }
    }
    for (let c = 0; c < depth.length; ++c) {
      const h = depth[c];
      if (!(h > 0.02)) continue;
      const s = (mapSpeed[c] /= h);
      if (!(this.peakDepth[c] >= h)) this.peakDepth[c] = h;
      if (!(this.peakSpeed[c] >= s)) this.peakSpeed[c] = s;
      if (!(this.peakPressure[c] >= 2 * s * s)) this.peakPressure[c] = 2 * s * s;
      if (!(this.arrival[c] >= 0)) this.arrival[c] = time;
      this.deposit[c] = h;
    }
  }
  step(dt, friction, viscosity, time) {
    const { ground, depth } = this;
    const w = ground.columns, e = ground.cell;
    for (let i = 0; i < this.n; ++i) {
      if (this.owner[i] === null) continue;
      const x = this.x[i], y = this.y[i];
      const gx = (ground.at(x + e, y) - ground.at(x - e, y)) / (2 * e), gy = (ground.at(x, y + e) - ground.at(x, y - e)) / (2 * e);
      const c = this.cellOf(x, y);
      const inner = c > w && c < depth.length - w;
      const hx = inner ? (depth[c + 1] - depth[c - 1]) / (2 * e) : 0, hy = inner ? (depth[c + w] - depth[c - w]) / (2 * e) : 0;
      let u = this.u[i] - GRAVITY * dt * (gx + 0.7 * hx) / (1 + gx * gx), v = this.v[i] - GRAVITY * dt * (gy + 0.7 * hy) / (1 + gy * gy);
      const speed = Math.hypot(u, v), drag = dt * (friction * GRAVITY / Math.sqrt(1 + gx * gx + gy * gy) + 0.01 * viscosity * 10 * speed * speed);
      const keep = speed > drag ? 1 - drag / speed : 0;
      u *= keep;
      v *= keep;
      const to = this.cellOf(x + u * dt, y + v * dt);
      if (to < 0) { this.owner[i] = null; continue; }
      if (this.blocked[to]) {
        this.hit?.(this.blocked[to], this.volume[i], Math.hypot(u, v), time, depth[c]);
        u *= -0.1;
        v *= -0.1;
      } else {
        this.x[i] = x + u * dt;
        this.y[i] = y + v * dt;
      }
      this.u[i] = u;
      this.v[i] = v;
      const h = c >= 0 ? depth[c] : 0;
      this.z[i] = ground.at(this.x[i], this.y[i]) + 0.1 + this.rise[i] * Math.max(h, 0.3);
    }
    this.raster(time);
  }
}
