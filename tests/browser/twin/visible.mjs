// Debris is seen: measured in pixels of the natural look, from the first view and from the whole scene, at three sizes and three times.
// The camera begins on the release and the valley, follows the front, and stops where somebody touches it.
import { assert, boxOf, inControl, until } from "./harness.mjs";

/** On the way, at the village, at the end. */
const times_s = [12, 37, 90];
/** At least, of the luminance of debris to that of the ground around it, as WCAG 2.2 measures contrast: what it asks of marks of one even colour is 3. */
const leastContrast = 1.8;
/** At least, between the mean colours of debris and of the ground just beside it: CIE 1976 L*a*b* (ISO/CIE 11664-4). Two browns of one lightness have less than 10. */
const leastDifference = 20;

/** CIE76 distance of two colours of bytes, sRGB (IEC 61966-2-1) under D65. */
function difference(one, other) {
  const lab = (bytes) => {
    const [r, g, b] = bytes.map((v) => (v / 255 <= 0.04045 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4));
    const xyz = [(0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505, 0.2126 * r + 0.7152 * g + 0.0722 * b, (0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089];
    const [x, y, z] = xyz.map((t) => (t > (6 / 29) ** 3 ? Math.cbrt(t) : t / (3 * (6 / 29) ** 2) + 4 / 29));
    return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
  };
  const [a, b] = [lab(one), lab(other)];
  return Math.hypot(...a.map((v, k) => v - b[k]));
}

/**
 * Debris in a picture, against one from the same place before it came: the pixels that became clearly darker, and the ground within 12 pixels of
 * them that did not change. Luminances are linear, 0 to 1; colours are means of bytes.
 */
async function debrisIn([before, after]) {
  const [a, b] = await Promise.all([before, after].map(async (data) => {
    const bitmap = await createImageBitmap(new Blob([Uint8Array.from(atob(data), (c) => c.charCodeAt(0))], { type: "image/png" }));
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
    context.drawImage(bitmap, 0, 0);
    return context.getImageData(0, 0, bitmap.width, bitmap.height);
  }));
  const { width, height } = a;
  const linear = Float32Array.from({ length: 256 }, (_, v) => (v / 255 <= 0.04045 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4));
  const light = (d, k) => 0.2126 * linear[d[4 * k]] + 0.7152 * linear[d[4 * k + 1]] + 0.0722 * linear[d[4 * k + 2]];
  const changed = new Uint8Array(width * height), dark = new Uint8Array(width * height);
  for (let k = 0; k < width * height; ++k) {
    const by = [0, 1, 2].reduce((sum, c) => sum + Math.abs(a.data[4 * k + c] - b.data[4 * k + c]), 0);
    changed[k] = by > 24;
    dark[k] = by > 24 && light(b.data, k) < light(a.data, k);
  }
  const near = new Uint8Array(width * height);
  const reach = 12;
  const debris = { count: 0, light: 0, red: 0, green: 0, blue: 0 };
  const ground = { count: 0, light: 0, red: 0, green: 0, blue: 0 };
  for (let k = 0; k < width * height; ++k) {
    if (!dark[k]) continue;
    ++debris.count;
    debris.light += light(b.data, k);
    debris.red += b.data[4 * k];
    debris.green += b.data[4 * k + 1];
    debris.blue += b.data[4 * k + 2];
    const [x, y] = [k % width, Math.floor(k / width)];
    for (let v = Math.max(0, y - reach); v <= Math.min(height - 1, y + reach); v += 3) for (let u = Math.max(0, x - reach); u <= Math.min(width - 1, x + reach); u += 3) near[v * width + u] = 1;
  }
  for (let k = 0; k < width * height; ++k) {
    if (!near[k] || changed[k]) continue;
    ++ground.count;
    ground.light += light(b.data, k);
    ground.red += b.data[4 * k];
    ground.green += b.data[4 * k + 1];
    ground.blue += b.data[4 * k + 2];
  }
  const [mud, around] = [debris.light / debris.count, ground.light / ground.count];
  return { pixels: debris.count, share: debris.count / (width * height), contrast: (around + 0.05) / (mud + 0.05), mud, around,
    colour: [debris.red, debris.green, debris.blue].map((sum) => Math.round(sum / debris.count)),
    beside: [ground.red, ground.green, ground.blue].map((sum) => Math.round(sum / ground.count)) };
}

/** Shows a time of the recording. */
async function seek(page, time_s) {
  await page.locator(".timeline").evaluate((e, t) => {
    e.value = t;
    e.dispatchEvent(new Event("input", { bubbles: true }));
  }, time_s);
  await until(() => page.evaluate(() => window.talusStats.shownTime_s), (t) => Math.abs(t - time_s) < 0.3, `${time_s} s on the page`);
}
/** The view without what stands before it. */
async function clear(page) {
  // The page's own policy allows no style element.
  await page.evaluate(() => {
    const sheet = new CSSStyleSheet();
    sheet.replaceSync(".bar, .map-marks, .labels, .front-mark, .view-foot { visibility: hidden !important; } .legends { display: none !important; }");
    document.adoptedStyleSheets.push(sheet);
  });
}
const pressed = (page) => page.evaluate(() => document.querySelector(".bar.camera [aria-pressed=true]").dataset.mode);

export async function testVisible(run) {
  const server = await run.start([], { particles: 1500 });
  const state = () => server.ask("scenarios/A/state");
  const maker = await run.open(server.controller, { name: "Vera", width: 400, height: 300 });
  await inControl(maker);
  await maker.selectOption("select[aria-label^=Speed]", "");
  await maker.click(".run");
  await until(state, (s) => s.status === "ended" || s.status === "at_rest", "the end of the run");
  await maker.context().close();
  const last_s = (await state()).time_s;

  for (const [name, width, height, most] of [["a desk", 1440, 900, 0.0025], ["a projector", 1024, 768, 0.0025], ["a phone", 390, 844, 0.004]]) {
    const page = await run.open(server.viewer, { width, height, look: "natural", sharp: true, opening: true, touch: width < 720 });
    await run.check(`on ${name} debris stands out from the ground in the first view, on its way and at rest, and is brown`, async () => {
      await clear(page);
      const box = await boxOf(page.locator(".stage canvas"));
      await seek(page, 0);
      const before = (await run.still(page, box)).png.toString("base64");
      for (const time of times_s) {
        await seek(page, Math.min(time, last_s));
        const { png } = await run.still(page, box);
        await run.shot(page, `70-${width}-${time}`);
        const found = await page.evaluate(debrisIn, [before, png.toString("base64")]);
        const deltaE = difference(found.colour, found.beside);
        const told = `${time} s: difference of colour ${deltaE.toFixed(1)}, ${JSON.stringify(found)}`;
        console.log(`        ${told}`);
        assert.ok(found.share > most, `too little of it, ${told}`);
        assert.ok(found.contrast > leastContrast, `too faint, ${told}`);
        assert.ok(deltaE >= leastDifference, `too alike, ${told}`);
        const [red, green, blue] = found.colour;
        assert.ok(red > green && green > blue, `not brown, ${told}`);
      }
    });
    await page.context().close();
  }
  await testCamera(run, server);
  await server.stop();
}

/** The places of what is named in the view: they tell where the camera is. */
const names = (page) => page.evaluate(() => Object.fromEntries([...document.querySelectorAll(".label:not(.off, .gauge, .observation)")].map((e) => [e.textContent, e.style.transform])));
/** Whether the camera is where it was: names that make room for the mark of the front come and go, the others stay. */
function assertStays(before, now) {
  const both = Object.keys(now).filter((name) => name in before);
  assert.ok(both.length > 1, `${JSON.stringify(before)} and ${JSON.stringify(now)}`);
  const pixels = (transform) => [...transform.matchAll(/-?[\d.]+/g)].map(Number);
  for (const name of both) {
    const [was, is] = [pixels(before[name]), pixels(now[name])];
    // A place between two pixels is rounded either way.
    assert.ok(was.every((v, k) => Math.abs(v - is[k]) <= 1), `the camera moved: ${name} from ${was} to ${is}`);
  }
}
/** Once the camera rests. */
async function rested(page, what) {
  let last = "";
  return until(async () => {
    await page.evaluate(() => new Promise((resolve) => setTimeout(() => requestAnimationFrame(() => requestAnimationFrame(resolve)), 250)));
    const now = await names(page);
    const same = JSON.stringify(now) === last;
    last = JSON.stringify(now);
    return { same, now };
  }, ({ same }) => same, what);
}
/** Place of the mark of the front in the view, 0 to 1; null: none. */
const markAt = (page) => page.evaluate(() => {
  const [mark, view] = [document.querySelector(".front-mark"), document.querySelector(".stage canvas").getBoundingClientRect()];
  if (!mark || mark.hidden || mark.classList.contains("off")) return null;
  const at = mark.getBoundingClientRect();
  return { x: (at.left - view.left) / view.width, y: (at.top - view.top) / view.height };
});
const inTheMiddle = (at) => at !== null && Math.abs(at.x - 0.5) < 0.2 && Math.abs(at.y - 0.5) < 0.2;

async function testCamera(run, server) {
  // In the scientific look, which is drawn in a fraction of the time: the camera is the same.
  const page = await run.open(server.viewer, { width: 1100, height: 700, opening: true, reduced: false });
  const again = page.getByRole("button", { name: "Follow the front", exact: true }).and(page.locator(".follow-again"));

  await run.check("the first view has the release and the valley below in it", async () => {
    assert.equal(await pressed(page), "follow");
    await seek(page, 0);
    await until(() => names(page), (now) => Object.keys(now).some((name) => /main failure/.test(name)) && "350" in now, "release and end of the path in the view");
    await run.shot(page, "71-opening");
  });

  await run.check("the camera glides to the front and goes with it, and the front is named", async () => {
    for (const time of [12, 28]) {
      await seek(page, time);
      await until(() => markAt(page), inTheMiddle, `the front at ${time} s in the middle of the view`);
      assert.match(await page.locator(".front-mark:visible").textContent(), /^Front [\d.]+\sm\/s$/);
    }
    await run.shot(page, "72-following");
  });

  await run.check("whoever drags the view keeps it; a button follows again", async () => {
    await rested(page, "a camera at rest");
    assert.equal(await again.isVisible(), false);
    const box = await boxOf(page.locator(".stage canvas"));
    await page.mouse.click(box.x + 0.3 * box.width, box.y + 0.6 * box.height);
    assert.equal(await pressed(page), "follow", "a click is no drag");
    await page.mouse.move(box.x + 0.3 * box.width, box.y + 0.6 * box.height);
    await page.mouse.down();
    await page.mouse.move(box.x + 0.4 * box.width, box.y + 0.6 * box.height, { steps: 4 });
    await page.mouse.up();
    assert.equal(await pressed(page), "orbit");
    const { now } = await rested(page, "the view that was chosen");
    await seek(page, 12);
    assertStays(now, (await rested(page, "the view at another time")).now);
    await again.click();
    assert.equal(await pressed(page), "follow");
    await until(() => markAt(page), inTheMiddle, "the front in the middle again");
    assert.equal(await again.isVisible(), false);
  });
  await page.context().close();

  const calm = await run.open(server.viewer, { width: 1100, height: 700, opening: true });
  await run.check("who wants no motion has a camera that stays, and the button", async () => {
    assert.equal(await pressed(calm), "orbit");
    await seek(calm, 0);
    const { now } = await rested(calm, "the first view");
    assert.ok(Object.keys(now).some((name) => /main failure/.test(name)), JSON.stringify(now));
    await seek(calm, 28);
    assertStays(now, (await rested(calm, "the view at another time")).now);
    await calm.locator(".follow-again").waitFor();
  });
  await calm.context().close();
}
