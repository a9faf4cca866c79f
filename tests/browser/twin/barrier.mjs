// Debris against a barrier: one that is high enough holds it, one that is not is overtopped; both are told, and one that is
// taken away stays in the books. On a server of its own: another barrier on the way would change what this one holds.
import { assert, inControl, pause, shownTime, until, viewClip } from "./harness.mjs";

/** Ends of a line of `half` metres to either side of the flow path at a chainage. */
function across(path, chainage, half) {
  const k = Math.max(1, path.chainage_m.findIndex((c) => c >= chainage));
  const [a, b] = [path.points[k - 1], path.points[k]];
  const span = path.chainage_m[k] - path.chainage_m[k - 1];
  const t = (chainage - path.chainage_m[k - 1]) / span;
  const [x, y] = [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
  const length = Math.hypot(b[0] - a[0], b[1] - a[1]);
  const side = [-(b[1] - a[1]) / length, (b[0] - a[0]) / length];
  return [-1, 1].map((s) => [x + s * half * side[0], y + s * half * side[1]]);
}

export async function testBarrier(run) {
  const server = await run.start();
  const page = await run.open(server.controller, { name: "Dan" });
  await inControl(page);
  const state = () => server.ask("scenarios/A/state");
  const setup = () => server.ask("scenarios/A/setup");
  const scene = await server.ask("scene");
  const chainage = 70;
  const reach = 9; // s, enough for debris to get there and for most of it to stop

  const restart = async () => {
    await pause(page, state);
    await page.click('[aria-label="Restart"]');
    await until(state, (now) => now.time_s === 0, "time 0");
  };
  const play = async () => {
    await page.selectOption("select[aria-label^=Speed]", "");
    await page.click(".run");
    await until(state, (s) => s.time_s > reach || !["running", "paused"].includes(s.status), "the run");
    await pause(page, state);
    await until(() => shownTime(page), (t) => t > reach - 1, "time on the page");
  };
  const row = async () => {
    await page.click("[data-tab=impact]");
    const cells = page.locator(".impacts").first().locator("tbody tr").first();
    await cells.waitFor();
    const texts = await cells.locator("th, td").allTextContents();
    const heads = await page.locator(".impacts").first().locator("thead button span").allTextContents();
    return Object.fromEntries(heads.map((head, k) => [head.replace(/ [▾▴]/, ""), Number(texts[k].replace(/[^\d.]/g, "") || NaN)]));
  };

  await run.check("X lays a barrier across the flow path near the pointer; length, heights, slope, chainage and its crest are told", async () => {
    await page.click("[data-draw=barrier]");
    const canvas = await page.locator(".stage canvas").boundingBox();
    await page.mouse.move(canvas.x + 0.5 * canvas.width, canvas.y + 0.55 * canvas.height);
    const lie = page.locator(".draft:visible .lie");
    const at = await until(() => lie.textContent(), (t) => /^ground [\d.]+\sm, slope \d+°, chainage \d+\sm/.test(t), "where the pointer is");
    await page.keyboard.press("x");
    const met = Number(/chainage (\d+)/.exec(at)[1]);
    await until(() => lie.textContent(), (t) => /^[\d.]+\sm long, ground [\d.]+ to [\d.]+\sm, slope/.test(t) && Math.abs(Number(/path at (\d+)/.exec(t)?.[1]) - met) <= 1, "a line across the path");
    assert.match(await page.getAttribute(".draft:visible .chart-plot", "aria-label"), /Ground from 0.*Crest from/);
    await run.shot(page, "29-across");
    await page.keyboard.press("Enter");
    const [laid] = (await until(setup, (s) => s.barriers.length === 1, "the barrier")).barriers;
    assert.equal(laid.line.length, 2);
    await page.locator(".editor:visible .chart-plot").waitFor();
    await page.keyboard.press("Control+z");
    await until(setup, (s) => s.barriers.length === 0, "none again");
  });

  await run.check("a barrier across the path, by coordinates, holds the debris: impact and what it holds are told", async () => {
    await restart();
    await page.click("[data-draw=barrier]");
    const sizes = page.locator(".draft:visible input[type=number]");
    await sizes.first().fill("12");
    await sizes.first().press("Enter");
    await page.locator(".draft:visible summary").click();
    for (const [x, y] of across(scene.flow_path, chainage, 45)) {
      await page.fill(".draft:visible [aria-label^='East of']", x.toFixed(2));
      await page.fill(".draft:visible [aria-label^='North of']", y.toFixed(2));
      await page.click(".draft:visible button:has-text('Add point')");
    }
    await page.click(".draft:visible button:has-text('Finish')");
    await until(setup, (s) => s.barriers.length === 1 && s.barriers[0].height_m === 12, "the barrier");
    await play();
    const s = await state();
    assert.ok(s.front_chainage_m === null || s.front_chainage_m < chainage + 3, `the front is at ${s.front_chainage_m} m`);
    const told = await row();
    assert.ok(told.Force > 10, JSON.stringify(told));
    assert.equal(told.Overtopped, 0);
    assert.ok(told.Retained > 0.5 * s.volume_released_m3, `${told.Retained} of ${s.volume_released_m3} m3 are retained`);
    const seen = await run.colours(page, await viewClip(page));
    assert.ok(seen.different > 1000);
    await run.shot(page, "19-barrier-holds");
  });

  await run.check("a barrier that is too low is overtopped, and how much is told; taken away, it stays in the books", async () => {
    await page.locator(".impacts").first().locator("tbody th button").first().click();
    const height = page.locator(".editor input[type=number]").first();
    await height.fill("0.8");
    await height.press("Enter");
    await until(setup, (s) => s.barriers[0].height_m === 0.8, "0.8 m high");
    await restart();
    await play();
    const told = await row();
    assert.ok(told.Overtopped > 1, JSON.stringify(told));
    assert.ok((await state()).front_chainage_m > chainage + 5);
    await page.locator(".impacts").first().locator("tbody th button").first().click();
    await page.click(".editor button:has-text('Remove')");
    await until(setup, (s) => s.barriers.length === 0, "removed");
    const gone = page.locator(".removed li");
    await until(() => gone.count(), (n) => n === 1, "the one that was taken away");
    assert.match(await gone.textContent(), /until [\d.]+ s: .*kPa.*kN.*m³ overtopped it/);
    const report = await server.text("scenarios/A/exports/report.html");
    assert.match(report, /Removed during the run: barrier \d+ at /);
    await restart();
    await until(() => gone.count(), (n) => n === 0, "nothing after a restart");
  });
  await page.context().close();
  await server.stop();
}
