// What the script of the twin's page costs while debris moves; no test, since it depends on the machine.
// Usage: node page_speed.mjs TALUS serve --json --port 0 SCENE. TALUS_LOOK=scientific: in that look, otherwise in the natural one;
// TALUS_SITE=FOLDER: with another build of the page, such as `npx vite build --minify false --outDir FOLDER`, whose functions have names.
// Without a graphics card the pixels are drawn by the processor, in another process; the figures here are the page's own script and what
// it hands to WebGL, which do not depend on the number of pixels, so that there are few of them. TALUS_DRAW=0: nothing is drawn, so that
// the script has the processor to itself as beside a card; all but the draw calls themselves is done.
import { tmpdir } from "node:os";
import { join } from "node:path";
import { chromium } from "playwright-core";
import { Run, startServer, until } from "./twin/harness.mjs";

const browser = await chromium.launch({ executablePath: process.env.TALUS_BROWSER ?? "/usr/bin/chromium", args: ["--headless", "--no-sandbox",
  "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--no-first-run", "--disable-features=LocalNetworkAccessChecks"] });
if (process.env.TALUS_DRAW === "0") {
  const newContext = browser.newContext.bind(browser);
  browser.newContext = async (options) => {
    const context = await newContext(options);
    await context.addInitScript(() => {
      for (const name of ["drawArrays", "drawElements", "drawArraysInstanced", "drawElementsInstanced", "drawRangeElements"]) {
        WebGL2RenderingContext.prototype[name] = () => {};
      }
    });
    return context;
  };
}
const server = await startServer(process.argv.slice(2));
/** Figures of so many pictures, one after the other. */
const pictures = (page, count) => page.evaluate((wanted) => new Promise((resolve) => {
  const seen = [];
  const end = performance.now() + 150_000; // a run that has ended draws no more
  let last = window.talusStats.frames;
  const look = () => {
    const { frames, script_ms, draw_ms, unfold_ms, upload_ms, particles, drawCalls, detail } = window.talusStats;
    if (frames !== last) seen.push({ script_ms, draw_ms, unfold_ms, upload_ms, particles, drawCalls, detail });
    last = frames;
    if (seen.length < wanted && performance.now() < end) requestAnimationFrame(look);
    else resolve(seen);
  };
  look();
}), count);

try {
  const run = new Run(browser, join(tmpdir(), "talus_page_speed"));
  const page = await run.open(server.controller, { name: "Ada", finest: true, look: process.env.TALUS_LOOK ?? "natural", sharp: true, scale: 0.25, opening: true, reduced: false });
  console.log(`first picture    ${page.firstPicture_ms} ms after opening the link`);
  await page.selectOption("select[aria-label^=Speed]", "0.5");  // leaves the page a core
  await page.click(".run");
  await until(() => page.evaluate(() => window.talusStats.shownTime_s), (t) => t > 1, "debris on its way");
  await pictures(page, 60);  // the browser compiles what is called often
  const from = performance.now();
  const seen = await pictures(page, 150);
  const rate = seen.length / (performance.now() - from) * 1e3;
  // Everything that is allocated meanwhile, also what does not last; buffers of messages lie outside this heap.
  const inspector = await page.context().newCDPSession(page);
  await inspector.send("HeapProfiler.startSampling", { samplingInterval: 2048, includeObjectsCollectedByMajorGC: true, includeObjectsCollectedByMinorGC: true });
  const sampled = (await pictures(page, 100)).length;
  if (sampled === 0) throw new Error("no picture was drawn meanwhile: the run is over, or the machine is too slow");
  const { profile } = await inspector.send("HeapProfiler.stopSampling");
  const drawing = new Map();
  let all = 0;
  const walk = (node, drawn) => {
    const { functionName, url, lineNumber, columnNumber } = node.callFrame;
    const within = drawn || (functionName === "tick" && /page-/.test(url));  // of the stage: all of a picture
    all += node.selfSize;
    if (within && node.selfSize > 0) {
      const place = `${functionName || "(no name)"} ${url.split("/").at(-1)}:${lineNumber + 1}:${columnNumber + 1}`;
      drawing.set(place, (drawing.get(place) ?? 0) + node.selfSize);
    }
    for (const child of node.children) walk(child, within);
  };
  walk(profile.head, false);
  const of = (key) => seen.map((p) => p[key]).sort((a, b) => a - b);
  const told = (key, what) => {
    const sorted = of(key);
    const at = (share) => sorted[Math.floor(share * (sorted.length - 1))].toFixed(2);
    console.log(`${what}  median ${at(0.5)} ms, 95th percentile ${at(0.95)} ms`);
  };
  console.log(`particles        ${seen.at(-1).particles}, detail ${seen.at(-1).detail}, ${seen.length} pictures`);
  console.log(`pictures         ${rate.toFixed(0)} a second`);
  console.log(`draw calls       ${Math.max(...of("drawCalls"))} at most`);
  const bytes = [...drawing].sort((a, b) => b[1] - a[1]);
  const perPicture = (size) => `${(size / sampled / 1e3).toFixed(2)} kB`;
  console.log(`allocated        ${perPicture(all)} a picture, ${perPicture(bytes.reduce((sum, [, size]) => sum + size, 0))} of it while drawing it; most of all in`);
  for (const [place, size] of bytes.slice(0, 12)) console.log(`  ${perPicture(size)}  ${place}`);
  told("script_ms", "a picture:     ");
  told("draw_ms", "  of it WebGL: ");
  told("unfold_ms", "a message:     ");
  told("upload_ms", "  its upload:  ");
} finally {
  await browser.close();
  await server.stop();
}
