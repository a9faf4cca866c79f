// Ground, houses and flow path for the stand-in server: those of a scene of the repository where GDAL can read it,
// an invented valley otherwise.
import { execFileSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

export class Ground {
  /** z: heights in metres at cell centres, by rows from the south. */
  constructor(xMin, yMin, cell, columns, rows, z) {
    Object.assign(this, { xMin, yMin, cell, columns, rows, z });
  }
  at(x, y) {
    const u = Math.min(Math.max((x - this.xMin) / this.cell - 0.5, 0), this.columns - 1.001);
    const v = Math.min(Math.max((y - this.yMin) / this.cell - 0.5, 0), this.rows - 1.001);
    const i = Math.floor(u), j = Math.floor(v), a = u - i, b = v - j, k = j * this.columns + i;
    const z = this.z;
    return (1 - b) * ((1 - a) * z[k] + a * z[k + 1]) + b * ((1 - a) * z[k + this.columns] + a * z[k + this.columns + 1]);
  }
  get xMax() { return this.xMin + this.columns * this.cell; }
  get yMax() { return this.yMin + this.rows * this.cell; }
  slope(x, y) {
    const d = this.cell;
    return Math.hypot(this.at(x + d, y) - this.at(x - d, y), this.at(x, y + d) - this.at(x, y - d)) / (2 * d);
  }
}

function groundOfScene(folder) {
  const temporary = mkdtempSync(join(tmpdir(), "valley-"));
  try {
    const file = join(folder, "terrain.tif");
    const info = JSON.parse(execFileSync("gdalinfo", ["-json", file], { encoding: "utf8" }));
    const raw = join(temporary, "z");
    execFileSync("gdal_translate", ["-q", "-of", "ENVI", "-ot", "Float32", file, raw]);
    const bytes = readFileSync(raw);
    const [columns, rows] = info.size;
    const north = new Float32Array(bytes.buffer, bytes.byteOffset, columns * rows);
    const z = new Float32Array(columns * rows);
    for (let j = 0; j < rows; ++j) z.set(north.subarray((rows - 1 - j) * columns, (rows - j) * columns), j * columns);
    const [left, cell, , top] = info.geoTransform;
    return new Ground(left, top - rows * cell, cell, columns, rows, z);
  } finally {
    rmSync(temporary, { recursive: true });
  }
}

const features = (folder, name) => JSON.parse(readFileSync(join(folder, `${name}.geojson`), "utf8")).features;

function sceneFrom(folder) {
  return {
    title: "Sham Tseng San Tsuen 1999 (reconstruction)",
    ground: groundOfScene(folder),
    crs: "EPSG:2326",
    crsName: "Hong Kong 1980 Grid System",
    path: features(folder, "flow_path")[0].geometry.coordinates.map((p) => p.slice(0, 2)),
    release: features(folder, "release")[0].geometry.coordinates[0].slice(0, -1),
    houses: features(folder, "buildings").map((f) => ({
      name: f.properties.name, height: f.properties.height_m, ring: f.geometry.coordinates[0].slice(0, -1),
    })),
    observations: [
      { name: "superelevation marks below the bend", chainage_m: 121, front_velocity_mps: 11, source: "GEO Report No. 169" },
      { name: "superelevation marks in the gully", chainage_m: 217, front_velocity_mps: 7, source: "GEO Report No. 169" },
    ],
  };
}

function invented() {
  const columns = 200, rows = 300, cell = 1, xMin = 500000, yMin = 200000;
  const z = new Float32Array(columns * rows);
  const axis = (y) => 100 + 22 * Math.sin(y / 55);
  for (let j = 0; j < rows; ++j) {
    for (let i = 0; i < columns; ++i) {
      const off = i - axis(j);
      const fall = j < 70 ? 0.08 * j : 5.6 + 0.42 * (j - 70);
      z[j * columns + i] = 20 + fall + 0.012 * off * off / (1 + Math.abs(off) / 40) + 0.8 * Math.sin(i / 9) * Math.cos(j / 13);
    }
  }
  const path = [];
  for (let j = 285; j >= 15; j -= 3) path.push([xMin + axis(j), yMin + j]);
  const box = (x, y, w, h) => [[x, y], [x + w, y], [x + w, y + h], [x, y + h]].map(([a, b]) => [xMin + a, yMin + b]);
  return {
    title: "Invented valley", ground: new Ground(xMin, yMin, cell, columns, rows, z), crs: "EPSG:32650",
    crsName: "WGS 84 / UTM zone 50N", path,
    release: Array.from({ length: 14 }, (_, k) => [xMin + axis(262) + 9 * Math.cos(k / 14 * 2 * Math.PI),
      yMin + 262 + 14 * Math.sin(k / 14 * 2 * Math.PI)]),
    houses: [
      { name: "House 1", height: 6.5, ring: box(112, 48, 10, 9) }, { name: "House 2", height: 5, ring: box(92, 30, 9, 8) },
      { name: "House 3", height: 8, ring: box(126, 26, 11, 9) }, { name: "House 4", height: 3.5, ring: box(76, 56, 9, 10) },
    ],
    observations: [{ name: "marks in the bend", chainage_m: 120, front_velocity_mps: 11, source: "invented" }],
  };
}

export function loadValley(folder) {
  if (folder && existsSync(join(folder, "terrain.tif"))) {
    try {
      return sceneFrom(folder);
    } catch (error) {
      console.error(`stand-in: ${folder} cannot be read (${error.message.split("\n")[0]}); an invented valley is served`);
    }
  }
  return invented();
}
