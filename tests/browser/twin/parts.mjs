// A house of two parts, one with a courtyard, moved as a whole, on a server of its own: the shipped houses are simple.
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { assert, startServer, until } from "./harness.mjs";

export async function testParts(run, server, command) {
  if (!command.includes("serve")) return;
  const { crs } = await server.ask("scene");
  const [[x, y]] = (await server.ask("scenarios/A/setup")).buildings[0].footprint[0][0];
  const ring = (west, south, east, north) => [[west, south], [east, south], [east, north], [west, north], [west, south]].map(([e, n]) => [x + e, y + n]);
  const file = join(run.output, "farm.geojson");
  writeFileSync(file, JSON.stringify({ type: "FeatureCollection", crs: { type: "name", properties: { name: crs.replace(/^(EPSG):(\d+).*$/s, "urn:ogc:def:crs:$1::$2") } },
    features: [{ type: "Feature", properties: { name: "Farm", height_m: 6 },
      geometry: { type: "MultiPolygon", coordinates: [[ring(0, 0, 14, 12), ring(4, 4, 10, 8)], [ring(16, 2, 20, 10)]] } }] }));
  const own = await startServer([...command, "--set", `buildings.file=${file}`]);
  const page = await run.open(own.controller, { name: "Gus" });
  const setup = () => own.ask("scenarios/A/setup");
  await run.check("a house of several parts with a courtyard moves as a whole, by hand and by numbers", async () => {
    await until(() => page.textContent(".control"), (t) => /You have control/.test(t), "control");
    const [farm] = (await setup()).buildings;
    assert.equal(farm.footprint.length, 2);
    const shift = async () => {
      const [now] = (await setup()).buildings;
      const by = [0, 1].map((axis) => now.footprint[0][0][0][axis] - farm.footprint[0][0][0][axis]);
      now.footprint.forEach((part, p) => part.forEach((r, k) => r.forEach((point, i) => {
        for (const axis of [0, 1]) assert.ok(Math.abs(point[axis] - farm.footprint[p][k][i][axis] - by[axis]) < 1e-6, "each corner by the same");
      })));
      assert.equal(now.footprint[0].length, 2, "the courtyard is there");
      return by;
    };
    await page.click(`[data-item="${farm.id}"]`);
    await page.click("[aria-label='Top view']");
    const handle = page.locator(".handle.whole");
    await handle.waitFor();
    assert.equal(await page.locator(".handle").count(), 1, "no corners to drag");
    // While the camera is on its way the handle may be out of sight, and what is hidden takes no focus.
    await page.waitForTimeout(1500);
    await until(async () => {
      await handle.focus();
      return page.evaluate(() => document.activeElement.className);
    }, (name) => /whole/.test(name), "focus");
    await page.keyboard.press("ArrowRight");
    await until(shift, ([east]) => Math.abs(east - 1) < 0.011, "one metre to the east");
    await page.locator(".editor:visible summary").click();
    await page.fill("[aria-label='Move all parts to the north by, m']", "-2.5");
    await page.locator(".editor:visible").getByRole("button", { name: "Move", exact: true }).click();
    await until(shift, ([east, north]) => Math.abs(east - 1) < 0.011 && Math.abs(north + 2.5) < 0.011, "2.5 m to the south");
    await page.waitForTimeout(600);
    await run.shot(page, "21-parts");
    await page.keyboard.press("Control+z");
    await until(shift, ([east, north]) => Math.abs(east - 1) < 0.011 && Math.abs(north) < 0.011, "the second move undone");
  });
  await page.context().close();
  await own.stop();
}
