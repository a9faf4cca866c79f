// Records messages of the real program for the unit tests of web/: a frame, the terrain, and numbers of that moment to hold them against.
// Usage: node record_messages.mjs TALUS. Run it again when docs/protocol.md changes.
import { mkdirSync, mkdtempSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { startServer, until } from "./twin/harness.mjs";
import { writeGully } from "./twin/gully.mjs";

const folder = fileURLToPath(new URL("../../web/test/recorded/", import.meta.url));
const gully = writeGully(mkdtempSync(join(tmpdir(), "talus_gully_")));
const server = await startServer([process.argv[2], "serve", "--json", "--port", "0", "--set", "solver.particle_spacing_m=1.4", gully]);
const get = async (path) => {
  const response = await fetch(`${server.base}api/${path}`, { headers: { Authorization: `Bearer ${server.token}` } });
  return Buffer.from(await response.arrayBuffer());
};
const act = (body) => fetch(`${server.base}api/scenarios/A/actions`, { method: "POST", body: JSON.stringify(body),
  headers: { Authorization: `Bearer ${server.token}`, "Content-Type": "application/json" } });
try {
  await act({ action: "run" });
  // Long enough for some debris to have run over the edge: its particles are absent.
  await until(() => server.ask("scenarios/A/state"), (s) => s.time_s > 10, "debris over the edge");
  await act({ action: "pause" });
  const state = await until(() => server.ask("scenarios/A/state"), (s) => s.status === "paused", "the pause");
  const scene = await server.ask("scene");
  mkdirSync(folder, { recursive: true });
  writeFileSync(join(folder, "frame.bin"), await get("scenarios/A/frame"));
  writeFileSync(join(folder, "terrain.bin"), await get("terrain"));
  const { time_s, step, particles } = state;
  const { particle_spacing_m, origin, extent_m, elevation_m, map } = scene;
  writeFileSync(join(folder, "moment.json"), `${JSON.stringify({ time_s, step, particles, particle_spacing_m, origin, extent_m, elevation_m, map })}\n`);
} finally {
  await server.stop();
}
