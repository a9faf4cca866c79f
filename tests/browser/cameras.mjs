// Debris in five views, at three times and at three sizes, to be looked at: a contact sheet per view, FOLDER/<view>.png, and each picture.
// Usage: node cameras.mjs TALUS FOLDER [VIEW ...], of the built-in scene, or of the scene file in TALUS_SCENE, in the natural look; TALUS_TIMES, such as 12,37: other times, s;
// TALUS_FINEST=1: with the whole mesh of the ground, which takes far longer without a graphics card.
import { mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";
import { Run, startServer, until } from "./twin/harness.mjs";

const [, , talus, folder, ...only] = process.argv;
const scene = process.env.TALUS_SCENE ?? fileURLToPath(new URL("../../scenes/sham_tseng/scene.toml", import.meta.url));
const times_s = (process.env.TALUS_TIMES ?? "12,37,90").split(",").map(Number);
const sizes = [[1440, 900], [1024, 768], [390, 844]];
mkdirSync(folder, { recursive: true });
const browser = await chromium.launch({ executablePath: process.env.TALUS_BROWSER ?? "/usr/bin/chromium", args: ["--headless", "--no-sandbox",
  "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--no-first-run", ...(process.env.TALUS_SITE ? ["--disable-features=LocalNetworkAccessChecks"] : [])] });
const run = new Run(browser, folder);
const server = await startServer([talus, "serve", "--json", "--port", "0", "--set", "solver.target_particle_count=3000", scene]);

/** Places beside the flow path: `along` m of chainage, `beside` m to its left, `above` m over the path there. */
function places({ origin, flow_path }) {
  const { points, chainage_m } = flow_path;
  return (along, beside, above) => {
    const next = chainage_m.findIndex((c) => c >= along);
    const k = next < 0 ? points.length - 2 : Math.max(0, next - 1);
    const [a, b] = [points[k], points[k + 1]];
    const t = Math.max(0, (along - chainage_m[k]) / (chainage_m[k + 1] - chainage_m[k])); // beyond the end straight on
    const [dx, dy] = [b[0] - a[0], b[1] - a[1]].map((v) => v / Math.hypot(b[0] - a[0], b[1] - a[1]));
    const at = a.map((v, axis) => v + t * (b[axis] - v) - origin[axis]);
    return [at[0] - dy * beside, at[1] + dx * beside, at[2] + above];
  };
}
/** A sheet of all pictures of a view: a row per size, a column per time. */
async function sheet(name, rows) {
  const page = await browser.newPage({ viewport: { width: 1500, height: 1000 } });
  const html = rows.map((row) => `<div style="display: flex; gap: 6px; margin-bottom: 6px">${row.map((png) => `<img style="height: 420px" src="data:image/png;base64,${png.toString("base64")}">`).join("")}</div>`).join("");
  await page.setContent(`<body style="margin: 0; width: max-content">${html}</body>`);
  await page.waitForFunction(() => [...document.images].every((image) => image.complete));
  writeFileSync(join(folder, `${name}.png`), await page.locator("body").screenshot());
  await page.close();
}

try {
  const post = async (body) => {
    const response = await fetch(`${server.base}api/scenarios/A/actions`, { method: "POST", body: JSON.stringify(body), headers: { Authorization: `Bearer ${server.token}`, "Content-Type": "application/json" } });
    if (!response.ok) throw new Error(`${body.action}: ${response.status} ${await response.text()}`);
  };
  await post({ action: "set_speed", factor: null });
  await post({ action: "run" });
  const state = () => server.ask("scenarios/A/state");
  await until(state, (s) => s.time_s >= Math.max(...times_s) || s.status !== "running", "the run");
  await post({ action: "pause" });
  const last_s = (await state()).time_s;
  const about = await server.ask("scene");
  const at = places(about);
  const length = about.flow_path.chainage_m.at(-1);
  const saved = [{ position: at(length + 30, 25, 25), target: at(0.55 * length, 0, 5) }, { position: at(0.72 * length, 12, 10), target: at(0.42 * length, 0, 1) }];
  /** The mode of the camera, or the number of a saved view; null: as the page begins. */
  const views = { first: null, uphill: "1", low: "2", follow: "follow", plan: "plan" };
  const wanted = Object.entries(views).filter(([name]) => only.length === 0 || only.includes(name));
  const rows = Object.fromEntries(wanted.map(([name]) => [name, []]));
  for (const [width, height] of sizes) {
    const page = await run.open(server.viewer, { width, height, look: "natural", sharp: true, opening: true, touch: width < 720, finest: process.env.TALUS_FINEST !== undefined,
      prepare: (page) => page.addInitScript(([key, all]) => localStorage.setItem(key, JSON.stringify(all)), [`talus-views${about.title}`, saved]) });
    for (const [name, view] of wanted) {
      const row = [];
      for (const time of times_s) {
        await page.locator(".timeline").evaluate((e, t) => {
          e.value = t;
          e.dispatchEvent(new Event("input", { bubbles: true }));
        }, Math.min(time, last_s));
        await until(() => page.evaluate(() => window.talusStats.shownTime_s), (t) => Math.abs(t - Math.min(time, last_s)) < 0.5, `${time} s`);
        // Menus that are hidden on a phone answer as well.
        if (view === "follow" || view === "plan") await page.evaluate((mode) => document.querySelector(`.bar.camera [data-mode=${mode}]`).click(), view);
        else if (view) await page.locator("[aria-label='Saved views']").evaluate((e, number) => {
          e.value = number;
          e.dispatchEvent(new Event("change", { bubbles: true }));
        }, view);
        await run.still(page);
        row.push(await page.screenshot());
        writeFileSync(join(folder, `${name}-${width}-${time}.png`), row.at(-1));
        console.log(`${name}, ${width} x ${height}, ${time} s`);
      }
      rows[name].push(row);
    }
    await page.context().close();
  }
  for (const [name, pictures] of Object.entries(rows)) await sheet(name, pictures);
} finally {
  await server.stop();
  await browser.close();
}
