// Observations, triggers and alarms that people add in the page, with the mouse and by keyboard alone, seen by somebody else.
import { assert, boxOf, clickGround, inControl, pause, until, unzipped } from "./harness.mjs";

const fill = async (page, values) => {
  for (const [key, value] of Object.entries(values)) await page.fill(`dialog [data-key=${key}]`, String(value));
};
const send = async (page) => {
  await page.click("dialog button[type=submit]");
  await until(() => page.locator("dialog[open]").count(), (n) => n === 0, "the form is closed");
};
const insidePage = async (page, locator) => {
  const [box, { width, height }] = [await boxOf(locator), page.viewportSize()];
  assert.ok(box.x >= 0 && box.y >= 0 && box.x + box.width <= width + 0.5 && box.y + box.height <= height + 0.5, JSON.stringify({ box, width, height }));
};

export async function testTables(run) {
  const server = await run.start();
  const ada = await run.open(server.controller, { name: "Ada", width: 1280, height: 800 });
  const eve = await run.open(server.viewer, { name: "Eve", width: 390, height: 844, touch: true });
  const setup = () => server.ask("scenarios/A/setup");
  const before = (await setup()).observations.length;
  await inControl(ada);

  await run.check("an observation is added by a click on the ground, with what its kind needs said beside it", async () => {
    await ada.click("[data-tab=points]");
    await ada.click("button:has-text('Add an observation')");
    await clickGround(ada, 0.5, 0.5);
    await ada.selectOption("[aria-label='What was observed']", "run_up");
    assert.match(await ada.textContent("dialog"), /Required: .*height/);
    assert.match(await ada.inputValue("dialog [data-key=x_m]"), /^\d{6}(\.\d+)?$/, "the place of the click");
    await fill(ada, { name: "Bank at the bend", height_m: "tall" });
    await ada.click("dialog button[type=submit]");
    await until(() => ada.textContent("dialog .problem"), (t) => /height: “tall” is not a number; it must be 0 to 10000 m/.test(t), "what is wrong");
    await fill(ada, { height_m: 99999 });
    await ada.click("dialog button[type=submit]");
    await until(() => ada.textContent("dialog .problem"), (t) => /height_m = 99999: must be a number 0 to 10000 \(m\)/.test(t), "what the server says");
    await insidePage(ada, ada.locator("dialog[open]"));
    await run.shot(ada, "70-observation");
    await fill(ada, { height_m: 2.5, uncertainty_m: 0.5 });
    await send(ada);
    const told = (await setup()).observations.at(-1);
    assert.deepEqual([told.section, told.name, told.values.height_m, told.values.uncertainty_m, told.from_scene], ["run_up", "Bank at the bend", 2.5, 0.5, false]);
    await until(() => eve.locator(".label.observation").allTextContents(), (all) => all.some((t) => /^Bank at the bend, 2.50.m$/.test(t)), "its name in the other's view");
  });

  await run.check("one is added by keyboard alone, and stands in chart and table beside what the run computes", async () => {
    await ada.keyboard.press("v");
    await ada.keyboard.press("o");
    await ada.keyboard.press("Space");
    await ada.locator("dialog[open] [data-key=chainage_m]").waitFor();
    assert.equal(await ada.evaluate(() => document.activeElement.dataset.key), "name", "the first field has the focus");
    await ada.keyboard.type("Film");
    await ada.keyboard.press("Tab");
    await ada.keyboard.press("ControlOrMeta+a");
    await ada.keyboard.type("60");
    await ada.keyboard.press("Tab");
    await ada.keyboard.type("12,5");
    await ada.keyboard.press("Enter");
    await until(setup, (s) => s.observations.length === before + 2, "the observation");
    assert.deepEqual([(await setup()).observations.at(-1).values.chainage_m, (await setup()).observations.at(-1).values.front_velocity_mps], [60, 12.5]);
    await ada.click("[data-tab=front]");
    const row = () => ada.locator(".observed-beside tbody tr", { hasText: "Front velocity at 60 m" }).locator("td").allTextContents();
    await until(row, ([observed]) => /12.5 ± 2.5/.test(observed ?? ""), "the row of the table");
    assert.equal((await row())[1], "–", "nothing is computed yet");
    await ada.click(".run");
    await until(row, ([, computed]) => /\d/.test(computed ?? ""), "what the run has for it");
    await pause(ada, () => server.ask("scenarios/A/state"));
    await until(() => ada.locator(".u-legend").first().textContent(), (t) => /Field, front velocity/.test(t), "its mark in the chart");
    const { rows } = await server.ask("scenarios/A/observed");
    const told = rows.find((r) => r.name === "Front velocity at 60 m");
    await until(row, ([, computed]) => Math.abs(Number(computed) - told.computed) < 0.06, "the server's number");
    await run.shot(ada, "71-observed");
  });

  await run.check("one is edited, removed and comes back with undo; a viewer can do none of it", async () => {
    await ada.click("[data-tab=points]");
    await ada.click("[aria-label='Edit the observation “Film”']");
    await fill(ada, { name: "Film of 2019", uncertainty_mps: 1 });
    await send(ada);
    await until(() => ada.textContent(".pins.observations"), (t) => /Film of 2019/.test(t), "the new name");
    await ada.click("[aria-label='Remove the observation “Film of 2019”']");
    await until(() => ada.textContent(".pins.observations"), (t) => !/Film of 2019/.test(t), "none");
    await ada.click(".controls button:has-text('Undo')");
    await until(() => ada.textContent(".pins.observations"), (t) => /Film of 2019/.test(t), "it is back");
    assert.equal((await setup()).changes.length, 0, "no change of the run");
    assert.equal((await setup()).observations.at(-1).values.uncertainty_mps, 1);
    await eve.locator(".sheet-handle").tap();
    await eve.locator("[data-tab=points]").tap();
    await until(() => eve.textContent(".pins.observations"), (t) => /Film of 2019/.test(t), "the other's list");
    assert.equal(await eve.isDisabled("button:has-text('Add an observation')"), true);
    await run.shot(eve, "72-observations-phone");
  });

  await run.check("an alarm that is added is raised in the run; the form says that addresses are not set here", async () => {
    await ada.setViewportSize({ width: 1024, height: 768 });
    if (!(await ada.locator("[data-tab=alarms]").isVisible())) await ada.click(".drawer-switch");
    await ada.click("[data-tab=alarms]");
    assert.match(await ada.textContent(".readings"), /Addresses and passwords are not part of an alarm/);
    await ada.click("button:has-text('Add an alarm')");
    await fill(ada, { name: "Front on its way", chainage_m: 200 });
    await ada.click("dialog button[type=submit]");
    await until(() => ada.textContent("dialog .problem"), (t) => /exactly one of distance_m/.test(t), "what is missing");
    await fill(ada, { distance_m: 195, message: "Clear the road." });
    await insidePage(ada, ada.locator("dialog[open]"));
    await run.shot(ada, "73-alarm-1024");
    await send(ada);
    await until(() => ada.textContent(".pins.alarms"), (t) => /Front on its way/.test(t), "the alarm in the list");
    await ada.click("[aria-label=Step]");
    await ada.click(".run");
    for (const page of [ada, eve]) await until(() => page.textContent(".alarm-banner"), (t) => /Alarm: Front on its way .*Clear the road/.test(t), "the alarm above the view");
    await pause(ada, () => server.ask("scenarios/A/state"));
    await run.shot(ada, "74-alarm-raised-1024");
  });

  await run.check("a trigger is added with its limits, and the page has no field for an address or a secret", async () => {
    await ada.click("button:has-text('Add a trigger')");
    assert.deepEqual(await ada.locator("dialog [data-key]").evaluateAll((all) => all.map((e) => e.dataset.key).filter((k) => /token|hook|mqtt|password|address|url/i.test(k))), []);
    const [release] = (await setup()).releases;
    await fill(ada, { name: "tilt meter", release: release.name, volume_limit_m3: 500 });
    await send(ada);
    await until(() => server.ask("alerts"), (a) => a.triggers.some((t) => t.name === "tilt meter" && t.limits.volume_m3 === 500), "the trigger");
    await until(() => eve.locator(".pins.triggers").textContent(), (t) => /tilt meter/.test(t), "the other's list");
  });

  await run.check("the exported scene holds them", async () => {
    const archive = await fetch(`${server.base}api/scenarios/A/exports/scene.zip`, { headers: { Authorization: `Bearer ${server.token}` } });
    assert.equal(archive.status, 200, await archive.clone().text().catch(() => ""));
    const scene = unzipped(Buffer.from(await archive.arrayBuffer()))["scene.toml"].toString();
    for (const name of ["Bank at the bend", "Film of 2019", "Front on its way", "tilt meter"]) assert.ok(scene.includes(`"${name}"`), `${name} in\n${scene}`);
  });
  await ada.context().close();
  await eve.context().close();
  await server.stop();
}
