// Opens a report in Chromium from disk, as its reader would, and looks at what is there.
// Usage: node report_test.mjs REPORT.html OUTPUT_FOLDER. Exit code 77: skipped, the browser or its driver is missing.
import assert from "node:assert/strict";
import { mkdirSync, readFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { inflateSync } from "node:zlib";
import { pathToFileURL } from "node:url";
import { end, findChromium, Score } from "./chromium.mjs";
import { within } from "./twin/harness.mjs";

const [, , reportFile, outputFolder] = process.argv;
const launch = await findChromium("report");

mkdirSync(outputFolder, { recursive: true });
const browser = await launch(["--disable-gpu"]);
const score = new Score();
const check = (name, body) => score.check(name, () => within((async () => body())(), "the end of this check"));

// Number of different colours and share of the commonest in a part of the page, read from pixels on screen.
async function colours(page, clip) {
  const png = await page.screenshot({ clip, fullPage: true });
  return page.evaluate(async (data) => {
    const picture = new Image();
    picture.src = `data:image/png;base64,${data}`;
    await picture.decode();
    const canvas = document.createElement("canvas");
    canvas.width = picture.width;
    canvas.height = picture.height;
    const context = canvas.getContext("2d");
    context.drawImage(picture, 0, 0);
    const pixels = context.getImageData(0, 0, canvas.width, canvas.height).data;
    const counts = new Map();
    let saturated = 0;
    for (let i = 0; i < pixels.length; i += 4) {
      const [r, g, b] = [pixels[i], pixels[i + 1], pixels[i + 2]];
      if (Math.max(r, g, b) - Math.min(r, g, b) > 40) ++saturated;
      const key = (r << 16) | (g << 8) | b;
      counts.set(key, (counts.get(key) ?? 0) + 1);
    }
    const total = pixels.length / 4;
    return { different: counts.size, commonest: Math.max(...counts.values()) / total, saturated: saturated / total };
  }, png.toString("base64"));
}
const pageBox = (page, element) => element.evaluate((e) => {
  const r = e.getBoundingClientRect();
  return { x: r.x + scrollX, y: r.y + scrollY, width: r.width, height: r.height };
});

const problems = [];
const requests = [];
async function open(width, height = 900) {
  const page = await browser.newPage({ viewport: { width, height } });
  page.on("console", (message) => {
    if (message.type() === "error" || message.type() === "warning") problems.push(message.text());
  });
  page.on("pageerror", (error) => problems.push(String(error)));
  page.on("request", (request) => {
    if (!request.url().startsWith("data:")) requests.push(request.url());
  });
  await page.goto(pathToFileURL(resolve(reportFile)).href);
  await page.evaluate(() => Promise.all([...document.images].map((image) => image.decode())));
  await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
  return page;
}

const page = await open(1280);
const pictures = {};

await check("every layer is chosen by its tab and shows something of its own", async () => {
  const tabs = await page.$$(".tabs button");
  assert.equal(tabs.length, 6);
  const seen = new Map();
  for (const tab of tabs) {
    await tab.click();
    const figures = await page.$$(".maps figure:visible");
    assert.equal(figures.length, 1, "exactly one map is visible");
    const layer = await figures[0].getAttribute("data-layer");
    assert.equal(layer, await tab.getAttribute("data-layer"));
    const image = await figures[0].$("image.layer");
    const picture = await page.screenshot({ clip: await pageBox(page, image), fullPage: true });
    pictures[layer] = picture;
    const key = picture.toString("base64");
    assert.ok(!seen.has(key), `${layer} looks like ${seen.get(key)}`);
    seen.set(key, layer);
  }
});

await check("maps are not blank: relief has many greys, the flow is in colour, every layer", async () => {
  for (const tab of await page.$$(".tabs button")) {
    await tab.click();
    const figure = await page.$(".maps figure:visible");
    const found = await colours(page, await pageBox(page, await figure.$("svg.figure")));
    assert.ok(found.different > 200, `only ${found.different} colours`);
    assert.ok(found.commonest < 0.5, `${Math.round(100 * found.commonest)} % of the map has one colour`);
    assert.ok(found.saturated > 0.02, "no flow in colour");
  }
});

await check("opacity changes what is seen", async () => {
  await page.click('.tabs button[data-layer="peak_depth"]');
  await page.fill("#opacity", "20");
  const image = await page.$(".maps figure:visible image.layer");
  const faint = await page.screenshot({ clip: await pageBox(page, image), fullPage: true });
  assert.ok(!faint.equals(pictures["peak_depth"]), "a faint layer looks like a strong one");
  await page.fill("#opacity", "82");
});

await check("the pointer reads coordinates, ground and value", async () => {
  await page.click('.tabs button[data-layer="peak_depth"]');
  const observation = await page.evaluate(() => {
    const data = JSON.parse(document.getElementById("map-data").textContent);
    return { data: { left: data.left, top: data.top, scale: data.scale, x_min: data.x_min, y_max: data.y_max } };
  });
  const svg = await page.$(".maps figure:visible svg.figure");
  await svg.scrollIntoViewIfNeeded();
  const box = await svg.boundingBox();
  const shown = await svg.evaluate((e) => e.viewBox.baseVal.width);
  const { data } = observation;
  const east = 824205, north = 825648;  // on the sample's flow path
  const k = box.width / shown;
  await page.mouse.move(box.x + k * (data.left + (east - data.x_min) * data.scale),
    box.y + k * (data.top + (data.y_max - north) * data.scale));
  const text = await page.textContent(".read-out");
  assert.match(text, /E 82420[45]\.\d m/);
  assert.match(text, /N 82564[78]\.\d m/);
  const ground = Number(text.match(/ground ([\d.]+) m/)?.[1]);
  assert.ok(ground > 80 && ground < 120, text);
  const depth = Number(text.match(/peak depth ([\d.]+) m/)?.[1]);
  assert.ok(depth > 0.5 && depth < 4, text);
});

await check("plots are drawn", async () => {
  for (const section of ["#front", "#time"]) {
    const found = await colours(page, await pageBox(page, await page.$(`${section} svg.figure`)));
    assert.ok(found.different > 50, `${section}: only ${found.different} colours`);
  }
  assert.equal(await page.$$eval("#front svg path.observation", (e) => e.length), 2);
  // Every run that ended is drawn twice, over chainage as velocity and as arrival, in a colour or dashing of its own.
  for (const [section, runs] of [["#convergence", 3], ["#sensitivity", 11]]) {
    const looks = await page.$$eval(`${section} svg.figure path.series`, (paths) => paths.map((path) => {
      const style = getComputedStyle(path);
      return `${style.stroke} ${style.strokeDasharray}`;
    }));
    assert.equal(looks.length, 2 * runs, section);
    assert.equal(new Set(looks).size, runs, `${section}: runs that look alike`);
  }
});

await check("text in pictures stays inside them", async () => {
  for (const tab of await page.$$(".tabs button")) {
    await tab.click();
    const outside = await page.$$eval("svg.figure", (figures) => figures.flatMap((figure) => {
      const f = figure.getBoundingClientRect();
      if (f.width === 0) return [];
      const legend = figure.querySelector('use[href="#map-key"]')?.getBBox();
      const room = figure.viewBox.baseVal;
      const cut = legend && (legend.x + legend.width > room.width + 1 || legend.y + legend.height > room.height + 1);
      const texts = [...figure.querySelectorAll("text")].filter((t) => {
        const r = t.getBoundingClientRect();
        return r.left < f.left - 1 || r.right > f.right + 1 || r.top < f.top - 1 || r.bottom > f.bottom + 1;
      }).map((t) => t.textContent);
      return cut ? [...texts, `legend to ${legend.x + legend.width}, ${legend.y + legend.height}`] : texts;
    }));
    assert.deepEqual(outside, []);
  }
});

for (const width of [1280, 800]) {
  await check(`no sideways scrolling at ${width} px`, async () => {
    const narrow = await open(width);
    const content = await narrow.evaluate(() => document.documentElement.scrollWidth);
    await narrow.screenshot({ path: join(outputFolder, `report-${width}.png`), fullPage: true });
    await narrow.close();
    assert.ok(content <= width, `content is ${content} px wide`);
  });
}

await check("without scripts every map is shown", async () => {
  const context = await browser.newContext({ javaScriptEnabled: false, viewport: { width: 1280, height: 900 } });
  const plain = await context.newPage();
  await plain.goto(pathToFileURL(resolve(reportFile)).href);
  assert.equal(await plain.locator(".maps figure:visible").count(), 6);
  await context.close();
});

await check("prints to A4 with all maps, on a sane number of pages", async () => {
  const file = join(outputFolder, "report.pdf");
  await page.pdf({ path: file, preferCSSPageSize: true, printBackground: true });
  const pdf = readFileSync(file);
  const text = pdf.toString("latin1");
  // Page objects may stand in compressed object streams; those are unpacked first.
  let all = text;
  for (const match of text.matchAll(/\/Type\s*\/ObjStm[^]*?stream\r?\n/g)) {
    try {
      all += inflateSync(pdf.subarray(match.index + match[0].length)).toString("latin1");
    } catch {
      // not a stream that this test needs
    }
  }
  const pages = all.match(/\/Type\s*\/Page\b(?!s)/g)?.length ?? 0;
  assert.ok(pages >= 6 && pages <= 14, `${pages} pages`);
  const box = all.match(/\/MediaBox\s*\[\s*0\s+0\s+([\d.]+)\s+([\d.]+)/);
  assert.ok(Math.abs(box[1] - 595) < 2 && Math.abs(box[2] - 842) < 2, `page of ${box[1]} x ${box[2]} pt`);
  await page.emulateMedia({ media: "print" });
  assert.equal((await page.$$(".maps figure:visible")).length, 6);
  assert.equal((await page.$$(".controls:visible")).length, 0);
});

await check("the console is silent", () => assert.deepEqual(problems, []));
await check("nothing but the file itself is asked for", () => {
  const file = pathToFileURL(resolve(reportFile)).href;
  assert.deepEqual(requests.filter((url) => url !== file), []);
});

await browser.close();
end(score);
