// The depth-averaged model beside the particles: switched on, its map, its curve and its figures are there, and follow a change of
// the setup. On a server of its own: the run does not come to its end.
import { assert, inControl, pause, until } from "./harness.mjs";

export async function testDepthAveraged(run) {
  const server = await run.start();
  // What it says of the model comes after its answer to the click, as from a busy server.
  const page = await run.open(server.controller, { name: "Eve", late: /"type":\s*"depth_averaged"/ });
  await inControl(page);
  const viewer = await run.open(server.viewer, { name: "Zoe" });
  const state = () => server.ask("scenarios/A/state");
  const model = () => server.ask("scenarios/A/depth_averaged");
  const done = () => until(model, (m) => m.state === "done", "the model's result");
  const tick = (on) => on.locator(".depth-averaged-switch input");
  const layers = (on) => on.locator("select[aria-label^='Map layer']");
  /** What the legend of a map says of its source and its scale. */
  const source = (on) => on.locator(".legend-from").textContent({ timeout: 1000 }).catch(() => "");
  const scale = async (title) => {
    const legend = page.locator(".legend", { has: page.locator(`b:text-is("${title}")`) });
    return /colours from (.*?)(;|$)/.exec(await legend.getAttribute("aria-label"))[1];
  };
  const velocity = (on) => on.locator(".chart-plot[aria-label^='Front velocity']").getAttribute("aria-label", { timeout: 1000 }).catch(() => "");
  const curve = (text) => /Depth-averaged from \S+ to ([\d.]+)/.exec(text)?.[1];
  let first;

  await run.check("off at first; only the person in control can switch it on", async () => {
    assert.equal((await model()).state, "off");
    assert.equal(await layers(page).locator("optgroup.depth-averaged").evaluate((group) => group.disabled), true);
    await until(() => tick(viewer).isDisabled(), (off) => off, "a viewer cannot switch it on");
    // Slower than in reality, so that it is still under way when a busy machine has paused it.
    await page.selectOption("select[aria-label^=Speed]", "0.25");
    await page.click(".run");
    await until(state, (s) => s.time_s > 5, "debris on its way");
    await pause(page, state);
  });

  await run.check("a click switches it on: map, curve and figures, for everybody", async () => {
    await page.selectOption("select[aria-label^='Map layer']", "peak_depth");
    await tick(page).click();
    assert.equal(await until(() => layers(page).inputValue(), (v) => v !== "peak_depth", "its map"), "depth_averaged/peak_depth");
    const made = (await done()).result;
    await until(() => source(page), (t) => /whole run of \d+ s/.test(t), "the legend names the model");
    first = curve(await until(() => velocity(page), (t) => curve(t) !== undefined, "the curve"));
    const front = made.front.front_velocity_mps.filter((v) => v !== null);
    assert.ok(Math.abs(Number(first) / Math.max(...front) - 1) < 0.01, `${first} m/s in the chart, ${Math.max(...front)} from the server`);
    await until(() => velocity(page), (t) => /Front from .*Depth-averaged|Depth-averaged from .*Front from/.test(t), "the curve of the particles beside it");
    const table = page.locator("table.both-models");
    await table.locator("tr", { hasText: "Affected area" }).waitFor();
    const heads = await table.locator("thead th").allTextContents();
    assert.match(heads[1], /^Particles by \d/);
    assert.deepEqual([heads[3], heads[4]], ["Depth-averaged, whole run", "Observed"]);
    const figures = await server.ask("scenarios/A/depth_averaged/comparison");
    const share = Math.round(100 * figures.area.intersection_over_union);
    assert.match(await page.textContent(".agreement"), new RegExp(`: ${share} % \\(intersection over union`));
    const text = await page.textContent(".depth-averaged-figures");
    assert.match(text, /Computed in .* on cells of 1\u202fm/);
    assert.match(text, /one velocity over the depth/);
    await until(() => velocity(viewer), (t) => curve(t) === first, "a viewer sees the curve");
    await run.still(page);
    await run.shot(page, "60-depth-averaged");
    await page.locator(".depth-averaged-figures").scrollIntoViewIfNeeded();
    await run.shot(page, "60-depth-averaged-figures");
  });

  await run.check("both models have one scale, and the map is the model's own", async () => {
    // Below the bars: the chosen layer's name is no part of the map.
    const view = await page.locator(".stage canvas").boundingBox();
    const clip = { x: view.x + 0.1 * view.width, y: view.y + 0.4 * view.height, width: 0.8 * view.width, height: 0.5 * view.height };
    const of_model = { scale: await scale("Peak depth, depth-averaged"), ...await run.still(page, clip) };
    assert.ok(run.requests.some((url) => /scenarios\/A\/depth_averaged\/layers\/peak_depth/.test(url)), "the map is asked of the model");
    await page.selectOption("select[aria-label^='Map layer']", "peak_depth");
    const of_particles = await run.changed(page, clip, [of_model.hash], "the particles' map");
    assert.equal(await scale("Peak depth"), of_model.scale);
    await run.shot(page, "60-particles");
    await page.selectOption("select[aria-label^='Map layer']", "depth_averaged/peak_depth");
    await run.changed(page, clip, [of_particles.hash], "the model's map");
    assert.equal(await scale("Peak depth, depth-averaged"), of_model.scale);
  });

  await run.check("a change takes the old result away at once, and the new one comes by itself", async () => {
    await page.evaluate(() => {
      window.sources = [];
      new MutationObserver(() => {
        const text = document.querySelector(".legend-from")?.textContent ?? "";
        if (window.sources.at(-1) !== text) window.sources.push(text);
      }).observe(document.querySelector(".legends"), { childList: true, subtree: true, characterData: true });
    });
    const before = (await model()).result.hash;
    const friction = page.locator(".field", { hasText: "riction" }).first().locator("input[type=number]");
    await friction.fill("0.55");
    await friction.press("Enter");
    await until(model, (m) => m.state === "done" && m.result.hash !== before, "another result");
    const second = curve(await until(() => velocity(page), (t) => ![undefined, first].includes(curve(t)), "another curve"));
    assert.ok(Number(second) < Number(first), `with more friction ${second} m/s, which was ${first} m/s`);
    await until(() => source(page), (t) => /whole run of \d+ s/.test(t), "its map");
    const sources = await page.evaluate(() => window.sources);
    assert.ok(sources.some((t) => /: (Waiting|Computing)/.test(t)), `the old map stayed until the new one came: ${JSON.stringify(sources)}`);
    await until(() => page.textContent(".depth-averaged-figures"), (t) => /setup was changed on the way/.test(t), "the table says how both differ");
    await run.still(page);
    await run.shot(page, "61-depth-averaged-after-the-change");
  });

  await run.check("the run is what it was without it, and off takes all of it away", async () => {
    const { actions } = await server.ask("scenarios/A/journal");
    assert.deepEqual(actions.map(({ action }) => action.action), ["set_parameter"], "the model is no part of the journal");
    await tick(page).click();
    await until(model, (m) => m.state === "off", "off");
    await until(() => layers(page).inputValue(), (v) => v === "peak_depth", "the layer of before");
    for (const one of [page, viewer]) await until(() => velocity(one), (t) => curve(t) === undefined, "no curve");
    assert.equal(await page.locator(".depth-averaged-figures").isVisible(), false);
    // Whoever reloads the page is told what there is.
    await tick(page).click();
    await done();
    await viewer.reload();
    await until(() => velocity(viewer), (t) => curve(t) !== undefined, "the curve after a reload");
  });
  await viewer.context().close();
  await page.context().close();
  await server.stop();
}
