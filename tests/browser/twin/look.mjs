// The natural look, on a server of its own: bright and dark enough at every hour, and away with a key.
import { mkdirSync } from "node:fs";
import { join } from "node:path";
import { writeGully } from "./gully.mjs";
import { assert, boxOf, clickGround, inControl, saved, until } from "./harness.mjs";

/** Light and colours of a picture: shares of nearly white and nearly black pixels, mean lightness of 255, mean of red over blue. */
async function lightOf(data) {
  const bitmap = await createImageBitmap(new Blob([Uint8Array.from(atob(data), (c) => c.charCodeAt(0))], { type: "image/png" }));
  const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
  context.drawImage(bitmap, 0, 0);
  const { data: pixels } = context.getImageData(0, 0, bitmap.width, bitmap.height);
  let [white, black, sum, red, blue] = [0, 0, 0, 0, 0];
  for (let k = 0; k < pixels.length; k += 4) {
    const light = 0.3 * pixels[k] + 0.6 * pixels[k + 1] + 0.1 * pixels[k + 2];
    white += light > 250;
    black += light < 6;
    sum += light;
    red += pixels[k];
    blue += pixels[k + 2];
  }
  const count = pixels.length / 4;
  return { white: white / count, black: black / count, mean: sum / count, warm: red / Math.max(1, blue) };
}

/** Share of pixels in which two pictures clearly differ. */
async function differing(pictures) {
  const [a, b] = await Promise.all(pictures.map(async (data) => {
    const bitmap = await createImageBitmap(new Blob([Uint8Array.from(atob(data), (c) => c.charCodeAt(0))], { type: "image/png" }));
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
    context.drawImage(bitmap, 0, 0);
    return context.getImageData(0, 0, bitmap.width, bitmap.height).data;
  }));
  let count = 0;
  for (let k = 0; k < a.length; k += 4) count += Math.abs(a[k] - b[k]) + Math.abs(a[k + 1] - b[k + 1]) + Math.abs(a[k + 2] - b[k + 2]) > 24;
  return count / (a.length / 4);
}

/** Level ground at 0 m is the sea. */
async function testSea(run) {
  const folder = join(run.output, "sea");
  mkdirSync(folder, { recursive: true });
  const server = await run.start([], { scene: writeGully(folder, true), particles: null });
  const page = await run.open(server.controller, { name: "Sol", look: "natural", width: 740, height: 500 });
  await run.check("the sea is drawn as water, not as lawn", async () => {
    await page.click("[aria-label='Top view']");
    await page.locator("label:has-text('Names') input").uncheck();
    const box = await boxOf(page.locator(".stage canvas"));
    // The terrain is 100 m by 50 m in the middle of the plan: its last third to the east is level.
    const metre = box.width / 100;
    await until(async () => (await run.colours(page, { x: box.x + 0.5 * box.width + 18 * Math.min(metre, 3), y: box.y + 0.55 * box.height, width: 30, height: 30 })).bluish, (share) => share > 0.9, "blue");
    await run.shot(page, "61-sea");
  });
  await page.context().close();
  await server.stop();
}

export async function testLook(run) {
  const own = await run.start(["--set", "solver.end_time_s=8"]);
  const page = await run.open(own.controller, { name: "Iris", look: "natural", width: 740, height: 500 });
  await inControl(page);
  await page.locator("label:has-text('Names') input").uncheck();
  // Beside the scale and the compass, without the bars: all of it is sky and ground.
  const box = await boxOf(page.locator(".stage canvas"));
  const clip = { x: box.x + 0.1 * box.width, y: box.y + 0.15 * box.height, width: 0.6 * box.width, height: 0.7 * box.height };
  const clear = () => document.querySelectorAll(".bar").forEach((bar) => (bar.style.opacity = 0));
  await page.evaluate(clear);
  const bright = async (picture) => {
    const light = await page.evaluate(lightOf, picture.png.toString("base64"));
    const told = JSON.stringify(light);
    assert.ok(light.white < 0.02, `overexposed: ${told}`);
    assert.ok(light.black < 0.02, `black: ${told}`);
    assert.ok(light.mean > 45 && light.mean < 190, `mean: ${told}`);
    return light;
  };

  let plain;
  await run.check("the page begins with the natural look: neither white nor black, at noon, at sunrise and at night", async () => {
    assert.equal(await page.locator("label:has-text('Natural') input").isChecked(), true);
    plain = await run.still(page, clip);
    assert.ok(plain.different > 2000, `${plain.different} colours`);
    const noon = await bright(plain);
    const seen = [plain.hash];
    for (const [moment, name] of [["2027-06-21T06:00", "50-sunrise"], ["2027-12-21T00:30", "51-night"]]) {
      await page.fill("[aria-label='Date and solar time of the light']", moment);
      const picture = await run.changed(page, clip, seen, moment);
      await run.shot(page, name);
      const light = await bright(picture);
      if (name === "50-sunrise") assert.notEqual(light.warm.toFixed(2), noon.warm.toFixed(2), "the light of sunrise");
      seen.push(picture.hash);
    }
    await page.fill("[aria-label='Date and solar time of the light']", "2027-09-22T15:00");
    await run.back(page, clip, plain, "the light of before");
  });

  await run.check("a forest that is drawn has trees, which go with its undo", async () => {
    const trees = () => page.evaluate(() => window.talusStats.trees);
    plain ??= await run.still(page, clip);
    assert.equal(await trees(), 0);
    await page.locator(".ground-group > summary").click();
    await page.click("[data-draw=zone]");
    await page.locator(".draft:visible").getByText("Forest", { exact: true }).click();
    for (const [u, v] of [[0.40, 0.42], [0.60, 0.42], [0.60, 0.58], [0.40, 0.58]]) await clickGround(page, u, v);
    await page.keyboard.press("Enter");
    const { zones: [zone] } = await until(() => own.ask("scenarios/A/setup"), ({ zones }) => zones.length === 1, "a zone");
    const stems = zone.area_m2 * zone.stem_density_pm2;
    assert.ok(stems > 20, `${stems} stems`);
    await until(trees, (count) => count > 0.4 * stems && count < 1.1 * stems, `trees of ${stems} stems`);
    const wooded = await run.colours(page, clip);
    await run.shot(page, "53-forest");
    const share = await page.evaluate(differing, [plain.png.toString("base64"), wooded.png.toString("base64")]);
    assert.ok(share > 0.02, `other pixels on ${share} of the view`);
    await page.locator(".stage canvas").focus();
    await page.keyboard.press("Control+z");
    await until(trees, (count) => count === 0, "no trees");
    await run.back(page, clip, plain, "the ground without a forest");
    await page.locator(".ground-group > summary").click();
  });

  await run.check("N changes to the colours of a legend and back; a layer is always in those colours", async () => {
    const legends = () => page.locator(".legends:visible .legend-title").allTextContents();
    assert.deepEqual(await legends(), []);
    await page.locator(".stage canvas").focus();
    await page.keyboard.press("n");
    const scientific = await run.changed(page, clip, [plain.hash], "the scientific look");
    assert.match((await legends()).join(), /Speed of debris/);
    assert.equal(await page.locator("label:has-text('Contours')").isVisible(), true);
    await page.keyboard.press("n");
    await run.back(page, clip, plain, "the natural look");
    await page.selectOption("[aria-label='Map layer on the ground']", "peak_depth");
    await page.locator(".stage canvas").focus();
    await until(() => page.locator("label:has-text('Natural') input").isChecked(), (on) => !on, "the look of the legend");
    await page.keyboard.press("n");
    assert.equal(await page.inputValue("[aria-label='Map layer on the ground']"), "none");
    await run.back(page, clip, plain, "the natural look without a layer");
    await page.keyboard.press("n");
    await run.back(page, clip, scientific, "the same colours as before");
    await page.keyboard.press("n");
    await run.back(page, clip, plain, "the natural look");
  });

  await run.check("debris leaves a trail that stays, also for who comes later, and goes with time", async () => {
    await page.selectOption("select[aria-label^=Speed]", "");
    await page.click(".run");
    await until(() => own.ask("scenarios/A/state"), (s) => s.status === "ended" || s.status === "at_rest", "the end");
    const after = await run.changed(page, clip, [plain.hash], "the debris");
    await run.shot(page, "52-debris");
    await bright(after);
    const late = await run.open(own.viewer, { look: "natural", width: 740, height: 500 });
    await late.evaluate(clear);
    await late.locator("label:has-text('Names') input").uncheck();
    const joined = await run.changed(late, clip, [plain.hash], "the trail for another person");
    const share = (a, b) => page.evaluate(differing, [a.png.toString("base64"), b.png.toString("base64")]);
    const [debris, other] = [await share(plain, after), await share(joined, after)];
    assert.ok(debris > 0.002 && other < 0.1 * debris, `debris on ${debris} of the view; another person sees ${other} otherwise`);
    await late.context().close();
    await page.evaluate(() => document.activeElement.blur());
    await page.locator(".timeline").fill("0");
    const begun = await run.changed(page, clip, [after.hash], "time 0");
    const left = await share(plain, begun); // the outline of the release is no longer dashed
    assert.ok(left < 0.5 * debris, `a trail on ${left} of the view at time 0, where debris will be on ${debris}`);
    const { drawCalls, script_ms } = await page.evaluate(() => window.talusStats);
    assert.ok(drawCalls > 0 && drawCalls < 200, `${drawCalls} draw calls`);
    assert.ok(script_ms < 50, `${script_ms} ms`); // a first picture of a busy machine; page_speed.mjs measures
  });

  await run.check("a briefing is a film that plays: as long as the flow at its speed, with its captions", async () => {
    await page.keyboard.press("n"); // far sooner drawn
    await page.evaluate(() => (window.devicePixelRatio = 1)); // a film has the pixels of the view
    await page.click("[aria-label='Fly-through video']");
    await page.selectOption("[aria-label='Speed of the video']", "10");
    await page.locator("label:has-text('whole scene') input").uncheck();
    const film = await saved(page, () => page.click("dialog button:has-text('Make the video')"));
    assert.match(film.name, /-fly-through\.webm$/);
    await page.locator("dialog").waitFor({ state: "detached" });
    const player = await (await run.browser.newContext()).newPage();
    const seen = await player.evaluate(playFilm, film.bytes.toString("base64"));
    await player.context().close();
    assert.ok(Math.abs(seen.lasts_s - 0.8) < 0.1, `${seen.lasts_s} s`);
    assert.ok(seen.width > 300 && seen.width % 2 === 0 && seen.height % 2 === 0, `${seen.width} x ${seen.height}`);
    const [first, middle, last] = seen.pictures;
    for (const { different } of seen.pictures) assert.ok(different > 200, `${different} colours`);
    assert.ok(first.sum !== middle.sum && middle.sum !== last.sum, "the camera moves");
    assert.ok(seen.pictures.every(({ captioned }) => captioned > 0.01), JSON.stringify(seen.pictures));
    assert.equal(await page.evaluate(() => document.querySelector(".live").getAttribute("aria-pressed")), "false", "the recording is where it was");
  });
  await page.context().close();
  await own.stop();
  await testSea(run);
}

/** Plays a film: its size, and how its first, middle and last picture look; captions are white on dark along the lower edge. */
async function playFilm(data) {
  const video = document.createElement("video");
  video.src = URL.createObjectURL(new Blob([Uint8Array.from(atob(data), (c) => c.charCodeAt(0))], { type: "video/webm" }));
  await new Promise((resolve, reject) => Object.assign(video, { onloadeddata: resolve, onerror: () => reject(new Error(video.error.message)) }));
  const pictures = [];
  for (const share of [0.02, 0.5, 0.98]) {
    video.currentTime = share * video.duration;
    await new Promise((resolve) => (video.onseeked = resolve));
    const context = new OffscreenCanvas(video.videoWidth, video.videoHeight).getContext("2d");
    // The picture may come a little after the event: until it is another one than before.
    let pixels;
    for (let tries = 0; tries < 100; ++tries) {
      context.drawImage(video, 0, 0);
      pixels = context.getImageData(0, 0, video.videoWidth, video.videoHeight).data;
      if (pixels.reduce((sum, value, k) => (k % 4 === 0 ? sum + value : sum), 0) !== pictures.at(-1)?.sum) break;
      await new Promise(requestAnimationFrame);
    }
    const colours = new Set();
    let [sum, white, low] = [0, 0, 0];
    for (let k = 0; k < pixels.length; k += 4) {
      colours.add((pixels[k] << 16) | (pixels[k + 1] << 8) | pixels[k + 2]);
      sum += pixels[k];
      if (k < 0.85 * pixels.length || k / 4 % video.videoWidth > 0.5 * video.videoWidth) continue;
      ++low;
      white += Math.min(pixels[k], pixels[k + 1], pixels[k + 2]) > 225;
    }
    pictures.push({ different: colours.size, sum, captioned: white / low });
  }
  return { lasts_s: video.duration, width: video.videoWidth, height: video.videoHeight, pictures };
}
