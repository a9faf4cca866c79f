// The start page: choose a scene, save the session, open it again, go back, end the program.
import { existsSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { assert, coarseGround, limit_ms, serveFrom, shows, startServer, until } from "./harness.mjs";

/** An elevation model as an ASCII grid, which states no reference system: a slope of 60 x 50 cells of 5 m that falls to the west. */
function asciiGrid() {
  const row = Array.from({ length: 60 }, (_, i) => (100 + 2 * i).toFixed(1)).join(" ");
  return ["ncols 60", "nrows 50", "xllcorner 824000", "yllcorner 825000", "cellsize 5", "NODATA_value -9999", ...Array(50).fill(row)].join("\n");
}

/** Lets a file fall onto an element, as the browser tells it. */
async function drop(page, selector, name, content) {
  const data = await page.evaluateHandle(([name, content]) => {
    const data = new DataTransfer();
    data.items.add(new File([content], name));
    return data;
  }, [name, content]);
  await page.dispatchEvent(selector, "dragover", { dataTransfer: data });
  await page.dispatchEvent(selector, "drop", { dataTransfer: data });
}

export async function testStart(run) {
  const folder = mkdtempSync(join(tmpdir(), "talus-start-"));
  const server = await startServer([run.command[0], "start", "--no-browser", "--json", "--folder", folder]);
  run.servers.push(server);
  const context = await run.context({ viewport: { width: 1440, height: 900 } });
  const page = await context.newPage();
  // For the scenes that are opened, as in other tests.
  await coarseGround(page);
  await page.addInitScript(() => localStorage.getItem("talus-look") ?? localStorage.setItem("talus-look", "scientific"));
  context.setDefaultTimeout(limit_ms);
  run.last = page;
  page.on("pageerror", (error) => run.problems.push(error.stack ?? String(error)));
  page.on("request", (request) => /^(data|blob):/.test(request.url()) || run.requests.push(request.url()));
  if (process.env.TALUS_SITE) await serveFrom(page, process.env.TALUS_SITE);
  const { ask } = server;

  await run.check("the start page lists the built-in scene and opens it with the keyboard", async () => {
    await page.goto(server.controller);
    const row = page.locator("[data-scene=sham_tseng]");
    await row.waitFor();
    assert.match(await row.textContent(), /Sham Tseng/);
    assert.match(await page.textContent(".empty"), /session is saved/);
    await row.focus();
    await page.keyboard.press("Enter");
    await shows(page, () => window.talusStats?.frames > 0 && document.querySelector(".transport"), "the first picture");
    assert.match(await page.textContent(".topbar h1"), /Sham Tseng/);
  });

  await run.check("a session is saved with its name, and the start page opens it with the same result", async () => {
    for (let i = 0; i < 3; ++i) await page.click("[aria-label='Step']");
    await until(() => ask("scenarios/A/state"), (s) => s.step === 3, "three steps");
    const hash = (await ask("scenarios/A/state")).hash;
    await page.click("[title^='Save the session']");
    await page.fill("[aria-label='Name of the session']", "Three steps");
    await page.keyboard.press("Enter");
    await until(() => page.locator("dialog[open]").count(), (n) => n === 0, "the dialog closes");
    await page.click("button.wordmark");
    const saved = page.locator("[data-session=three-steps]");
    await saved.waitFor();
    assert.match(await page.textContent(".start-back"), /Back to Sham Tseng/);
    await page.screenshot({ path: join(run.output, "start-1440.png") });
    await saved.click();
    await page.click("dialog .primary");
    await shows(page, () => location.hash === "" && document.querySelector(".transport"), "the saved session");
    assert.equal((await ask("start")).count, 2);
    const state = await ask("scenarios/A/state");
    assert.deepEqual([state.step, state.hash], [3, hash]);
  });

  await run.check("a new scene is made of a dropped terrain and a scar drawn at a zoom, has it where it was drawn, is run, and is downloaded", async () => {
    await page.goto(`http://127.0.0.1:${server.port}/#start`);  // the page loads itself anew
    await page.click("text=New scene");
    await drop(page, "[data-role=terrain]", "not_a_raster.tif", "hello");
    await page.locator(".new-said >> text=not_a_raster.tif: is no raster").waitFor();
    await drop(page, "[data-role=terrain]", "west_slope.asc", asciiGrid());
    await page.locator(".new-problem >> text=states no coordinate reference system").waitFor();
    await page.screenshot({ path: join(run.output, "new-scene-problem.png"), fullPage: true });
    await page.fill("[aria-label='EPSG code of the terrain']", "2326");
    await page.click("[data-role=terrain] >> text=Apply");
    const map = page.locator("canvas.scar-map");
    await map.waitFor();
    await map.scrollIntoViewIfNeeded();
    // Within its border, as positions of clicks are.
    const { width, height } = await map.evaluate((e) => ({ width: e.clientWidth, height: e.clientHeight }));
    const facts = () => page.textContent(".scar-facts");
    // The terrain fits, 300 m x 250 m. Keys draw a square of 80 px around the middle, larger by the zoom of the button.
    const whole = Math.min(width / 300, height / 250);
    await map.focus();
    await page.keyboard.press("+");
    for (const key of ["ArrowRight", "Space", ...Array(5).fill("ArrowRight"), "Space", ...Array(5).fill("ArrowDown"), "Space", ...Array(5).fill("ArrowLeft"), "Space", "Enter"]) await page.keyboard.press(key);
    const drawn = Number((await until(facts, (text) => /in plan/.test(text), "the outline drawn with keys")).match(/Release: ([\d\u202f]+)/)[1].replace("\u202f", ""));
    assert.ok(Math.abs(drawn / (80 / (1.6 * whole)) ** 2 - 1) < 0.02, `${drawn} m² at ${whole} px/m`);
    await page.click("text=Draw again");
    assert.equal(await facts(), "");
    await page.click("[aria-label='Fit to terrain']");
    // The wheel turns around the pointer: the ground below it stays.
    const at = [0.6 * width, 0.45 * height];
    await map.hover({ position: { x: at[0], y: at[1] } });
    await page.mouse.wheel(0, -280);
    const ground = ([u, v], scale) => [824150 + (at[0] - width / 2) / whole + (u - at[0]) / scale, 825125 - (at[1] - height / 2) / whole - (v - at[1]) / scale];
    const corners = [[0.55, 0.4], [0.65, 0.4], [0.65, 0.55], [0.55, 0.55]].map(([u, v]) => [Math.round(u * width), Math.round(v * height)]);
    await map.hover({ position: { x: corners[0][0], y: corners[0][1] } });
    const there = ground(corners[0], Math.exp(0.7) * whole);
    await until(() => page.textContent(".scar-place"), (text) => Math.abs(text.split(", ")[0] - there[0]) < 0.3 && / m · slope 22°/.test(text.replace("\u202f", " ")), `the pointer reads ${there}`);
    for (const [x, y] of [...corners, corners[0]]) await map.click({ position: { x, y } });
    // Its slope is 21.8 degrees, and it falls to the west edge.
    assert.match(await until(facts, (text) => /Flow path/.test(text), "the way downhill"), /slope 22°.*\(mean 21\.\d°\), to the edge of the terrain/);
    await page.locator("text=give its thickness, normal to the slope, or its volume").waitFor();
    assert.equal(await page.inputValue("[aria-label='Title of the scene']"), "west slope");
    await page.click("text=Volume");
    await page.fill("[aria-label='Thickness or volume']", "500");
    await page.keyboard.press("Tab");
    await page.locator(".new-good pre >> text=500 m3").waitFor();
    await page.screenshot({ path: join(run.output, "new-scene.png"), fullPage: true });
    await page.click("text=Create and open");
    await page.click("dialog .primary");
    await shows(page, () => document.querySelector(".topbar h1")?.textContent.includes("west slope") && document.querySelector(".transport"), "the new scene");
    const ring = (await ask("scenarios/A/setup")).releases[0].polygons[0][0];
    for (const corner of corners.map((pixel) => ground(pixel, Math.exp(0.7) * whole))) {
      assert.ok(ring.some(([x, y]) => Math.hypot(x - corner[0], y - corner[1]) < 0.6), `${corner} is none of ${JSON.stringify(ring)}`);
    }
    await page.click("[aria-label='Step']");
    await until(() => ask("scenarios/A/state"), (s) => s.step === 1, "a step of the new scene");
    assert.ok(existsSync(join(folder, "scenes", "west-slope", "scene.toml")));
    await page.click("button.wordmark");
    const [file] = await Promise.all([page.waitForEvent("download"), page.click("[aria-label^='Download west slope']")]);
    assert.equal(file.suggestedFilename(), "west-slope.zip");
  });

  await run.check("an ensemble is started on the page, told before and while it runs, reported, and shown on its scene", async () => {
    await page.goto(`http://127.0.0.1:${server.port}/#start`);
    await page.locator(".start-list").first().waitFor();
    await page.click("[aria-label='Ensemble or calibration of west slope']");
    assert.equal(await page.locator("[aria-label=Scene]").evaluate((e) => e.selectedOptions[0].textContent), "west slope");
    await page.locator("[data-free='release.volume_m3']").waitFor();
    assert.deepEqual([await page.inputValue("[aria-label='Lowest release volume']"), await page.inputValue("[aria-label='Highest release volume']")], ["375", "625"]);
    await page.locator(".job-time >> text=/64 runs with .* particles: about .* on this computer/").waitFor();
    await page.fill("[aria-label='Lowest friction coefficient']", "0.5");
    await page.fill("[aria-label='Highest friction coefficient']", "0.3");
    await page.click(".new-job >> text=Start");
    await page.locator(".field-note >> text=0.5 must be below 0.3").waitFor();
    await page.fill("[aria-label='Lowest friction coefficient']", "0.2");
    await page.fill("[aria-label='Number of runs']", "3");
    await page.screenshot({ path: join(run.output, "new-job.png"), fullPage: true });
    await page.click(".new-job >> text=Start");
    const job = page.locator("[data-job=ensemble-1]");
    await job.waitFor();
    await page.locator("[data-job=ensemble-1][data-state=done]").waitFor();
    assert.match(await job.textContent(), /Ensemble · west slope\s*3 runs/);
    await job.locator("summary").click();
    assert.match(await job.textContent(), /talus ensemble .*west-slope.scene\.toml --vary .*--runs 3 --design latin_hypercube --output .*ensemble-1/);
    const [report] = await Promise.all([context.waitForEvent("page"), job.getByText("Report").click()]);
    await report.locator("h1").waitFor();
    assert.match(await report.textContent("body"), /3 runs|3 of 3/);
    await report.close();
    await page.screenshot({ path: join(run.output, "jobs-1440.png"), fullPage: true });
    await job.getByText("Show on the scene").click();
    await page.click("dialog .primary");
    await shows(page, () => location.hash === "" && document.querySelector(".transport"), "the scene of the ensemble");
    await until(() => ask("ensembles"), ({ ensembles }) => ensembles?.length === 1 && ensembles[0].runs === 3, "the ensemble is among the maps");
  });

  await run.check("a calibration and a validation are started, one waits for the other, one is cancelled, continued and cancelled again, and the other is deleted", async () => {
    await page.goto(`http://127.0.0.1:${server.port}/#start`);
    await page.locator(".start-list").first().waitFor();
    await page.click("text=New job");
    await page.selectOption("[aria-label=Scene]", { label: "west slope" });
    await page.click(".new-job >> text=Calibration");
    await page.locator(".new-job >> text=no field observations").waitFor();
    assert.ok(await page.isDisabled(".new-job .primary"), "there is nothing to calibrate against");
    await page.selectOption("[aria-label=Scene]", "sham_tseng");
    await page.locator(".new-job >> text=/Observed: Debris speed/").waitFor();
    await page.click(".new-job .primary");
    await page.locator("[data-job=calibration-1][data-state=running]").waitFor();
    await page.click("text=New job");
    await page.click(".new-job >> text=Validation");
    await page.locator(".job-time >> text=about 40 minutes").waitFor();
    await page.click(".new-job >> text=Chosen cases");
    await page.locator("[data-case=free_fall]").check();
    await page.click(".new-job .primary");
    const waiting = page.locator("[data-job=validation-1]");
    await waiting.locator("text=Waiting for another job").waitFor();
    await page.click("[data-job=calibration-1] >> text=Cancel");
    await page.locator("[data-job=calibration-1][data-state=cancelled]").waitFor();
    await page.locator("[data-job=validation-1][data-state=done]").waitFor();
    assert.match(await waiting.textContent(), /values pass, 0 fail/);
    await page.click("[data-job=calibration-1] >> text=Continue");
    await page.locator("[data-job=calibration-1][data-state=running]").waitFor();
    await page.click("[data-job=calibration-1] >> text=Cancel");
    await page.locator("[data-job=calibration-1][data-state=cancelled]").waitFor();
    await waiting.locator("[aria-label^=Delete]").click();
    await page.click("dialog .primary");
    await until(() => waiting.count(), (n) => n === 0, "the validation is gone");
    assert.ok(!existsSync(join(folder, "jobs", "validation-1")));
    assert.ok(existsSync(join(folder, "jobs", "calibration-1")));
  });

  await run.check("on a phone nothing is wider than the screen, a viewer sees no files, and talus is ended on the page", async () => {
    const eye = await context.newPage();
    await eye.goto(`${server.viewer.replace("#", "?watch#")}`);
    await shows(eye, () => document.querySelector(".transport"), "the viewer's page");
    assert.equal(await eye.locator(".wordmark").evaluate((e) => e.tagName), "SPAN");
    await eye.close();
    await page.setViewportSize({ width: 390, height: 844 });
    await page.goto(`http://127.0.0.1:${server.port}/#start`);  // the page loads itself anew
    await page.locator("[data-job=ensemble-1]").waitFor();
    assert.ok(await page.evaluate(() => [...document.querySelectorAll("button, p, h1, li")].every((e) => e.getBoundingClientRect().right <= innerWidth + 1)), "nothing is cut off");
    await page.screenshot({ path: join(run.output, "start-390.png") });
    await page.click("text=End talus");
    await page.click("dialog .primary");
    await page.locator("text=talus has ended").waitFor();
    assert.equal(await server.end(), 0);
  });
  await context.close();
  rmSync(folder, { recursive: true, force: true });
}
