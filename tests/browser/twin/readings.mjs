// What is read from a scenario: layers, camera, charts, probes, sections, impacts, recording, exports, comparison.
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { assert, boxOf, clickGround, inControl, pause, saved, shownTime, until, unzipped, viewClip } from "./harness.mjs";

/** While one looks back, charts, mass balance, map layers and impacts are those of the time on display. */
async function readPast(page, server, last) {
  const time = await shownTime(page);
  const series = await server.ask("scenarios/A/series");
  const rows = series.time.time_s.filter((t) => t <= time).length;
  const reached = Math.max(...series.front.chainage_m.filter((_, k) => series.front.arrival_time_s[k] <= time));
  assert.ok(rows < series.time.time_s.length && reached < Math.max(...series.front.chainage_m));
  await page.click("[data-tab=front]");
  const arrival = page.locator(".tab-panel:visible .chart-plot:visible").nth(1);
  await until(() => arrival.getAttribute("aria-label"), (t) => Number(/Arrival from .* to ([\d.]+)/.exec(t ?? "")?.[1]) <= time + 0.01, "arrivals until then");
  await page.click("[data-tab=balance]");
  // The time that is told is rounded: a row that is as near as that may count or not.
  const moving = [-0.006, 0.006].map((by) => series.time.volume_moving_m3[series.time.time_s.filter((t) => t <= time + by).length - 1].toFixed(1));
  await until(() => page.textContent(".tab-panel:visible"), (t) => t.includes(`Mass balance at ${time.toFixed(2)} s`) && moving.some((v) => t.includes(`${v} m³`)), `${moving[0]} m3 moving`);
  await page.click("[data-tab=impact]");
  const impacts = await server.ask(`scenarios/A/impacts?time_s=${time}`);
  await until(() => page.textContent(".tab-panel:visible"), (t) => t.includes(`As of ${time.toFixed(1)} s.`), "impacts of then");
  const untouched = await page.locator(".impacts").last().locator("tbody tr.untouched").count();
  assert.equal(untouched, impacts.buildings.filter((b) => !b.hit).length);
  const { gauges } = await server.ask(`scenarios/A/gauges?time_s=${time}`);
  assert.deepEqual(await page.locator(".gauges tbody td:nth-child(2)").allTextContents(), gauges.map((g) => (g.arrival_s === null ? "–" : g.arrival_s.toFixed(1))));
  const legend = page.locator(".legend").last();
  for (const [layer, words] of [["peak_depth", "Peak depth until"], ["depth", "Depth at"], ["arrival_time", "Arrival time until"]]) {
    await page.selectOption("select[aria-label^='Map layer']", layer);
    await until(() => legend.textContent(), (t) => t.startsWith(`${words} ${time.toFixed(1)} s`), `legend of ${layer}`);
  }
  await page.selectOption("select[aria-label^='Map layer']", "none");
  assert.ok(time < last);
}

/** In the open dialog of exports: the moving flow as one file, then several as a ZIP. */
async function exportFlow(page, server) {
  const flow = page.locator("dialog .flow-export");
  const summary = flow.locator(".flow-summary");
  await until(() => summary.textContent(), (text) => /^\d+ frames from 0 to [\d.]+ s, 1 s apart; about [\d.]+\s(kB|MB)\.$/.test(text), "what it will contain");
  await flow.getByLabel("Seconds between frames").fill("2");
  await flow.getByLabel("Seconds between frames").press("Tab");
  await until(() => summary.textContent(), (text) => /, 2 s apart/.test(text), "fewer frames");
  await flow.locator("button:has-text('Write files')").click();
  const one = flow.locator("button:has-text('Save run.glb')");
  await one.waitFor();
  assert.match(await flow.locator(".flow-told").textContent(), /^Written: run\.glb, /);
  const glb = await saved(page, () => one.click());
  assert.match(glb.name, /-A\.glb$/);
  assert.equal(glb.bytes.subarray(0, 4).toString(), "glTF");
  const described = JSON.parse(glb.bytes.subarray(20, 20 + glb.bytes.readUInt32LE(12)).toString());
  const { frames } = await server.ask("scenarios/A/flow?interval_s=2");
  assert.equal(described.meshes.filter(({ name }) => name.startsWith("debris")).length, frames);
  await flow.locator("label:has-text('3D Tiles') input").check();
  await flow.locator("button:has-text('Write files')").click();
  const both = flow.locator("button:has-text('Save 2 files as ZIP')");
  await both.waitFor();
  const members = unzipped((await saved(page, () => both.click())).bytes);
  assert.deepEqual(Object.keys(members).sort(), ["run.glb", "tileset.json"]);
  assert.equal(JSON.parse(members["tileset.json"].toString()).root.content.uri, "run.glb");
}

export async function testReadings(run) {
  // It ends by itself at the same time on every machine.
  const server = await run.start(["--set", "solver.end_time_s=12"]);
  const page = await run.open(server.controller, { name: "Ben" });
  const state = () => server.ask("scenarios/A/state");
  await inControl(page);
  await page.selectOption("select[aria-label^=Speed]", "");
  await page.click(".run");
  const { time_s } = await until(state, (s) => s.status === "ended", "the run");
  await until(() => shownTime(page), (t) => Math.abs(t - time_s) < 0.01, "its time on the page");
  const clip = await viewClip(page);

  await run.check("each map layer looks like itself, with title and unit in its legend", async () => {
    const seen = new Map();
    const units = { depth: "m", peak_depth: "m", peak_speed: "m/s", peak_pressure: "kPa", arrival_time: "s", deposit_depth: "m" };
    await page.locator("label:has-text('Particles') input").uncheck();
    for (const [layer, unit] of Object.entries(units)) {
      await page.selectOption("select[aria-label^='Map layer']", layer);
      const legend = page.locator(".legend").last();
      const title = await page.locator(`select[aria-label^='Map layer'] option[value=${layer}]`).textContent();
      await until(() => legend.textContent(), (t) => t.startsWith(title), "legend");
      assert.equal(await legend.locator(".legend-title span").textContent(), unit);
      seen.set(layer, (await run.still(page, clip)).hash);
      if (layer === "peak_speed") await run.shot(page, "5-peak-speed");
    }
    // Depth now and deposit depth may be one picture when all is at rest.
    assert.ok(new Set(seen.values()).size >= 5, `${new Set(seen.values()).size} different pictures of 6 layers`);
    await page.selectOption("select[aria-label^='Map layer']", "none");
    assert.ok(![...seen.values()].includes((await run.still(page, clip)).hash), "no layer looks like one");
  });

  await run.check("debris as a surface by depth and by speed, and as particles", async () => {
    const pictures = new Set();
    for (const [particles, surface] of [[false, "off"], [false, "depth"], [false, "speed"], [true, "off"]]) {
      await page.locator("label:has-text('Particles') input").setChecked(particles);
      await page.selectOption("select[aria-label^='Debris as']", surface);
      pictures.add((await run.still(page, clip)).hash);
      if (surface === "depth") await run.shot(page, "6-surface");
    }
    assert.equal(pictures.size, 4);
    await page.locator("label:has-text('Contours') input").uncheck();
    assert.ok(!pictures.has((await run.still(page, clip)).hash), "contours make no difference");
    await page.locator("label:has-text('Contours') input").check();
  });

  await run.check("camera: top, whole scene, arrow keys, fly, follow, saved view", async () => {
    const picture = async () => (await run.still(page, clip)).hash;
    await page.click("[aria-label='Fit']");
    const whole = await picture();
    await page.click("[aria-label='Save this view']");
    await page.click("[aria-label='Top view']");
    const top = await picture();
    assert.notEqual(top, whole, "top view");
    assert.match(await page.locator(".needle").evaluate((e) => e.style.transform), /rotate\(-?0(\.0\d*)?rad\)|e-/);
    await run.shot(page, "7-top");
    await page.locator("select.saved").selectOption("1");
    assert.equal(await picture(), whole, "the saved view");
    await page.locator(".stage canvas").focus();
    await page.keyboard.press("ArrowLeft");
    const turned = await picture();
    assert.notEqual(turned, whole, "turned by key");
    await page.keyboard.press("2");
    assert.equal(await page.getAttribute("[data-mode=fly]", "aria-pressed"), "true");
    const frames = () => page.evaluate(() => window.talusStats.frames);
    const first = await frames();
    await page.keyboard.down("w");
    await until(frames, (n) => n > first + 2, "pictures while flying");
    await page.keyboard.up("w");
    assert.notEqual(await picture(), turned, "flying");
    await page.keyboard.press("3");
    assert.equal(await page.getAttribute("[data-mode=follow]", "aria-pressed"), "true");
    await page.keyboard.press("1");
    await page.click("[aria-label='Fit']");
  });

  await run.check("on slow graphics what moves has fewer pixels, and what stands still has all of them", async () => {
    const ratio = () => page.evaluate(() => window.talusStats.pixelRatio);
    const full = await page.evaluate(() => Math.min(2, devicePixelRatio));
    await until(ratio, (r) => r === full, "all pixels at rest");
    // Slow graphics, on whatever machine: a picture every tenth of a second at most.
    await page.evaluate(() => {
      const ask = (window.askForPicture = window.requestAnimationFrame);
      window.requestAnimationFrame = (draw) => setTimeout(() => ask.call(window, draw), 100);
    });
    await page.locator(".stage canvas").focus();
    await page.keyboard.press("2");
    await page.keyboard.down("s");
    await until(ratio, (r) => r < full, "fewer pixels");
    await page.keyboard.up("s");
    await until(ratio, (r) => r === full, "all pixels again");
    await page.evaluate(() => (window.requestAnimationFrame = window.askForPicture));
    await page.keyboard.press("1");
    await page.click("[aria-label='Fit']");
  });

  await run.check("readings are tabs for mouse and arrow keys; front and time charts have curves", async () => {
    await page.click("[data-tab=front]");
    const chart = page.locator(".tab-panel:visible .chart-plot").first();
    await until(() => chart.getAttribute("aria-label"), (t) => /Front.* from .* m\/s/.test(t ?? ""), "front velocities");
    assert.match(await chart.getAttribute("aria-label"), /Field, debris speed from .* m\/s/);
    const seen = await run.colours(page, await boxOf(chart));
    assert.ok(seen.different > 40, `${seen.different} colours in the chart`);
    await page.keyboard.press("ArrowRight");
    assert.equal(await page.locator("[role=tab][aria-selected=true]").getAttribute("data-tab"), "time");
    const labels = await until(() => page.locator(".tab-panel:visible .chart-plot:visible").evaluateAll((l) => l.map((e) => e.getAttribute("aria-label"))), (l) => l.length === 4 && l.every(Boolean), "four charts");
    for (const words of [/Moving from .* m³/, /speed from .* m\/s/, /Kinetic from .* MJ/, /marks in the gully from 0 to .* m/]) assert.ok(labels.some((l) => words.test(l)), `${words} in ${labels}`);
    await run.shot(page, "8-time");
  });

  await run.check("probes by click: curves of depth, speed and pressure", async () => {
    await page.click("[data-tab=points]");
    await page.click("button:has-text('Put a probe')");
    await clickGround(page, 0.5, 0.42);
    await clickGround(page, 0.45, 0.5);
    await page.click("button:has-text('Put a probe')");
    assert.equal(await page.locator("li.probe").count(), 2);
    const asked = await until(() => page.locator(".tab-panel:visible .chart-plot:visible").count(), (n) => n === 3, "three charts of the points");
    assert.equal(asked, 3);
    await until(() => page.locator("li.probe").first().textContent(), (t) => /peaks .*kPa/.test(t), "peaks");
    assert.equal(await page.locator(".label.probe").count(), 2);
    await run.shot(page, "9-probes");
    await page.click("[aria-label='Remove probe 1']");
    assert.equal(await page.locator("li.probe").count(), 1);
  });

  await run.check("a cross-section by two clicks: ground, debris now, peak", async () => {
    await page.click("[data-tab=section]");
    await page.click("button:has-text('Draw a section')");
    await clickGround(page, 0.35, 0.4);
    await clickGround(page, 0.65, 0.4);
    const chart = page.locator(".tab-panel:visible .chart-plot").first();
    await until(() => chart.getAttribute("aria-label"), (t) => /Ground from 0 to .* m/.test(t ?? ""), "ground");
    assert.match(await page.locator(".tab-panel:visible .measure").textContent(), /m long/);
    await run.shot(page, "10-section");
    await page.locator(".tab-panel:visible button:has-text('Remove')").click();
  });

  await run.check("a measurement by clicks: distance, height, slope and area, and the profile of its line", async () => {
    await page.click("[aria-label='Top view']");
    await page.click("[aria-label='Measure']");
    const box = await boxOf(page.locator(".stage canvas"));
    const places = [];
    for (const [u, v] of [[0.42, 0.55], [0.5, 0.6], [0.44, 0.68]]) {
      await page.mouse.move(box.x + u * box.width, box.y + v * box.height);
      const told = await until(() => page.textContent(".read-out"), (t) => /E [\d.]+ {2}N [\d.]+ {2}ground/.test(t) && t !== places.at(-1)?.told, "place of the pointer");
      const [, east, north, ground] = /E ([\d.]+) {2}N ([\d.]+) {2}ground ([\d.]+)/.exec(told);
      places.push({ told, east: Number(east), north: Number(north), ground: Number(ground) });
      await page.mouse.click(box.x + u * box.width, box.y + v * box.height);
    }
    await page.keyboard.press("Enter");
    const [a, b, c] = places;
    const near = (value, wanted, by, what) => assert.ok(Math.abs(value - wanted) <= by, `${what}: ${value}, not ${wanted}`);
    const text = (await until(() => page.textContent(".measuring"), (t) => /Area inside/.test(t), "the area")).replace(/(?<=\d)\s(?=\d)/g, "");
    const distance = Math.hypot(b.east - a.east, b.north - a.north) + Math.hypot(c.east - b.east, c.north - b.north);
    near(Number(/Distance([\d.]+)/.exec(text)?.[1]), distance, 1 + 0.01 * distance, "distance");
    near(Number(/Height difference([+−]?[\d.]+)/.exec(text)?.[1].replace("−", "-")), c.ground - a.ground, 0.3, "height difference");
    near(Number(/Area inside([\d.]+)/.exec(text)?.[1]), Math.abs((b.east - a.east) * (c.north - a.north) - (c.east - a.east) * (b.north - a.north)) / 2, 0.02 * distance ** 2, "area");
    assert.match(text, /Slope[\d.]+° end to end, up to \d+°/);
    await page.click(".measuring button:has-text('Profile')");
    const chart = page.locator(".tab-panel:visible .chart-plot").first();
    await until(() => chart.getAttribute("aria-label"), (t) => /Ground from 0 to .* m/.test(t ?? ""), "profile");
    await run.shot(page, "10-measure");
    await page.click(".measuring button:has-text('Remove')");
    await page.locator(".measuring").waitFor({ state: "hidden" });
    await page.locator(".tab-panel:visible button:has-text('Remove')").click();
    await page.click("[aria-label='Orbit']");
    await page.click("[aria-label='Fit']");
  });

  await run.check("impacts: sorted by a click on the head, a row leads to its house; classes have their thresholds", async () => {
    await page.click("[data-tab=impact]");
    const scene = await server.ask("scene");
    assert.equal(await page.locator(".classes li").count(), scene.intensity.classes.length);
    assert.ok((await page.locator(".tab-panel:visible").textContent()).includes(scene.intensity.rule));
    const names = () => page.locator(".impacts").last().locator("tbody th").allTextContents();
    if ((await server.ask("scenarios/A/impacts")).buildings.length > 1) {
      await page.locator(".impacts").last().locator("thead button").first().click();
      const up = await names();
      assert.deepEqual(up, [...up].sort((a, b) => (a < b ? -1 : 1)));
      await page.locator(".impacts").last().locator("thead button").first().click();
      assert.deepEqual(await names(), [...up].reverse());
      const before = await run.still(page, clip);
      await page.locator(".impacts").last().locator("tbody th button").first().click();
      await until(async () => (await run.picture(page, clip)).hash, (hash) => hash !== before.hash, "the view moves");
      await page.selectOption("select[aria-label='Colour of houses']", "pressure");
      await run.shot(page, "11-impact");
      await page.click("[aria-label='Fit']");
    }
  });

  await run.check("gauges: a row each with what the server says, now and in the past, and a name in the view", async () => {
    const rows = () => page.locator(".gauges tbody tr").evaluateAll((list) => list.map((tr) => [...tr.children].map((cell) => cell.textContent)));
    const told = async () => (await server.ask("scenarios/A/gauges")).gauges.map((g) => [g.name, g.arrival_s === null ? "–" : g.arrival_s.toFixed(1), g.depth_m.toFixed(2), g.peak_depth_m.toFixed(2), g.peak_speed_mps.toFixed(1)]);
    const wanted = await told();
    assert.ok(wanted.length === 3 && Number(wanted[0][3]) > 0.3, wanted.join("; "));
    await until(rows, (list) => list.join() === wanted.join(), wanted.join());
    // Names make room for the mark of the front, which stands beside a gauge.
    const hidden = await page.evaluate(() => [...document.querySelectorAll(".front-mark:not([hidden])")].map((mark) => (mark.hidden = true)).length);
    await page.click("[aria-label='Top view']");
    await run.still(page, clip);
    // Also where a front velocity was observed at the same place.
    assert.deepEqual((await page.locator(".label.gauge:not(.off)").allTextContents()).sort(), wanted.map(([name]) => name).sort(), "names in the plan");
    await run.shot(page, "11-gauges");
    assert.equal(hidden, 1);
    await page.evaluate(() => (document.querySelector(".pane .front-mark").hidden = false));
    await page.keyboard.press("1");
    await page.click("[aria-label='Fit']");
  });

  await run.check("mass balance adds up, and the numbers of the run have units", async () => {
    await page.click("[data-tab=balance]");
    const s = await state();
    await until(() => page.locator(".tab-panel:visible").textContent(), (text) => text.includes(`${s.volume_moving_m3.toFixed(1)} m³`) && text.includes(s.hash), "volume and hash");
    const card = await page.textContent(".run-card");
    for (const words of [/Largest speed.*m\/s/, /Steps.*\/s/, /Real time.*×/, /ompress/]) assert.match(card, words);
    // The verdict is one line; what each check says lies over the readings and moves nothing.
    const { verdict } = await state();
    const tabs = page.locator("[data-tab=balance]"), list = page.locator(".verdict ul"), stood = await boxOf(tabs);
    assert.match(verdict.text, verdict.within_limits ? /^Within limits$/ : /^Beyond limits: [a-z]/);
    assert.equal(await page.textContent(".verdict summary"), verdict.text);
    await page.click(".verdict summary");
    await list.waitFor();
    for (const check of verdict.checks) assert.ok((await list.textContent()).includes(check.text), check.text);
    assert.deepEqual(await boxOf(tabs), stood, "the tabs stay where they were");
    await run.shot(page, "11-verdict");
    await page.mouse.click(stood.x, 700);
    await until(() => list.isVisible(), (seen) => !seen, "a click beside the list puts it away");
  });

  await run.check("scrubbing shows earlier times, playback plays them, live returns", async () => {
    const now = await run.still(page, clip);
    const last = (await state()).recording.last_s;
    const slider = page.locator("input.timeline");
    const box = await boxOf(slider);
    const end = (await state()).end_time_s;
    await page.mouse.click(box.x + 7 + (box.width - 14) * (0.3 * last / end), box.y + box.height / 2);
    await until(() => shownTime(page), (t) => Math.abs(t - 0.3 * last) < 0.1 * last + 0.3, "an earlier time");
    await until(async () => (await run.picture(page, clip)).hash, (hash) => hash !== now.hash, "another view than that of now");
    assert.match(await page.textContent(".status"), /Playback/);
    const from = await shownTime(page);
    await slider.focus();
    await page.keyboard.press("ArrowLeft");
    await until(() => shownTime(page), (t) => t < from, "by key");
    await readPast(page, server, last);
    await page.click("[aria-label='Play the recording']");
    await until(() => shownTime(page), (t) => t > from + 0.5, "playback");
    await page.click("[aria-label='Pause the recording']");
    await page.click(".live");
    await until(() => shownTime(page), (t) => Math.abs(t - last) < 0.5, "live time");
    await run.back(page, clip, now, "the live view");
  });

  await run.check("exports: what is ticked in one ZIP, a picture, a video", async () => {
    await page.click("button:has-text('Export')");
    const all = page.locator("dialog label:has-text('All files') input");
    await all.check();
    await all.uncheck();
    assert.equal(await page.isDisabled("dialog button:has-text('as ZIP')"), true);
    for (const name of ["front.csv", "journal.json", "view.png"]) await page.locator(`dialog label:text-is('${name}') input`).check();
    await run.shot(page, "12-export");
    const files = await saved(page, () => page.click("dialog button:has-text('Save 3 files as ZIP')"));
    assert.match(files.name, /-A\.zip$/);
    const members = unzipped(files.bytes);
    assert.deepEqual(Object.keys(members), ["front.csv", "journal.json", "view.png"]);
    assert.equal(members["front.csv"].toString(), await server.text("scenarios/A/exports/front.csv"), "the file of the server");
    assert.ok(JSON.parse(members["journal.json"].toString()));
    assert.equal(members["view.png"].subarray(1, 4).toString(), "PNG");
    await exportFlow(page, server);
    await page.keyboard.press("Escape");
    assert.equal(await page.locator("dialog[open]").count(), 0);
    const picture = await saved(page, () => page.click("[aria-label='Picture']"));
    assert.match(picture.name, /\.png$/);
    assert.equal(picture.bytes.subarray(1, 4).toString(), "PNG");
    writeFileSync(join(run.output, "picture.png"), picture.bytes);
    assert.ok(picture.bytes.length > 30_000, `${picture.bytes.length} bytes: blank?`);
    await page.click("[aria-label='Record a video']");
    const pictures = () => page.evaluate(() => window.talusStats.frames);
    const first = await pictures();
    await until(pictures, (n) => n > first + 10, "pictures for the video");
    const video = await saved(page, () => page.click("[aria-label='End the video and save it']"));
    assert.match(video.name, /\.webm$/);
    assert.equal(video.bytes.readUInt32BE(0), 0x1a45dfa3);
    assert.ok(video.bytes.length > 5000, `${video.bytes.length} bytes`);
  });

  await run.check("two scenarios: own controls, one camera, difference map, and back to one", async () => {
    await page.click("button:has-text('Compare')");
    await page.locator(".pane[data-scenario=B]").waitFor();
    await until(() => page.getAttribute("button[data-scenario=B]", "aria-pressed"), (v) => v === "true", "controls of B");
    const friction = page.locator(".field", { hasText: "riction" }).first().locator("input[type=number]");
    const a = (await server.ask("scenarios/A/setup")).parameters["material.friction_coefficient"];
    await friction.fill("0.3");
    await friction.press("Enter");
    await until(() => server.ask("scenarios/B/setup"), (s) => s.parameters["material.friction_coefficient"] === 0.3, "friction of B");
    assert.equal((await server.ask("scenarios/A/setup")).parameters["material.friction_coefficient"], a);
    await page.click(".run"); // A has ended: B alone runs
    await until(() => server.ask("scenarios/B/state"), (s) => s.time_s > 6, "B runs");
    await pause(page, () => server.ask("scenarios/B/state"));
    const left = await run.still(page, await viewClip(page, "A"));
    const right = await run.still(page, await viewClip(page, "B"));
    assert.ok(left.different > 800 && right.different > 800, `${left.different} and ${right.different} colours`);
    assert.notEqual(left.hash, right.hash, "both views are alike");
    await page.selectOption("select[aria-label^='Map layer']", "peak_depth");
    const each = await run.changed(page, await viewClip(page, "B"), [right.hash], "the layer");
    await page.locator("label:has-text('B − A') input").check();
    await until(() => page.locator(".legend").last().textContent(), (t) => t.includes("B − A"), "legend of the difference");
    await run.changed(page, await viewClip(page, "B"), [each.hash], "another look than that of the layer");
    await run.shot(page, "13-compare");
    await page.click("button[data-scenario=A]");
    assert.equal(await friction.inputValue(), String(a));

    // On a screen that is higher than wide, one is above the other, and a click finds the view that it is in.
    const before = page.viewportSize();
    await page.setViewportSize({ width: 390, height: 844 });
    const box = (name) => page.locator(`.pane[data-scenario=${name}]`).boundingBox();
    const lower = await until(() => box("B"), ({ x, width }) => x === 0 && width === 390, "the whole width");
    const upper = await box("A");
    assert.ok(upper.width === 390 && lower.y >= upper.y + upper.height - 1, JSON.stringify([upper, lower]));
    const [above, below] = [await run.still(page, await viewClip(page, "A")), await run.still(page, await viewClip(page, "B"))];
    assert.ok(above.different > 800 && below.different > 800, `${above.different} and ${below.different} colours`);
    assert.notEqual(above.hash, below.hash, "both views are alike");
    await run.shot(page, "13-compare-phone");
    const seen = await page.locator(".pane[data-scenario=B] .label.release:not(.off)").first().boundingBox();
    assert.ok(seen.y > lower.y && seen.y < lower.y + lower.height, "names are in their view");
    await page.setViewportSize(before);
    await page.click("[aria-label='End scenario B']");
    await page.click("dialog[open] button:has-text('End it')");
    await until(() => page.locator(".pane").count(), (n) => n === 1, "one view");
    await page.selectOption("select[aria-label^='Map layer']", "none");
  });
  await page.context().close();
  await server.stop();
}
