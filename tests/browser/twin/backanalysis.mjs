// Maps of an ensemble on the terrain, and a calibration started from the page; on servers of their own with few particles.
import { spawnSync } from "node:child_process";
import { cpSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { basename, dirname, join, resolve } from "node:path";
import { assert, inControl, until, viewClip, programEnvironment } from "./harness.mjs";

const particles = 400;
const layerSelect = "select[aria-label^='Map layer']";

export async function testBackanalysis(run) {
  const folder = join(run.output, "ensemble of friction");
  rmSync(folder, { recursive: true, force: true });
  const made = spawnSync(run.command[0], ["ensemble", run.scene, "--set", `solver.target_particle_count=${particles}`, "--vary", "material.friction_coefficient=0.25:0.5",
    "--runs", "6", "--return-period", "50", "-o", folder, "--quiet"], { env: programEnvironment });
  assert.equal(made.status, 0, String(made.stderr));
  const server = await run.start(["--ensemble", folder], { particles });
  const page = await run.open(server.controller, { name: "Ada" });
  await inControl(page);
  await testMaps(run, page);
  await testCalibration(run, server, page);
  await page.context().close();
  await server.stop();
  await testNoObservations(run);
}

async function testMaps(run, page) {
  await run.check("maps of an ensemble are layers with title, unit, threshold and number of runs", async () => {
    const group = page.locator(`${layerSelect} optgroup:not(.depth-averaged)`);
    await until(() => group.count(), (n) => n === 1, "a group of layers");
    assert.equal(await group.getAttribute("label"), "Ensemble ensemble of friction, 6 runs");
    await page.locator("label:has-text('Particles') input").uncheck();
    await page.click("[aria-label='Top view']");
    const clip = await viewClip(page);
    const bare = await run.still(page, clip);
    const legend = page.locator(".legend").last();
    const seen = new Set([bare.hash]);
    for (const [name, title, unit] of [["probability_depth_0.5m", "Probability of peak depth over 0.5 m", "%"], ["probability_speed_10mps", "Probability of peak speed over 10 m/s", "%"],
      ["peak_depth_p95", "Peak depth, 95th percentile", "m"], ["peak_pressure_p50", "Peak dynamic pressure, 50th percentile", "kPa"], ["arrival_time_p05", "Arrival time, 5th percentile", "s"],
      ["probability_intensity_high", "Probability of high intensity", "%"], ["hazard_zones", "Hazard zones", null]]) {
      await page.selectOption(layerSelect, `ensemble/1/${name}`);
      await until(() => legend.locator(".legend-title b").textContent(), (t) => t === title, `legend of ${name}`);
      if (unit !== null) assert.equal(await legend.locator(".legend-title span").textContent(), unit);
      else assert.deepEqual(await legend.locator(".legend-category").allTextContents(), ["high (red)", "medium (blue)", "low (yellow)", "residual (yellow-white)"]);
      assert.equal(await legend.locator(".legend-from").textContent(), "ensemble of friction, 6 runs");
      seen.add((await run.changed(page, clip, [...seen], name)).hash);
      await run.shot(page, `30-${name}`);
    }
    assert.equal(seen.size, 8, "different pictures");
    await page.selectOption(layerSelect, "none");
    await run.back(page, clip, bare, "the ground without a layer");
    await page.locator("label:has-text('Particles') input").check();
  });
}

async function testCalibration(run, server, page) {
  const setup = () => server.ask("scenarios/A/setup");
  const status = () => server.ask("calibration");
  const viewer = await run.open(server.viewer, { name: "Cy" });
  await run.check("a calibration: dots come in beside the live run, everybody sees them, the best values can be used and undone", async () => {
    await page.click("[data-tab=calibrate]");
    await viewer.click("[data-tab=calibrate]");
    assert.ok(await viewer.locator(".calibrate-form button.primary").isDisabled(), "a viewer cannot start");
    await run.shot(page, "31-calibrate");
    await page.locator("[aria-label='Lowest friction coefficient']").fill("0.6");
    await page.click(".calibrate-form button.primary");
    assert.match(await page.textContent(".calibrate-form .field-note"), /must be below/);
    await page.locator("[aria-label='Lowest friction coefficient']").fill("0.2");
    await page.locator("[aria-label='Runs at most']").fill("16");
    await page.click(".run");
    await page.click(".calibrate-form button.primary");
    await until(() => page.locator(".misfit circle.run").count(), (n) => n >= 2, "dots");
    await until(() => viewer.locator(".misfit circle.run").count(), (n) => n >= 2, "dots for the viewer");
    assert.ok((await server.ask("scenarios/A/state")).step > 0, "the live run goes on");
    await run.shot(page, "32-dots");
    await until(() => page.locator("canvas.misfit-field").isVisible(), (v) => v, "the field");
    await run.shot(page, "33-field");
    const end = await until(status, (s) => !["running", "cancelling"].includes(s.state), "the end");
    assert.equal(end.state, "done", end.message);
    await until(() => page.locator(".misfit circle.run").count(), (n) => n === end.runs.length, "all dots");
    await page.locator("table.found").waitFor();
    await run.shot(page, "34-done");
    assert.match(await page.textContent(".calibrate-progress"), /16 runs/);
    assert.ok(await viewer.locator(".calibrate button:has-text('Use these values')").isDisabled());
    const before = (await setup()).parameters;
    await page.click(".calibrate button:has-text('Use these values')");
    const close = (p) => Math.abs(p["material.friction_coefficient"] / end.best.values[0] - 1) < 1e-3 && Math.abs(p["material.viscosity"] / end.best.values[1] - 1) < 1e-3;
    await until(async () => (await setup()).parameters, close, "the values in the setup");
    await page.locator(".calibrate button:has-text('Use these values')").scrollIntoViewIfNeeded();
    await run.shot(page, "35-used");
    await page.click(".controls button:has-text('Undo')");
    await until(async () => JSON.stringify((await setup()).parameters), (p) => p === JSON.stringify(before), "one undo takes both back");
  });
  await run.check("a calibration with the depth-averaged model, which can be cancelled, by keyboard too", async () => {
    await page.locator("label:has-text('Search with the depth-averaged model') input").check();
    assert.equal(await page.inputValue("[aria-label='Runs at most']"), "16", "what was typed before");
    await run.shot(page, "35b-two-models");
    await page.locator(".calibrate-form button.primary").focus();
    await page.keyboard.press("Enter");
    const focused = () => page.evaluate(() => document.activeElement.textContent);
    await until(focused, (text) => text === "Cancel", "the focus goes on to what takes the place of the button");
    assert.equal((await status()).state, "running");
    await until(() => page.textContent(".calibrate-progress"), (t) => /^\d+ of at most 100 runs depth-averaged, 0 of at most 16 runs of particles/.test(t), "both models are counted");
    await until(async () => (await status()).fast_runs.length, (n) => n >= 2, "runs of the fast model");
    assert.equal((await status()).runs.length, 0, "particles wait for the fast model's design");
    await page.keyboard.press("Enter");
    const end = await until(async () => (await status()).state, (state) => state !== "running" && state !== "cancelling", "an end");
    assert.equal(end, "cancelled");
    await until(() => page.textContent(".calibrate-progress"), (t) => t.startsWith("Cancelled"), "the page says so");
    await until(focused, (text) => text === "Start", "the focus comes back");
  });
  await viewer.context().close();
}

async function testNoObservations(run) {
  const copy = join(run.output, "scene without observations");
  cpSync(dirname(resolve(run.scene)), copy, { recursive: true });
  const file = join(copy, basename(run.scene));
  const text = readFileSync(run.scene, "utf8").split(/^(?=\[)/m).filter((section) => !section.startsWith("[[observation]]")).join("");
  writeFileSync(file, text);
  const server = await run.start([], { scene: file, particles });
  const page = await run.open(server.controller, { name: "Di" });
  await run.check("a scene without observations says what is missing", async () => {
    await page.click("[data-tab=calibrate]");
    await until(() => page.textContent(".calibrate-why"), (t) => t.includes("no field observations"), "why not");
    assert.ok(!(await page.locator(".calibrate-form").isVisible()));
    await run.shot(page, "36-no-observations");
  });
  await page.context().close();
  await server.stop();
}
