// Zones, beds and inflows in their forms, on a server of its own: they hold for the whole run, and beds and inflows change at a restart.
import { assert, boxOf, clickGround, inControl, until, viewClip } from "./harness.mjs";

export async function testGround(run) {
  const own = await run.start();
  const page = await run.open(own.controller, { name: "Hal" });
  await inControl(page);
  const setup = () => own.ask("scenarios/A/setup");
  const state = () => own.ask("scenarios/A/state");
  const scene = await own.ask("scene");
  const editor = page.locator(".editor:visible");
  const field = (label) => editor.locator(".field", { has: page.locator(`label:text-is("${label}")`) });
  const set = async (label, value) => {
    const input = field(label).locator("input[type=number]");
    await input.fill(String(value));
    await input.press("Enter");
  };
  const tick = (label) => editor.locator(`label:has-text("${label}") input`);
  const press = (name) => editor.getByRole("button", { name, exact: true });
  const [[px, py]] = scene.flow_path.points.slice(Math.floor(scene.flow_path.points.length / 2));
  const around = (half) => [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([u, v]) => [px + u * half, py + v * half]);
  const byCoordinates = async (points) => {
    await page.locator(".draft:visible summary").click();
    for (const [x, y] of points) {
      await page.fill(".draft:visible [aria-label^='East of']", x.toFixed(2));
      await page.fill(".draft:visible [aria-label^='North of']", y.toFixed(2));
      await page.click(".draft:visible button:has-text('Add point')");
    }
  };
  /** A picture once what was asked for is drawn, without notices of what was done. */
  const shot = async (name) => {
    await page.evaluate(() => document.querySelectorAll(".toast.done").forEach((toast) => toast.remove()));
    await run.picture(page);
    await run.shot(page, name);
  };

  await run.check("zones, beds and inflows are folded where there are none", async () => {
    assert.equal(await page.locator("[data-draw=zone]:visible").count(), 0);
    await shot("40-folded");
    await page.locator(".ground-group > summary").click();
    for (const shape of ["zone", "bed", "inflow"]) assert.equal(await page.locator(`[data-draw=${shape}]:visible`).count(), 1, shape);
  });

  await run.check("a zone is drawn with clicks: friction, forest, a corner moved by key", async () => {
    const clip = await viewClip(page);
    const without = await run.still(page, clip);
    await page.click("[data-draw=zone]");
    for (const [u, v] of [[0.40, 0.55], [0.52, 0.54], [0.53, 0.66], [0.41, 0.68]]) await clickGround(page, u, v);
    assert.match(await page.textContent(".draft:visible .measure"), /m²/);
    await shot("40-zone-draft");
    await page.keyboard.press("Enter");
    const [made] = (await until(setup, (s) => s.zones.length === 1, "a zone")).zones;
    assert.equal(made.friction_coefficient, 0.4);
    assert.equal(made.turbulent_friction_mps2, null);
    assert.equal(made.stem_density_pm2, 0);
    await set("Coefficient", 0.7);
    await until(setup, (s) => s.zones[0].friction_coefficient === 0.7, "friction 0.7");
    await set("Coefficient", 12);
    assert.match(await field("Coefficient").locator(".field-note").textContent(), /12.*allowed/);
    assert.equal((await setup()).zones[0].friction_coefficient, 0.7);
    await tick("Forest").check();
    await until(setup, (s) => Math.abs(s.zones[0].stem_density_pm2 - 0.04) < 1e-9, "400 stems per hectare");
    await set("Stems", 800);
    await until(setup, (s) => Math.abs(s.zones[0].stem_density_pm2 - 0.08) < 1e-9, "800 stems per hectare");
    await set("Stem diameter", 0.25);
    await until(setup, (s) => s.zones[0].stem_diameter_m === 0.25, "0.25 m thick");
    await tick("Cohesion").check();
    await until(setup, (s) => s.zones[0].cohesion_Pa === 1000, "1 kPa");
    await tick("Turbulent friction").check();
    await until(setup, (s) => s.zones[0].turbulent_friction_mps2 === 500, "turbulent friction");
    await shot("40-zone-all");
    await tick("Cohesion").uncheck();
    await tick("Turbulent friction").uncheck();
    await until(setup, (s) => s.zones[0].cohesion_Pa === null && s.zones[0].turbulent_friction_mps2 === null, "as elsewhere");
    const ring = made.polygons[0][0];
    const handle = page.locator(".handle:visible").first();
    await handle.focus();
    await page.keyboard.press("ArrowUp");
    await until(setup, (s) => Math.abs(s.zones[0].polygons[0][0][0][1] - ring[0][1] - 1) < 0.02, "a corner north by 1 m");
    await until(async () => (await run.picture(page, clip)).hash, (hash) => hash !== without.hash, "the zone in the view");
    await page.locator(".editor:visible summary").click();
    assert.equal(await editor.locator(".corners input").count(), 8);
  });

  await run.check("a click selects a zone where nothing else is, and Escape lets it go", async () => {
    await page.locator(".stage canvas").focus();
    await page.keyboard.press("Escape");
    await until(() => editor.count(), (n) => n === 0, "no editor");
    await clickGround(page, 0.46, 0.61);
    await until(() => editor.locator("input[aria-label=Name]").count(), (n) => n === 1, "its editor");
    assert.match(await page.locator("[data-item][aria-pressed=true]").textContent(), /zone/i);
    await page.locator(".stage canvas").focus();
    await page.keyboard.press("Escape");
  });

  await run.check("a bed is drawn by coordinates; its law is changed; a change after time 0 waits for the restart", async () => {
    await page.click("[data-draw=bed]");
    const depth = page.locator(".draft:visible input[type=number]").first();
    await depth.fill("2");
    await depth.press("Enter");
    await byCoordinates(around(8));
    await page.click(".draft:visible button:has-text('Finish')");
    const [bed] = (await until(setup, (s) => s.beds.length === 1, "a bed")).beds;
    assert.equal(bed.depth_m, 2);
    assert.equal(bed.law, "growth");
    assert.ok(Math.abs(bed.volume_m3 - 512) < 60, `${bed.volume_m3} m3`);
    assert.equal(bed.in_force, true);
    await set("Growth rate", 0.01);
    await until(setup, (s) => s.beds[0].growth_rate_per_m === 0.01, "growth 0.01 per metre");
    await editor.locator("select").selectOption("shear");
    await until(setup, (s) => s.beds[0].law === "shear", "shear");
    await field("Critical shear stress").waitFor();
    assert.equal(await field("Growth rate").isVisible(), false);
    await set("Critical shear stress", 1.5);
    await until(setup, (s) => s.beds[0].critical_shear_stress_Pa === 1500, "1.5 kPa");
    await page.click('[aria-label="Step"]');
    await until(state, (s) => s.step > 0 && s.status !== "running", "a step");
    await set("Depth", 3);
    const later = await until(setup, (s) => s.beds[0].depth_m === 3, "3 m deep");
    assert.equal(later.beds[0].in_force, false);
    assert.equal(later.pending_restart, true);
    await editor.locator("text=Takes effect at the next restart.").waitFor();
    await shot("41-bed-waits");
    await press("Restart").click();
    await until(setup, (s) => s.beds[0].in_force && !s.pending_restart, "in force");
    await page.locator(".pending").waitFor({ state: "hidden" });
    await shot("41-bed");
  });

  await run.check("an inflow across a line: rows of its hydrograph, turned round, undone", async () => {
    await page.click("[data-draw=inflow]");
    await clickGround(page, 0.56, 0.5);
    await page.mouse.move(0, 0);
    await shot("42-inflow-draft");
    await clickGround(page, 0.64, 0.53);
    const [made] = (await until(setup, (s) => s.inflows.length === 1, "an inflow")).inflows;
    assert.equal(made.line.length, 2);
    const cell = (row, name) => editor.locator(`[aria-label^="Row ${row}: ${name}"]`);
    await cell(2, "discharge").fill("20");
    await cell(2, "discharge").press("Tab");
    await until(setup, (s) => s.inflows[0].hydrograph[1].discharge_m3ps === 20, "20 m3/s");
    await until(() => page.evaluate(() => document.activeElement.getAttribute("aria-label")), (name) => /^Row 2: velocity/.test(name ?? ""), "the next number of the row has the focus");
    const rows = made.hydrograph.length;
    await press("Add a row").click();
    await until(setup, (s) => s.inflows[0].hydrograph.length === rows + 1, "one more row");
    await cell(rows + 1, "time").fill("12");
    await cell(rows + 1, "time").press("Enter");
    await until(setup, (s) => s.inflows[0].hydrograph[2].time_s === 12, "rows in the order of time");
    await until(() => page.evaluate(() => document.activeElement.getAttribute("aria-label")), (name) => /^Row 3: time/.test(name ?? ""), "the focus goes with its row");
    await tick("Density").check();
    await until(setup, (s) => s.inflows[0].hydrograph.every((row) => row.density_kgpm3 > 0), "a density");
    await shot("42-inflow-density");
    await tick("Density").uncheck();
    await until(setup, (s) => s.inflows[0].hydrograph.every((row) => row.density_kgpm3 === null), "the material's density");
    await press("Remove row 3").click();
    await until(setup, (s) => s.inflows[0].hydrograph.length === rows, "one row fewer");
    await press("Turn round").click();
    const turned = (await until(setup, (s) => Math.abs(s.inflows[0].line[0][0] - made.line[1][0]) < 0.02, "turned round")).inflows[0];
    assert.ok(Math.abs(turned.line[1][1] - made.line[0][1]) < 0.02);
    await shot("42-inflow");
    await page.locator(".stage canvas").focus();
    await page.keyboard.press("Control+z");
    await until(setup, (s) => Math.abs(s.inflows[0].line[0][0] - made.line[0][0]) < 0.02, "undone");
    await editor.locator("summary").click();
    assert.equal(await editor.locator(".corners input").count(), 4);
  });

  await run.check("a row that the server refuses is told, and taken back in the table", async () => {
    const cell = editor.locator('[aria-label^="Row 1: time"]');
    const first = await cell.inputValue();
    await cell.fill(await editor.locator('[aria-label^="Row 2: time"]').inputValue());
    await cell.press("Enter");
    await page.locator(".toast.error").waitFor();
    await page.locator(".toast.error button").click();
    await until(() => editor.locator('[aria-label^="Row 1: time"]').inputValue(), (value) => value === first, "the time before");
  });

  await run.check("an inflow over an area has a direction, downhill by itself", async () => {
    await page.click("[data-draw=inflow]");
    await page.locator(".draft:visible label:has-text('Over an area') input").check();
    await byCoordinates(around(6).map(([x, y]) => [x, y + 20]));
    await page.click(".draft:visible button:has-text('Finish')");
    const made = (await until(setup, (s) => s.inflows.length === 2, "another inflow")).inflows[1];
    assert.equal(made.line, null);
    assert.equal(made.direction_deg, null);
    await tick("Set direction").check();
    await until(setup, (s) => s.inflows[1].direction_deg !== null, "a direction");
    await set("Clockwise from north", 135);
    await until(setup, (s) => s.inflows[1].direction_deg === 135, "to the south-east");
    await shot("43-inflow-area");
    await page.setViewportSize({ width: 1024, height: 768 });
    await shot("43-narrow");
    const wide = await page.evaluate(() => [...document.querySelectorAll(".controls input, .controls button, .controls select, .controls canvas")].filter((e) => e.checkVisibility())
      .filter((e) => e.getBoundingClientRect().right > document.querySelector(".controls").getBoundingClientRect().left + document.querySelector(".controls").clientWidth + 0.5)
      .map((e) => e.outerHTML.slice(0, 90)));
    assert.deepEqual(wide, []);
    await page.setViewportSize({ width: 1280, height: 720 });
  });

  await run.check("a zone is drawn by keyboard alone and removed", async () => {
    await page.locator("[data-draw=zone]").focus();
    await page.keyboard.press("Enter");
    await page.locator(".draft:visible label:has-text('Forest') input").check();
    await page.locator(".stage canvas").focus();
    for (const [k, move] of ["ArrowUp", "ArrowRight", "ArrowDown", "ArrowRight"].entries()) {
      await page.keyboard.press(`Shift+${move}`);
      if (k < 3) await page.keyboard.press("Space");
    }
    await page.keyboard.press("Enter");
    const made = (await until(setup, (s) => s.zones.length === 2, "another zone")).zones[1];
    assert.equal(made.friction_coefficient, null);
    assert.ok(Math.abs(made.stem_density_pm2 - 0.04) < 1e-9);
    await editor.locator("input[aria-label=Name]").waitFor();
    await page.keyboard.press("Delete");
    await until(setup, (s) => s.zones.length === 1, "removed by Delete");
  });

  await run.check("a viewer sees the forms and can change nothing", async () => {
    const eve = await run.open(own.viewer, { name: "Ida" });
    for (const kind of ["zones", "beds", "inflows"]) {
      const [item] = (await setup())[kind];
      await eve.click(`[data-item="${item.id}"]`);
      await eve.locator(".editor:visible input[aria-label=Name]").waitFor();
      for (const control of await eve.locator(".ground-group input, .ground-group select, .ground-group .editor button, [data-draw]").all()) {
        if (await control.isVisible()) assert.equal(await control.isDisabled(), true, await control.evaluate((e) => e.outerHTML.slice(0, 120)));
      }
    }
    await eve.context().close();
  });

  await run.check("what is removed comes back by undo", async () => {
    for (const kind of ["zones", "beds", "inflows"]) {
      const before = (await setup())[kind];
      await page.click(`[data-item="${before[0].id}"]`);
      await boxOf(editor);
      await press("Remove").click();
      await until(setup, (s) => s[kind].length === before.length - 1, `${kind} removed`);
      await page.click(".controls button:has-text('Undo')");
      await until(setup, (s) => JSON.stringify(s[kind]) === JSON.stringify(before), `${kind} back`);
    }
  });
  await page.context().close();
  await own.stop();
}
