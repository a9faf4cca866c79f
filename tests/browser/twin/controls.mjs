// What changes a scenario: time, parameters, releases, barriers, buildings, undo.
import { assert, clickGround, drag, inControl, pause, shownTime, until, viewClip } from "./harness.mjs";

/** The page as people see it: with all particles of the scene and the whole mesh of the ground. */
async function testOpening(run) {
  const server = await run.start([], { particles: null });
  const page = await run.open(server.controller, { name: "Ada", finest: true, sharp: true });
  await run.check("opens: title, terrain on the canvas, token gone from the address", async () => {
    console.log(`        first picture after ${page.firstPicture_ms} ms`);
    assert.ok(!page.url().includes("token"), page.url());
    assert.equal(await page.textContent(".topbar h1"), (await server.ask("scene")).title);
    const seen = await run.still(page, await viewClip(page));
    assert.ok(seen.different > 1500, `only ${seen.different} colours`);
    assert.ok(seen.commonest < 0.2, `${Math.round(100 * seen.commonest)} % of the view has one colour`);
    await run.shot(page, "1-open");
  });
  await page.context().close();
  await server.stop();
}

/** A scene whose solver has no law for some of the parameters. */
async function testHindrances(run) {
  const server = await run.start(["--set", "solver.internal_friction=pair"]);
  const page = await run.open(server.controller, { name: "Eve" });
  await inControl(page);
  await run.check("a parameter that the scene's solver has no law for is disabled, and the reason stands beside it", async () => {
    const field = page.locator(".field", { has: page.locator("label:text-is('Cohesion')") });
    const number = field.locator("input[type=number]");
    await until(() => number.isDisabled(), (off) => off, "cohesion is off");
    const why = /^Needs solver\.internal_friction = "stress": friction by pairs has no such law\.$/;
    assert.match(await field.locator(".hint").textContent(), why);
    assert.match(await field.getAttribute("title"), why);
    assert.equal(await page.locator(".field", { hasText: "riction" }).first().locator("input[type=number]").isDisabled(), false);
  });
  await page.context().close();
  await server.stop();
}

export async function testControls(run) {
  await testOpening(run);
  await testHindrances(run);
  const server = await run.start();
  const page = await run.open(server.controller, { name: "Ada" });
  await inControl(page);
  const state = () => server.ask("scenarios/A/state");
  const setup = () => server.ask("scenarios/A/setup");

  await run.check("run: debris moves on the canvas, time goes on; pause holds both", async () => {
    const clip = await viewClip(page);
    const before = await run.still(page, clip);
    await page.selectOption("select[aria-label^=Speed]", "0.5");  // however slow the page is, the end is far
    await page.click(".run");
    await until(state, (s) => s.status === "running" && s.time_s > 1, "running");
    await until(() => shownTime(page), (t) => t > 1, "time on the page");
    await until(async () => (await run.picture(page, clip)).hash, (hash) => hash !== before.hash, "another picture");
    const left = () => page.textContent(".timeline-ends");
    const end = (await state()).end_time_s;
    await until(left, (t) => new RegExp(`\\d+\\s(s|min|h) left · ${end} s$`).test(t), "the wall time left");
    await pause(page, state);
    await until(left, (t) => !/left/.test(t) && t.endsWith(`${end} s`), "no wall time left while paused");
    assert.equal((await state()).status, "paused");
    await until(() => page.textContent(".status"), (t) => /Paused/.test(t), "paused on the page");
    const held = await run.still(page, clip);
    assert.equal((await run.still(page, clip)).hash, held.hash, "the canvas changes while paused");
    assert.notEqual(held.hash, before.hash);
    await run.shot(page, "2-running");
  });

  await run.check("one step, by click and by key", async () => {
    const first = (await state()).step;
    await page.click('[aria-label="Step"]');
    await until(state, (s) => s.step === first + 1 && s.status === "paused", "one step");
    await page.locator(".stage canvas").focus();
    await page.keyboard.press(".");
    await until(state, (s) => s.step === first + 2, "two steps");
  });

  await run.check("speed is chosen and told to the server", async () => {
    await page.selectOption("select[aria-label^=Speed]", "0.1");
    await until(state, (s) => s.speed_factor === 0.1, "slow motion");
    await page.selectOption("select[aria-label^=Speed]", "");
    await until(state, (s) => s.speed_factor === null, "as fast as it goes");
    await page.selectOption("select[aria-label^=Speed]", "0.5");
    await until(state, (s) => s.speed_factor === 0.5, "half speed");
  });

  await run.check("restart goes back to time 0", async () => {
    await page.click('[aria-label="Restart"]');
    await until(state, (s) => s.time_s === 0, "time 0");
    await until(() => shownTime(page), (t) => t === 0, "time on the page");
  });

  const friction = page.locator(".field", { hasText: "riction" }).first();
  const key = "material.friction_coefficient";
  await run.check("a parameter by number and by slider; out of range is told; reset, undo, redo by button and key", async () => {
    const first = (await setup()).parameters[key];
    const number = friction.locator("input[type=number]");
    await number.fill("0.55");
    await number.press("Enter");
    await until(setup, (s) => s.parameters[key] === 0.55, "friction 0.55");
    await number.fill("-3");
    await number.press("Enter");
    assert.match(await friction.locator(".field-note").textContent(), /-3.*allowed/i);
    assert.equal((await setup()).parameters[key], 0.55);
    await number.press("Escape");
    const slider = friction.locator("input[type=range]");
    await slider.focus();
    await slider.press("ArrowRight");
    const moved = await until(setup, (s) => s.parameters[key] > 0.55, "friction by slider");
    assert.ok(Math.abs(moved.parameters[key] - 0.56) < 0.011);
    await page.click(".controls button:has-text('Undo')");
    await until(setup, (s) => s.parameters[key] === 0.55, "undo by button");
    await page.locator(".stage canvas").focus();
    await page.keyboard.press("Control+z");
    await until(setup, (s) => s.parameters[key] === first, "undo by key");
    await page.keyboard.press("Control+Shift+Z");
    await until(setup, (s) => s.parameters[key] === 0.55, "redo by key");
    await until(() => page.locator(".controls button:has-text('Undo')").getAttribute("title"), (t) => /Undo: .+/.test(t), "what undo would undo");
    await friction.locator("button[aria-label^=Reset]").click();
    const usual = (await server.ask("scene")).parameters.find((p) => p.key === key).default;
    await until(setup, (s) => s.parameters[key] === usual, "reset");
  });

  await run.check("every parameter has its help and its unit", async () => {
    const scene = await server.ask("scene");
    for (const parameter of scene.parameters) {
      const field = page.locator(".field", { has: page.locator(`label:text-is(${JSON.stringify(parameter.label.slice(0, 1).toUpperCase() + parameter.label.slice(1))})`) });
      assert.equal(await field.locator("label").getAttribute("title"), parameter.help);
      await field.locator(`button[aria-label="What is ${parameter.label}?"]`).click();
      assert.ok((await field.locator(".help").textContent()).includes(parameter.help));
      await field.locator(`button[aria-label="What is ${parameter.label}?"]`).click();
    }
  });

  await run.check("a release is drawn with clicks: live volume, server's volume, a corner dragged, triggered, undone", async () => {
    const known = new Set((await setup()).releases.map((r) => r.id));
    await page.click("[data-draw=release]");
    await page.locator(".draft:visible input[type=number]").first().fill("2");
    await page.locator(".draft:visible input[type=number]").first().press("Enter");
    for (const [u, v] of [[0.40, 0.44], [0.43, 0.43], [0.435, 0.46], [0.405, 0.47]]) await clickGround(page, u, v);
    const live = await page.textContent(".draft:visible .measure");
    assert.match(live, /m² × 2\.00 m = .*\sm³/);
    const area = Number(live.split("m²")[0].replace(/\s/g, ""));
    await page.keyboard.press("Enter");
    const fresh = (await until(setup, (s) => s.releases.some((r) => !known.has(r.id)), "a new release")).releases.find((r) => !known.has(r.id));
    assert.equal(fresh.thickness_m, 2);
    assert.equal(fresh.status, "held");
    const told = Number(live.split("=")[1].split("m³")[0].replace(/[^\d.]/g, ""));
    assert.ok(Math.abs(told - fresh.volume_m3) < 0.1 * fresh.volume_m3, `page ${told}, server ${fresh.volume_m3} m3, area ${area}`);
    const handles = page.locator(".handle:visible");
    await until(() => handles.count(), (n) => n === 5, "handles");
    await run.shot(page, "3-release");
    await drag(page, handles.nth(2), 20, 10);
    const wider = (await until(setup, (s) => s.releases.find((r) => r.id === fresh.id).volume_m3 > 1.05 * fresh.volume_m3, "a larger volume")).releases.find((r) => r.id === fresh.id);
    assert.equal(wider.polygons[0][0].length, fresh.polygons[0][0].length);
    const held = (await state()).volume_held_m3;
    assert.ok(held > 0.9 * wider.volume_m3, `${held} m3 are held`);
    await page.click(".editor button:has-text('Trigger')");
    await until(setup, (s) => s.releases.find((r) => r.id === fresh.id).status === "released", "triggered");
    await page.click(".run");
    await until(state, (s) => s.volume_held_m3 < 0.1 * held && s.step > 3, "its debris");
    await pause(page, state);
    await page.locator(".stage canvas").focus();
    for (let k = 0; k < 3; ++k) {
      const sentence = (await setup()).undo;
      await page.keyboard.press("Control+z");
      await until(setup, (s) => s.undo !== sentence, `undo of ${sentence}`);
    }
    assert.ok(!(await setup()).releases.some((r) => r.id === fresh.id), "the release is still there");
  });

  await run.check("a release is drawn by keyboard alone", async () => {
    const known = (await setup()).releases.length;
    await page.locator("[data-draw=release]").focus();
    await page.keyboard.press("Enter");
    await page.keyboard.press("v");
    for (const [k, move] of ["ArrowUp", "ArrowRight", "ArrowDown", "ArrowRight"].entries()) {
      await page.keyboard.press(`Shift+${move}`);
      if (k < 3) await page.keyboard.press("Space");
    }
    await page.keyboard.press("Enter");
    const made = (await until(setup, (s) => s.releases.length === known + 1, "a release")).releases.at(-1);
    assert.ok(made.volume_m3 > 1);
    await page.locator(".editor input[aria-label=Name]").waitFor();
    await page.keyboard.press("Delete");
    await until(setup, (s) => s.releases.length === known, "removed by Delete");
  });

  await run.check("a rule between keys stands beside its field before anything is sent", async () => {
    const before = await setup();
    const { particle_spacing_m } = await server.ask("scene");
    await page.click("[data-draw=barrier]");
    const field = page.locator(".draft:visible .field", { hasText: "Thickness" });
    const hint = await field.locator(".hint").textContent();
    assert.match(hint, /^Minimum [\d.]+ m; thinner walls let debris interact across them\.$/);
    const least = Number(hint.match(/[\d.]+/)[0]);
    assert.ok(Math.abs(least - particle_spacing_m / 2) < 0.01, `${least} m with particles of ${particle_spacing_m} m`);
    const number = field.locator("input[type=number]");
    await number.fill(String(0.9 * least));
    await number.press("Enter");
    assert.match(await field.locator(".field-note").textContent(), /Thickness is .*allowed is/);
    assert.equal(await number.getAttribute("aria-invalid"), "true");
    await number.fill("1");
    await number.press("Enter");
    assert.equal(await number.getAttribute("aria-invalid"), "false");
    assert.equal((await setup()).revision, before.revision);
    await page.click(".draft:visible button:has-text('Cancel')");
  });

  await run.check("an action that the server refuses is told beside the control", async () => {
    const first = (await setup()).barriers.length;
    await page.click("[data-draw=barrier]");
    const height = page.locator(".draft:visible input[type=number]").first(), thickness = page.locator(".draft:visible input[type=number]").nth(1);
    await height.fill("900");
    await height.press("Enter");
    assert.match(await page.locator(".draft:visible .field-note").first().textContent(), /Height is 900; allowed/);
    await height.fill("3");
    await height.press("Enter");
    await thickness.fill("1");
    await thickness.press("Enter");
    // That a line must not cross itself only the server knows.
    for (const [u, v] of [[0.42, 0.62], [0.52, 0.62], [0.5, 0.66], [0.46, 0.58]]) await clickGround(page, u, v);
    await page.click(".draft:visible button:has-text('Finish')");
    const toast = page.locator(".toast.error");
    await toast.waitFor();
    assert.match(await toast.textContent(), /crosses itself/);
    await toast.locator("button").click();
    assert.equal(await page.locator(".toast.error").count(), 0);
    assert.equal((await setup()).barriers.length, first);
  });

  await run.check("a barrier is drawn, made higher, moved by key, removed, brought back by undo", async () => {
    await page.click("[data-draw=barrier]");
    const height = page.locator(".draft:visible input[type=number]").first();
    await height.fill("4");
    await height.press("Enter");
    const thickness = page.locator(".draft:visible input[type=number]").nth(1);
    await thickness.fill("1");
    await thickness.press("Enter");
    const clip = await viewClip(page);
    const without = await run.still(page, clip);
    await clickGround(page, 0.38, 0.62);
    await clickGround(page, 0.46, 0.64);
    await clickGround(page, 0.54, 0.62, { clickCount: 1 });
    await page.keyboard.press("Backspace");
    await clickGround(page, 0.54, 0.62);
    await page.keyboard.press("Enter");
    const barrier = (await until(setup, (s) => s.barriers.length === 1, "a barrier")).barriers[0];
    assert.equal(barrier.line.length, 3);
    assert.equal(barrier.height_m, 4);
    await until(async () => (await run.picture(page, clip)).hash, (hash) => hash !== without.hash, "the barrier in the view");
    const field = page.locator(".editor input[type=number]").first();
    await field.fill("6");
    await field.press("Enter");
    await until(setup, (s) => s.barriers[0].height_m === 6, "6 m high");
    const handle = page.locator(".handle:visible").first();
    await handle.focus();
    await page.keyboard.press("ArrowUp");
    await until(setup, (s) => Math.abs(s.barriers[0].line[0][1] - barrier.line[0][1] - 1) < 0.02, "moved north by 1 m");
    await run.shot(page, "4-barrier");
    const editor = page.locator(".editor:visible");
    await editor.locator("label:has-text('Net') input").check();
    await until(setup, (s) => s.barriers[0].passing_share === 0.5, "a net");
    await editor.locator("label:has-text('Fails under load') input").check();
    await until(setup, (s) => s.barriers[0].resistance_Npm === 200_000, "a net that breaks");
    await editor.locator("summary:has-text('Openings')").click();
    await editor.locator("button:has-text('Add an opening')").click();
    await until(setup, (s) => s.barriers[0].openings.length === 1, "an opening");
    await run.still(page);
    await run.shot(page, "4-net");
    await editor.locator("button[title='Close opening 1']").click();
    await until(setup, (s) => s.barriers[0].openings.length === 0, "no opening");
    await editor.locator("label:has-text('Net') input").uncheck();
    await until(setup, (s) => s.barriers[0].passing_share === null && s.barriers[0].resistance_Npm === 200_000, "a wall again");
    await page.click(".editor button:has-text('Remove')");
    await until(setup, (s) => s.barriers.length === 0, "removed");
    await page.click(".controls button:has-text('Undo')");
    await until(setup, (s) => s.barriers.length === 1 && s.barriers[0].height_m === 6, "back");
  });

  await run.check("a building is drawn, named, moved as a whole, removed", async () => {
    const count = (await setup()).buildings.length;
    await page.click("[data-draw=building]");
    for (const [u, v] of [[0.60, 0.66], [0.65, 0.66], [0.65, 0.72], [0.60, 0.72]]) await clickGround(page, u, v);
    await page.keyboard.press("Enter");
    const made = (await until(setup, (s) => s.buildings.length === count + 1, "a building")).buildings.at(-1);
    assert.equal(made.from_scene, false);
    const name = page.locator(".editor input[aria-label=Name]");
    await name.fill("Pump house");
    await name.press("Enter");
    await until(setup, (s) => s.buildings.at(-1).name === "Pump house", "its name");
    await drag(page, page.locator(".handle.whole:visible"), 30, 0);
    const moved = (await until(setup, (s) => Math.hypot(s.buildings.at(-1).polygons[0][0][0][0] - made.polygons[0][0][0][0], s.buildings.at(-1).polygons[0][0][0][1] - made.polygons[0][0][0][1]) > 2, "moved")).buildings.at(-1);
    const side = (b) => Math.hypot(b.polygons[0][0][1][0] - b.polygons[0][0][0][0], b.polygons[0][0][1][1] - b.polygons[0][0][0][1]);
    assert.ok(Math.abs(side(moved) - side(made)) < 0.05, "it keeps its shape");
    await page.click(".editor button:has-text('Remove')");
    await until(setup, (s) => s.buildings.length === count, "removed");
  });

  await run.check("a click in the view selects a house, and Escape lets it go", async () => {
    const houses = (await setup()).buildings;
    if (houses.length === 0) return;
    await page.click("[data-tab=impact]");
    await until(() => page.locator(".impacts tbody th button").count(), (n) => n > 0, "the table");
    await page.locator(".impacts").last().locator("tbody th button").first().click();
    await clickGround(page, 0.5, 0.5);
    await until(() => page.locator(".editor input[aria-label=Name]").count(), (n) => n === 1, "the editor of a house");
    await page.locator(".stage canvas").focus();
    await page.keyboard.press("Escape");
    assert.equal(await page.locator(".editor input[aria-label=Name]").count(), 0);
    await page.keyboard.press("f");
  });
  await page.context().close();
  await server.stop();
}
