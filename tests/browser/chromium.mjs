// What the tests in a browser share: Chromium, the score of their checks, and a web server.
import { existsSync, readFileSync, statSync } from "node:fs";
import { createServer } from "node:http";
import { extname, join } from "node:path";

/** WebGL without a graphics card: SwiftShader has to be asked for. Smooth edges would take it twice as long, and so would the page around the view. */
export const softwareWebGL = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--webgl-msaa-sample-count=0", "--disable-gpu-compositing"];

export function skip(test, reason) {
  console.log(`SKIPPED browser.${test}: ${reason}`);
  process.exit(77);
}
/** A function that starts Chromium with further arguments; without Chromium or its driver the test is skipped. */
export async function findChromium(test) {
  const executablePath = process.env.TALUS_BROWSER ?? "/usr/bin/chromium";
  if (!existsSync(executablePath)) skip(test, `no browser at ${executablePath}; install chromium or set TALUS_BROWSER`);
  const driver = await import("playwright-core").catch(() => skip(test, "playwright-core is not installed; run `npm ci` in tests/browser"));
  const quiet = ["--headless", "--no-sandbox", "--disable-background-networking", "--disable-component-update", "--no-first-run"];
  return (args) => driver.chromium.launch({ executablePath, args: [...quiet, ...args] });
}

/**
 * Without a graphics card pictures take all of the processor that they get. Ten a second show as much to a test as sixty, and views (not the page
 * around them, whose text stays where it is) have half as many pixels a side unless they are `sharp`.
 */
export async function contextOf(browser, options, sharp = false) {
  const context = await browser.newContext(options);
  await context.addInitScript((least_ms) => {
    const ask = window.requestAnimationFrame.bind(window);
    window.requestAnimationFrame = (draw) => setTimeout(() => ask(draw), least_ms);
  }, 100);
  if (!sharp) await context.addInitScript(() => Object.defineProperty(window, "devicePixelRatio", { value: 0.5, writable: true }));
  return context;
}

export class Score {
  passed = 0;
  failed = 0;
  check = async (name, work) => {
    try {
      await work();
      ++this.passed;
      console.log(`ok      ${name}`);
    } catch (error) {
      ++this.failed;
      console.log(`FAILED  ${name}\n${error.stack ?? error}`);
    }
  };
}
/** Ends the test; one without a check has failed. */
export function end({ passed, failed }) {
  console.log(`${passed} passed, ${failed} failed`);
  process.exit(failed === 0 && passed > 0 ? 0 : 1);
}

/** A server at an address of this computer, `base`. */
export async function serve(answer) {
  const server = createServer(answer);
  await new Promise((done) => server.listen(0, "127.0.0.1", done));
  return { base: `http://127.0.0.1:${server.address().port}/`, close: () => server.close() };
}
const types = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".wasm": "application/wasm", ".json": "application/json" };
/** A server of the files in a folder. */
export const serveFolder = (folder) => serve((request, response) => {
  const path = join(folder, decodeURIComponent(new URL(request.url, "http://localhost").pathname).replace(/\/$/, "/index.html"));
  if (!existsSync(path) || !statSync(path).isFile()) return response.writeHead(404).end();
  response.writeHead(200, { "Content-Type": types[extname(path)] ?? "application/octet-stream" }).end(readFileSync(path));
});
