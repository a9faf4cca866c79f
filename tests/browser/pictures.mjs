// The pictures in README.md and docs, made anew: of the built-in scene docs/images/twin.webp, twin_compare.webp, both_models.webp,
// report_map.webp; of each scene of the gallery gallery_<its folder>.webp.
// Usage: node pictures.mjs TALUS FOLDER [NAME ...], of the program's present page and reports; without names all of them.
import { execFileSync } from "node:child_process";
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { chromium } from "playwright-core";
import { inControl, programEnvironment, Run, startServer, until } from "./twin/harness.mjs";

const [, , talus, folder, ...only] = process.argv;
const scene = fileURLToPath(new URL("../../scenes/sham_tseng/scene.toml", import.meta.url));
const work = mkdtempSync(join(tmpdir(), "talus-pictures-"));
const browser = await chromium.launch({ executablePath: process.env.TALUS_BROWSER ?? "/usr/bin/chromium", args: ["--headless", "--no-sandbox",
  "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--no-first-run"] });
const run = new Run(browser, work);
mkdirSync(folder, { recursive: true });

/** As WebP, which is a fraction of a PNG with so many colours; what is larger than a page should load is made coarser. */
async function keep(name, page, png) {
  for (const quality of [0.9, 0.8, 0.7, 0.6]) {
    const data = await page.evaluate(async ([text, q]) => {
      const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${text}`)).blob());
      const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
      canvas.getContext("2d").drawImage(bitmap, 0, 0);
      const bytes = new Uint8Array(await (await canvas.convertToBlob({ type: "image/webp", quality: q })).arrayBuffer());
      let text_ = "";
      for (const byte of bytes) text_ += String.fromCharCode(byte);
      return btoa(text_);
    }, [png.toString("base64"), quality]);
    const bytes = Buffer.from(data, "base64");
    if (bytes.length > 300 * 1024) continue;
    writeFileSync(resolve(folder, `${name}.webp`), bytes);
    console.log(`${name}.webp  ${(bytes.length / 1024).toFixed(0)} KiB, quality ${quality}`);
    return;
  }
  throw new Error(`${name}: larger than 300 KiB at every quality`);
}
/** A page that may do what those of the program, with their Content-Security-Policy, may not. */
const blank = () => browser.newPage();
const serve = (...further) => startServer([talus, "serve", "--json", "--port", "0", ...further, scene]);
const post = async (server, path, body) => {
  const response = await fetch(`${server.base}api/${path}`, { method: "POST", body: JSON.stringify(body), headers: { Authorization: `Bearer ${server.token}`, "Content-Type": "application/json" } });
  if (!response.ok) throw new Error(`${path}: ${await response.text()}`);
};
/** Computes these scenarios until a time, as fast as it goes. */
async function compute(server, scenarios, time_s) {
  await post(server, "scenarios/A/actions", { action: "set_speed", factor: null });
  await post(server, "scenarios/A/actions", { action: "run", scenarios });
  const states = () => Promise.all(scenarios.map((name) => server.ask(`scenarios/${name}/state`)));
  await until(states, (all) => all.every((s) => s.time_s >= time_s || s.status !== "running"), `${time_s} s`);
  await post(server, "scenarios/A/actions", { action: "pause", scenarios });
  await until(states, (all) => all.every((s) => s.status !== "running"), "the pause");
}
async function photographed(name, page) {
  await page.mouse.move(720, 2);
  await run.still(page);
  await keep(name, await blank(), await page.screenshot());
}

const pictures = {
  /** Debris on its way to the village, in the natural look, from the side of the valley. */
  async twin() {
    const server = await serve("--set", "solver.target_particle_count=10000");
    await compute(server, ["A"], 34);
    const { origin, flow_path, title } = await server.ask("scene");
    const at = (chainage) => flow_path.points[flow_path.chainage_m.findIndex((c) => c >= chainage)].map((v, axis) => v - origin[axis]);
    const [target, low] = [at(215), at(345)];
    const [x, y] = [low[0] - target[0], low[1] - target[1]].map((v) => v / Math.hypot(low[0] - target[0], low[1] - target[1]));
    const position = [target[0] + 215 * x - 60 * y, target[1] + 215 * y + 60 * x, target[2] + 105];
    const page = await run.open(server.controller, { name: "Ada", width: 1440, height: 900, finest: true, sharp: true, look: "natural",
      prepare: (page) => page.addInitScript(([key, views]) => localStorage.setItem(key, JSON.stringify(views)), [`talus-views${title}`, [{ position, target }]]) });
    await inControl(page);
    await page.selectOption("[aria-label='Saved views']", "1");
    await photographed("twin", page);
    await server.stop();
  },
  /** Two values of friction, and the difference of their peak depths. */
  async twin_compare() {
    const server = await serve("--set", "solver.target_particle_count=5000");
    await post(server, "scenarios", { copy_of: "A" });
    await post(server, "scenarios/B/actions", { action: "set_parameter", key: "material.friction_coefficient", value: 0.3 });
    await compute(server, ["A", "B"], 45);
    const page = await run.open(server.controller, { name: "Ada", width: 1440, height: 900, finest: true, sharp: true });
    await inControl(page);
    await until(() => page.locator(".pane").count(), (n) => n === 2, "two views");
    await page.selectOption("select[aria-label^='Map layer']", "peak_depth");
    await page.locator(".check", { hasText: "B − A" }).locator("input").check();
    await page.click("[data-tab=compare]");
    await photographed("twin_compare", page);
    await server.stop();
  },
  /** Figures 1 and 2 of the report on both models. */
  async both_models() {
    const out = join(work, "both");
    execFileSync(talus, ["compare", "--set", "solver.target_particle_count=3000", "--set", "solver.grid_cell_m=1", "-o", out], { env: programEnvironment, stdio: "ignore" });
    const page = await browser.newPage({ viewport: { width: 1440, height: 900 } });
    await page.goto(pathToFileURL(join(out, "report.html")).href);
    // One is shown at a time, chosen by its tab.
    const figures = [];
    for (const tab of (await page.locator(".tabs button").all()).slice(0, 2)) {
      await tab.click();
      figures.push(await page.locator(".maps figure.map:visible > svg").screenshot());
    }
    const both = await blank();
    await both.setViewportSize({ width: 1840, height: 900 });
    await both.setContent(`<div style="display: flex; gap: 12px; width: max-content">${figures.map((png) => `<img src="data:image/png;base64,${png.toString("base64")}">`).join("")}</div>`);
    await both.waitForFunction(() => [...document.images].every((image) => image.complete));
    await keep("both_models", both, await both.locator("div").screenshot());
  },
  /** The map of peak depths of the report. */
  async report_map() {
    const out = join(work, "run");
    execFileSync(talus, ["run", "--set", "solver.target_particle_count=10000", "-o", out, scene], { env: programEnvironment, stdio: "ignore" });
    const page = await browser.newPage({ viewport: { width: 1280, height: 900 } });
    await page.goto(pathToFileURL(join(out, "report.html")).href);
    await keep("report_map", await blank(), await page.locator("figure.map[data-layer^=peak_depth] > svg").first().screenshot());
  },
};
/** The map of a scene of the gallery that shows best what happens there. */
const gallery = {
  barrier: "peak_depth", check_dam: "peak_depth", flexible_net: "peak_depth", deflection_dam: "peak_depth", entrainment: "erosion_depth",
  hydrograph: "peak_depth", two_surges: "deposit_depth", forest: "peak_speed", village: "peak_depth", hazard_zones: "hazard_zones",
};
for (const [example, layer] of Object.entries(gallery)) {
  pictures[`gallery_${example}`] = async () => {
    const out = join(work, example);
    const folder = fileURLToPath(new URL(`../../examples/${example}`, import.meta.url));
    const plan = layer === "hazard_zones" ? ["--plan", join(folder, "plan.toml")] : [];
    execFileSync(talus, [plan.length ? "ensemble" : "run", join(folder, "scene.toml"), ...plan, "-o", out], { env: programEnvironment, stdio: "ignore" });
    const page = await browser.newPage({ viewport: { width: 720, height: 900 } });
    page.setDefaultTimeout(180_000);
    await page.goto(pathToFileURL(join(out, "report.html")).href);
    await page.locator(`.tabs button[data-layer^=${layer}]`).first().click();
    await keep(`gallery_${example}`, await blank(), await page.locator(`figure.map[data-layer^=${layer}] > svg`).first().screenshot());
    await page.close();
  };
}
try {
  for (const [name, make] of Object.entries(pictures)) if (only.length === 0 || only.includes(name)) await make();
} finally {
  await browser.close();
  rmSync(work, { recursive: true, force: true });
}
