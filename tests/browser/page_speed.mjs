// What the script of the twin's page costs while debris moves; no test, since it depends on the machine.
// Usage: node page_speed.mjs TALUS serve --json --port 0 SCENE; TALUS_LOOK=scientific: in that look, otherwise in the natural one. Without a graphics card the pixels are drawn by
// the processor, in another process; the figures here are the page's own script and what it hands to WebGL.
import { tmpdir } from "node:os";
import { join } from "node:path";
import { chromium } from "playwright-core";
import { Run, startServer, until } from "./twin/harness.mjs";

const browser = await chromium.launch({ executablePath: process.env.TALUS_BROWSER ?? "/usr/bin/chromium", args: ["--headless", "--no-sandbox",
  "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--no-first-run"] });
const server = await startServer(process.argv.slice(2));
try {
  const run = new Run(browser, join(tmpdir(), "talus_page_speed"));
  const page = await run.open(server.controller, { name: "Ada", finest: true, look: process.env.TALUS_LOOK ?? "natural" });
  console.log(`first picture    ${page.firstPicture_ms} ms after opening the link`);
  await page.selectOption("select[aria-label^=Speed]", "");
  await page.click(".run");
  await until(() => page.evaluate(() => window.talusStats.shownTime_s), (t) => t > 1, "debris on its way");
  // Everything that is allocated meanwhile, also what does not last; buffers of messages lie outside this heap.
  const inspector = await page.context().newCDPSession(page);
  await inspector.send("HeapProfiler.startSampling", { samplingInterval: 4096, includeObjectsCollectedByMajorGC: true, includeObjectsCollectedByMinorGC: true });
  const seen = await page.evaluate(() => new Promise((resolve) => {
    const pictures = [];
    const end = performance.now() + 120_000; // a run that has ended draws no more
    let last = window.talusStats.frames;
    const look = () => {
      const { frames, script_ms, draw_ms, unfold_ms, upload_ms, particles, drawCalls } = window.talusStats;
      if (frames !== last) pictures.push({ script_ms, draw_ms, unfold_ms, upload_ms, particles, drawCalls });
      last = frames;
      if (pictures.length < 150 && performance.now() < end) requestAnimationFrame(look);
      else resolve(pictures);
    };
    look();
  }));
  const { profile } = await inspector.send("HeapProfiler.stopSampling");
  const places = new Map();
  let drawing = 0;
  const walk = (node, drawn) => {
    const within = drawn || (node.callFrame.functionName === "tick" && /page-/.test(node.callFrame.url));  // of the stage: all of a picture
    if (within) drawing += node.selfSize;
    const { functionName, url, lineNumber, columnNumber } = node.callFrame;
    const place = `${functionName || "(no name)"} ${url.split("/").at(-1)}:${lineNumber}:${columnNumber}`;
    places.set(place, (places.get(place) ?? 0) + node.selfSize);
    for (const child of node.children) walk(child, within);
  };
  walk(profile.head, false);
  const of = (key) => seen.map((p) => p[key]).sort((a, b) => a - b);
  const told = (key, what) => {
    const sorted = of(key);
    const at = (share) => sorted[Math.floor(share * (sorted.length - 1))].toFixed(2);
    console.log(`${what}  median ${at(0.5)} ms, 95th percentile ${at(0.95)} ms`);
  };
  console.log(`particles        ${seen.at(-1).particles}`);
  console.log(`draw calls       ${Math.max(...of("drawCalls"))} at most`);
  const most = [...places].sort((a, b) => b[1] - a[1]);
  console.log(`allocated        ${(most.reduce((sum, [, bytes]) => sum + bytes, 0) / seen.length / 1e3).toFixed(1)} kB a picture, ${(drawing / seen.length / 1e3).toFixed(1)} kB of it while drawing it; most of all in`);
  for (const [place, bytes] of most.slice(0, 6)) console.log(`  ${(bytes / seen.length / 1e3).toFixed(1)} kB  ${place}`);
  told("script_ms", "a picture:     ");
  told("draw_ms", "  of it WebGL: ");
  told("unfold_ms", "a message:     ");
  told("upload_ms", "  its upload:  ");
} finally {
  await browser.close();
  await server.stop();
}
