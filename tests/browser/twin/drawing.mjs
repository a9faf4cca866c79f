// Drawing as its hints say: a double click and Enter end every outline, Undo stays in its scenario, and every button can be seen.
import { assert, clickGround, inControl, until } from "./harness.mjs";

/** Corners of what is drawn, as shares of the view. */
const ring = [[0.42, 0.52], [0.5, 0.5], [0.52, 0.6], [0.44, 0.62]];
const line = [[0.42, 0.66], [0.5, 0.68], [0.56, 0.66]];
const listOf = { release: "releases", barrier: "barriers", building: "buildings", zone: "zones", bed: "beds", inflow: "inflows" };
const cornersOf = (shape, item) => item.line ?? item.polygons[0][0];

export async function testDrawing(run) {
  const server = await run.start(["--set", "solver.end_time_s=2"], { particles: 500 });
  const page = await run.open(server.controller, { name: "Ida", edits: "new" });
  await inControl(page);
  const setup = (s = "A") => server.ask(`scenarios/${s}/setup`);
  const newest = async (shape, known) => (await until(setup, (s) => s[listOf[shape]].length > known, `a new ${shape}`))[listOf[shape]].at(-1);
  const begin = async (shape) => {
    const known = (await setup())[listOf[shape]].length;
    // The section with zones, beds and inflows is folded at first.
    const control = page.locator(`[data-draw=${shape}]`);
    if (!(await control.isVisible())) await page.locator(".ground-group > summary").click();
    await control.click();
    return known;
  };

  await run.check("a double click ends every outline at the corner that it sets, and a line of two points at its second", async () => {
    for (const shape of ["barrier", "release", "building", "zone", "bed"]) {
      const known = await begin(shape);
      const corners = shape === "barrier" ? line : ring;
      for (const [u, v] of corners.slice(0, -1)) await clickGround(page, u, v);
      await clickGround(page, ...corners.at(-1), { clickCount: 2 });
      const made = await newest(shape, known);
      assert.equal(cornersOf(shape, made).length, corners.length, `${shape}: ${JSON.stringify(made).slice(0, 300)}`);
      await until(() => page.locator(`.item[data-item="${made.id}"][aria-pressed=true], .editor:not(:empty)`).count(), (n) => n > 0, `${shape}: its editor`);
    }
    const known = await begin("inflow");
    await clickGround(page, 0.44, 0.72);
    await clickGround(page, 0.52, 0.73, { clickCount: 2 });
    assert.equal((await newest("inflow", known)).line.length, 2);
    await page.click("[data-tab=section]");
    const draw = page.locator(".tab-panel:visible button:has-text('Draw a section')");
    await draw.click();
    await clickGround(page, 0.4, 0.55);
    await clickGround(page, 0.6, 0.6, { clickCount: 2 });
    await until(() => draw.getAttribute("aria-pressed"), (pressed) => pressed === "false", "the section");
    await until(() => page.locator(".tab-panel:visible .chart").count(), (n) => n > 0, "its chart");
  });

  await run.check("Enter ends an outline also after a corner was clicked again, and a double click on one does", async () => {
    let known = await begin("barrier");
    for (const [u, v] of line) await clickGround(page, u, v);
    const handle = page.locator(".handle:not(.passive)").first();
    await handle.click();
    await page.keyboard.press("Enter");
    assert.equal((await newest("barrier", known)).line.length, line.length);
    known = await begin("zone");
    for (const [u, v] of ring) await clickGround(page, u, v);
    await handle.dblclick();
    assert.equal(cornersOf("zone", await newest("zone", known)).length, ring.length);
    // The newest corner is dragged like the others once the pointer has left it.
    known = await begin("barrier");
    await clickGround(page, ...line[0]);
    await clickGround(page, ...line[1]);
    await page.mouse.move(10, 10);
    const box = await page.locator(".stage canvas").boundingBox();
    await page.mouse.move(box.x + 0.3 * box.width, box.y + 0.7 * box.height);
    await until(() => page.locator(".handle.passive").count(), (n) => n === 0, "every corner can be dragged");
    await page.keyboard.press("Escape");
    assert.equal((await setup()).barriers.length, known);
  });

  await run.check("no button of the barrier's form or of the list of scenarios is cut off, beside a scroll bar too", async () => {
    await page.click(".which button:has-text('Compare')");
    await until(() => server.ask("session"), (s) => s.scenarios.length === 2, "two scenarios");
    await page.evaluate(() => (document.querySelector(".controls").style.paddingRight = "15px"));
    await page.click("[data-draw=barrier]");
    for (const [width, height] of [[1440, 900], [1024, 768]]) {
      await page.setViewportSize({ width, height });
      const cut = () => page.evaluate(() => {
        const panel = document.querySelector(".controls");
        const inner = (e) => e.getBoundingClientRect().right - Number.parseFloat(getComputedStyle(e).paddingRight);
        return [...panel.querySelectorAll(".which button, .draft button")].filter((b) => b.checkVisibility())
          .filter((b) => b.getBoundingClientRect().right > inner(b.closest(".which, .draft")) + 0.5 || b.getBoundingClientRect().right > inner(panel) || b.scrollWidth > b.clientWidth + 1)
          .map((b) => b.textContent || b.getAttribute("aria-label"));
      });
      await until(cut, (list) => list.length === 0, `every button whole at ${width} x ${height}`);
      await page.locator(".draft:visible button:has-text('Cancel')").scrollIntoViewIfNeeded();
      await run.shot(page, `60-barrier-form-${width}`);
    }
    await page.click(".draft:visible button:has-text('Cancel')");
    await page.setViewportSize({ width: 1280, height: 720 });
  });

  await run.check("the view is never blank while its size changes, as when a legend appears; contours are told where they are drawn", async () => {
    // After the page's own observer, in the same display frame: what the canvas holds then is what is shown.
    const drawn = await page.evaluate(() => new Promise((resolve) => {
      const stage = document.querySelector(".stage");
      const canvas = stage.querySelector("canvas");
      let first = true;
      new ResizeObserver(() => {
        if (first) { // at once, of the present size
          first = false;
          return void setTimeout(() => (document.querySelector(".legends").style.minHeight = "90px"));
        }
        const gl = canvas.getContext("webgl2");
        const pixel = new Uint8Array(4);
        gl.readPixels(canvas.width / 2, canvas.height / 2, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
        resolve([...pixel]);
      }).observe(stage);
    }));
    assert.ok(drawn[3] === 255 && drawn[0] + drawn[1] + drawn[2] > 0, `the middle of the view: ${drawn}`);
    const note = () => page.textContent(".map-note");
    assert.match(await note(), /^Contours every/);
    await page.locator("label:has-text('Contours') input").uncheck();
    await until(note, (text) => !/Contours/.test(text), "no contours");
    await page.locator("label:has-text('Contours') input").check();
    await page.locator("label:has-text('Natural') input").check();
    await until(note, (text) => !/Contours/.test(text), "none in the natural look");
    await page.locator("label:has-text('Natural') input").uncheck();
    await until(note, (text) => /Contours/.test(text), "contours again");
  });

  await run.check("undo and redo of a run that has begun stay in its scenario", async () => {
    const key = "material.friction_coefficient";
    await page.click("button[data-scenario=B]");
    const friction = page.locator(".field", { hasText: "riction" }).first().locator("input[type=number]");
    const first = (await setup("B")).parameters[key];
    await friction.fill("0.31");
    await friction.press("Enter");
    await until(() => setup("B"), (s) => s.parameters[key] === 0.31, "an edit before the first step");
    await page.click("[aria-label=Step]");
    await until(() => server.ask("scenarios/B/state"), (s) => s.step > 0, "a step");
    await page.locator(".stage canvas").focus();
    await page.keyboard.press("Control+z");
    await until(() => setup("B"), (s) => s.parameters[key] === first, "undone where it was done");
    await page.keyboard.press("Control+Shift+z");
    await until(() => setup("B"), (s) => s.parameters[key] === 0.31, "redone");
    assert.deepEqual((await server.ask("session")).scenarios, ["A", "B"]);
  });
  await page.context().close();
  await server.stop();
}
