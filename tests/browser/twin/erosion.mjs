// Debris that entrains its bed: the ground sinks under it, on the page too, as far as at the time on display, and a restart
// brings it back. On a server and a scene of its own: the shipped ones have no bed.
import { assert, boxOf, inControl, middleOfPlan, pause, saved, until, unzipped, viewClip } from "./harness.mjs";
import { writeGully } from "./gully.mjs";

/** Grid message of docs/protocol.md: where the largest value is, and how large. */
async function largestOf(page, path, token) {
  return page.evaluate(async ([url, bearer]) => {
    const data = await (await fetch(url, { headers: { Authorization: `Bearer ${bearer}` } })).arrayBuffer();
    const head = new DataView(data);
    const [x, y, cell, wide] = [head.getFloat64(8, true), head.getFloat64(16, true), head.getFloat64(24, true), head.getUint32(32, true)];
    const body = new Response(new Blob([data.slice(44)]).stream().pipeThrough(new DecompressionStream("deflate")));
    const values = new Float32Array(await body.arrayBuffer());
    let [most, at, cells] = [0, 0, 0];
    values.forEach((v, k) => {
      if (v > 0) ++cells;
      if (v > most) [most, at] = [v, k];
    });
    return { most, cells, x: x + (at % wide + 0.5) * cell, y: y + (Math.floor(at / wide) + 0.5) * cell };
  }, [`api/scenarios/A/layers/${path}`, token]);
}

export async function testErosion(run) {
  const own = await run.start([], { scene: writeGully(run.output), particles: null });
  const page = await run.open(own.controller, { name: "Hal" });
  await inControl(page);
  const state = () => own.ask("scenarios/A/state");
  const sunk = () => page.evaluate(() => window.talusStats.sunk_m.A ?? 0);
  const offered = () => page.locator("option[value=erosion_depth]").evaluate((option) => !option.disabled);
  // Without a legend the view has its whole height.
  for (const name of ["Names", "Particles"]) await page.locator(`label:has-text('${name}') input`).uncheck();
  await page.locator(".legends").waitFor({ state: "hidden" });
  // Downstream of the release, whose outline tells whether it is held: nothing but the ground is there.
  const box = await boxOf(page.locator(".stage canvas"));
  const clip = { x: box.x + 0.2 * box.width, y: box.y + 0.25 * box.height, width: 0.65 * box.width, height: 0.45 * box.height };
  let deepest, before, layer;

  /** The read-out's height of the ground in the middle of a plan. */
  const heightInTheMiddle = async () => {
    await page.mouse.move(1, 1); // away from the canvas, which clears it
    await until(() => page.textContent(".read-out"), (t) => t === "", "no read-out");
    await page.mouse.move(box.x + box.width / 2, await middleOfPlan(page));
    const text = await until(() => page.textContent(".read-out"), (t) => /ground/.test(t), "the read-out");
    return Number(/ground (\S+) m/.exec(text)[1]);
  };
  /** Share of the flow path in the reach that debris erodes. */
  const path = async () => (await run.colours(page, { ...clip, width: 0.4 * box.width })).bluish;

  await run.check("the ground sinks where debris entrains its bed, as far as the server says", async () => {
    await page.click("[aria-label='Top view']");
    assert.equal(await offered(), false, "nothing was entrained, so there is no map of it");
    before = { ...await run.still(page, clip), path: await path(), height: await heightInTheMiddle() };
    // No faster than in reality, so that it is still under way when it is paused: a scenario B does not run then.
    await page.selectOption("select[aria-label^=Speed]", "1");
    await page.click(".run");
    await until(sunk, (depth) => depth > 0, "the ground sinks while debris moves");
    await until(state, (s) => s.time_s > 6, "more of it");
    await pause(page, state);
    assert.equal((await state()).status, "paused");
    const { volume_entrained_m3: volume } = await state();
    deepest = await largestOf(page, "erosion_depth", own.token);
    assert.ok(volume > 10 && deepest.most > 0.3 && deepest.cells > 50, JSON.stringify({ volume, deepest }));
    await until(sunk, (depth) => Math.abs(depth - deepest.most) < 1e-6, "the page's ground in the pause");
    await run.changed(page, clip, [before.hash], "another look of the ground");
    // The flow path lies on the sunk ground: under the old one it would not be seen.
    assert.ok(before.path > 1e-3, `${before.path} of the view is the flow path`);
    await until(path, (share) => share > 0.8 * before.path, `the flow path, which was ${before.path} of the view`);
    await run.shot(page, "45-sunk-ground");
    await until(heightInTheMiddle, (height) => height < before.height - 0.1 && height > before.height - deepest.most - 0.1, `the height, which was ${before.height} m`);
  });

  await run.check("erosion is a map layer with a legend in metres, and among the exports", async () => {
    await until(offered, (there) => there, "the layer is offered");
    const bare = await run.still(page, clip);
    await page.selectOption("select[aria-label^='Map layer']", "erosion_depth");
    await until(() => page.locator(".legend").last().textContent(), (t) => /^Erosionm/.test(t), "legend");
    layer = await run.changed(page, clip, [bare.hash], "the layer");
    await run.shot(page, "45-erosion-layer");
    await page.click("button:has-text('Export')");
    await page.locator("dialog label:text-is('erosion_depth.tif') input").check();
    const files = await saved(page, () => page.click("dialog button:has-text('as ZIP')"));
    assert.ok(unzipped(files.bytes)["erosion_depth.tif"].length > 300);
    await page.keyboard.press("Escape");
  });

  await run.check("looking back, ground and layer are those of then", async () => {
    const last = (await state()).recording.last_s;
    const then = await largestOf(page, `erosion_depth?time_s=${0.4 * last}`, own.token);
    assert.ok(then.cells > 0 && then.cells < deepest.cells, `${then.cells} cells then, ${deepest.cells} now`);
    await page.locator("input.timeline").focus();
    await page.keyboard.press("Home");
    await until(sunk, (depth) => depth === 0, "the ground of the beginning");
    await page.selectOption("select[aria-label^='Map layer']", "none");
    await run.back(page, clip, before, "looks as at the beginning");
    await page.click(".live");
    await page.selectOption("select[aria-label^='Map layer']", "erosion_depth");
    await run.back(page, clip, layer, "the ground of now");
    await page.selectOption("select[aria-label^='Map layer']", "none");
  });

  await run.check("each scenario has its own ground, and a restart brings the old one back", async () => {
    await page.click("button:has-text('Compare')");
    await page.locator(".pane[data-scenario=B]").waitFor();
    await until(() => page.evaluate(() => window.talusStats.sunk_m), (s) => Math.abs(s.A - deepest.most) < 1e-6, "the ground of A");
    const panes = [];
    for (const name of ["A", "B"]) panes.push((await run.still(page, await viewClip(page, name))).hash);
    assert.equal(await page.evaluate(() => window.talusStats.sunk_m.B ?? 0), 0, "B is at time 0");
    assert.notEqual(panes[0], panes[1], "both views are alike");
    await page.click("[aria-label='Fit']");
    await page.locator("label:has-text('Particles') input").check();
    await run.still(page);
    await run.shot(page, "45-own-ground");
    await page.locator("label:has-text('Particles') input").uncheck();
    await page.click("[aria-label='End scenario B']");
    await until(() => page.locator(".pane").count(), (n) => n === 1, "one view");
    await page.click("[aria-label='Top view']");
    await page.click('[aria-label="Restart"]');
    await until(state, (s) => s.time_s === 0, "time 0");
    await until(sunk, (depth) => depth === 0, "the old ground");
    await run.back(page, clip, before, "looks as before");
    await until(heightInTheMiddle, (height) => height === before.height, `the height, which was ${before.height} m`);
  });
  await page.context().close();
  await own.stop();
}
