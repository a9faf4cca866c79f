// A run that a trigger starts, seen by two people who did nothing; its gauge; alarms, on a scene of its own.
import { createServer } from "node:http";
import { appendFileSync, mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { writeGully } from "./gully.mjs";
import { assert, boxOf, inControl, shownTime, until } from "./harness.mjs";

const more = `
[[inflow]]
name = "stream"
line_m = [[500018, 5200021], [500018, 5200029]]
hydrograph = "stream.csv"
[[trigger]]
name = "Stream gauge"
inflow = "stream"
discharge_limit_m3ps = 60
start_discharge_m3ps = 2
[[alarm]]
name = "Front on its way"
chainage_m = 60
distance_m = 30
message = "Clear the road."
`;

export async function testTriggers(run) {
  const folder = join(run.output, "triggers");
  mkdirSync(folder, { recursive: true });
  const file = writeGully(folder);
  writeFileSync(join(folder, "stream.csv"), "time_s,discharge_m3ps,velocity_mps\n0,0,0\n1,20,5\n10,20,5\n11,0,0\n");
  appendFileSync(file, more);
  const posts = [];
  const hook = createServer((request, response) => {
    let body = "";
    request.on("data", (piece) => (body += piece));
    request.on("end", () => {
      posts.push(JSON.parse(body));
      response.end();
    });
  });
  await new Promise((resolve) => hook.listen(0, "127.0.0.1", resolve));
  const [token, webhook] = [join(folder, "token.txt"), join(folder, "webhook.txt")];
  writeFileSync(token, "token-of-the-browser-test\n");
  writeFileSync(webhook, `http://127.0.0.1:${hook.address().port}/hook\n`);
  const server = await run.start(["--trigger-token-file", token, "--webhook-file", webhook], { scene: file, particles: null });
  const tell = async (discharge) => {
    const response = await fetch(`${server.base}api/trigger`, { method: "POST", headers: { Authorization: "Bearer token-of-the-browser-test" },
      body: JSON.stringify({ trigger: "Stream gauge", values: { discharge_m3ps: discharge }, reason: "weir 3" }) });
    assert.equal(response.status, 200, await response.text());
  };
  // Counts the tones that a page begins.
  const prepare = (page) => page.addInitScript(() => {
    window.tones = 0;
    const { start } = OscillatorNode.prototype;
    OscillatorNode.prototype.start = function (...at) {
      ++window.tones;
      return start.apply(this, at);
    };
  });
  const ada = await run.open(server.controller, { name: "Ada", width: 1024, height: 768, prepare });
  // What a test asks a page counts as a touch of it: of one that nobody has touched the browser's answer is set.
  const untouched = (page) => page.addInitScript(() => Object.defineProperty(navigator, "userActivation", { value: { hasBeenActive: false, isActive: false } }));
  const eve = await run.open(server.viewer, { name: "Eve", width: 390, height: 844, touch: true, prepare: async (page) => {
    await prepare(page);
    await untouched(page);
  } });
  await ada.mouse.click(512, 400);  // without a touch of the page browsers allow no sound

  await run.check("a gauge starts a run, and everybody sees it start and why", async () => {
    await inControl(ada);
    for (const page of [ada, eve]) assert.equal(await page.locator(".trigger-banner").isVisible(), false);
    await tell(1);
    assert.equal((await server.ask("session")).scenarios.length, 1, "too little to start it");
    await tell(12);
    for (const page of [ada, eve]) {
      const text = await until(() => page.textContent(".trigger-banner"), (t) => /Stream gauge/.test(t), "the banner");
      assert.match(text, /Scenario B: Started by trigger Stream gauge \(HTTP\) at \d\d:\d\d:\d\d: gauge 12.0.m³\/s, weir 3/);
      await until(() => page.textContent(".status"), (t) => /Running/.test(t), "the run on display");
    }
    await until(() => server.ask("scenarios/B/state"), (s) => s.time_s > 0.5, "a run that goes on");
    assert.equal((await server.ask("scenarios/A/state")).status, "paused", "the people's scenario is left alone");
    await tell(25);
    for (const page of [ada, eve]) await until(() => page.textContent(".trigger-banner"), (t) => /Gauge now 25.0.m³\/s/.test(t), "the new value");
    await run.shot(eve, "60-trigger");
  });

  await run.check("an alarm stands above the view of everybody, on a phone and at 1024, until each has acknowledged it, with a sound where one is allowed", async () => {
    for (const page of [ada, eve]) {
      await until(() => page.locator(".alarm-banner").isVisible(), (v) => v, "the banner");
      assert.match(await page.textContent(".alarm-banner"), /Alarm: Front on its way \(scenario B, [\d.]+ s, \d\d:\d\d:\d\d\)\..*before chainage 60 m.*Clear the road\./);
      const [box, { width, height }] = [await boxOf(page.locator(".alarm-banner")), page.viewportSize()];
      assert.ok(box.x >= 0 && box.y >= 0 && box.x + box.width <= width && box.y + box.height < 0.5 * height, JSON.stringify(box));
    }
    await run.shot(ada, "62-alarm-1024");
    await run.shot(eve, "63-alarm-phone");
    assert.equal(await ada.evaluate(() => window.tones), 3);
    assert.equal(await eve.evaluate(() => window.tones), 0, "she has not touched the page");
    await ada.click(".alarm-banner button");
    await until(() => ada.locator(".alarm-banner").isVisible(), (v) => !v, "acknowledged");
    assert.equal(await eve.locator(".alarm-banner").isVisible(), true, "by Ada alone");
    await eve.tap(".alarm-banner button");
    await until(() => eve.locator(".alarm-banner").isVisible(), (v) => !v, "acknowledged on the phone");
  });

  await run.check("an alarm is listed for everybody with what came of it, and is sent once", async () => {
    for (const page of [ada, eve]) {
      const text = await until(() => page.textContent(".alarms .alarm").catch(() => ""), (t) => /sent to 127/.test(t), "the alarm");
      assert.match(text, /Front on its way scenario B, [\d.]+ s, \d\d:\d\d:\d\d.*before chainage 60 m.*Clear the road\..*run [0-9a-f]{16}/);
      assert.equal(await page.locator("[data-tab=alarms]").getAttribute("aria-selected"), "true");
    }
    assert.equal(posts.length, 1);
    assert.equal(posts[0].trigger, "Stream gauge");
    assert.match(posts[0].hash, /^[0-9a-f]{16}$/);
    await run.shot(ada, "61-alarm");
    const mark = ada.locator(".alarm-mark");
    assert.equal(await mark.count(), 1);
    const [raised] = (await server.ask("alerts")).alarms;
    assert.equal(await mark.getAttribute("aria-label"), `Alarm Front on its way, ${raised.time_s.toFixed(1)} s`);
    assert.match(await mark.getAttribute("title"), /chainage 60 m/);
    const [line, at] = [await boxOf(ada.locator(".timeline")), await boxOf(mark)];
    const { end_time_s } = await server.ask("scenarios/B/state");
    const expected = line.x + 7 + (raised.time_s / end_time_s) * (line.width - 14);
    assert.ok(Math.abs(at.x + at.width / 2 - expected) < 1.5, `the mark is at ${at.x + at.width / 2}, ${expected} was expected`);
    await mark.click();
    await until(() => shownTime(ada), (t) => Math.abs(t - raised.time_s) < 0.06, "the recording at the time of the alarm");
    assert.equal(await eve.locator(".alarm-mark").count(), 1);
    await ada.click("button.live");
    await ada.locator(".trigger-banner [title=Close], .trigger-banner [aria-label=Close]").first().click();
    await until(() => ada.locator(".trigger-banner").isVisible(), (v) => !v, "the banner closed");
    assert.equal(await eve.locator(".trigger-banner").isVisible(), true, "for Ada alone");
    await ada.reload();
    await ada.waitForSelector(".transport");
    await until(() => ada.locator(".alarms .alarm").count(), (n) => n === 1, "the alarm in the list");
    assert.equal(await ada.locator(".alarm-banner").isVisible(), false, "still acknowledged");
  });
  await ada.context().close();
  await eve.context().close();
  await server.stop();
  hook.close();
}
