// Starts a server of the twin and browsers that look at it, and keeps the score.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { createHash } from "node:crypto";
import { existsSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { inflateRawSync } from "node:zlib";
import { contextOf } from "../chromium.mjs";

/// Without the variables of this test, which the program does not know and refuses.
export const programEnvironment = Object.fromEntries(Object.entries(process.env).filter(([name]) => !/^TALUS_(?!DATA$|SIMD$)/.test(name)));

/** What has not come after so long does not come: nothing is measured by it, and only a failing test waits for it. */
export const limit_ms = 1000 * Number(process.env.TALUS_WAIT_S ?? 300);
/** A check as a whole, with all its waits. */
const longest_check_ms = 600_000;
/** What is or was waited for last. */
let lastWait = "nothing";
export const waitedFor = () => lastWait;

/** What a promise gives; an error that says what was waited for if that does not come. */
export async function within(promise, what, most_ms = limit_ms) {
  lastWait = what;
  let timer;
  const late = new Promise((_, reject) => {
    timer = setTimeout(() => reject(new Error(`${what}: not within ${most_ms / 1000} s; last waited for: ${lastWait}`)), most_ms);
  });
  try {
    return await Promise.race([promise, late]);
  } finally {
    clearTimeout(timer);
  }
}
/** Waits for a condition in the page, also over the loading of another. */
export async function shows(page, condition, what) {
  lastWait = what;
  await page.waitForFunction(condition).catch((error) => {
    throw new Error(`${what}: ${error.message}`);
  });
}
/** What a server says; past the page. */
async function asked(url, token) {
  const answer = await within(fetch(url, { headers: { Authorization: `Bearer ${token}` } }).then(async (response) => ({ status: response.status, text: await response.text() })), url);
  assert.equal(answer.status, 200, `${url}: ${answer.text}`);
  return answer.text;
}

/** Starts a program that prints one line of JSON with controller_url and viewer_url. */
export async function startServer(command) {
  const process_ = spawn(command[0], command.slice(1), { env: programEnvironment, stdio: ["ignore", "pipe", "pipe"] });
  let told = "";
  process_.stderr.on("data", (data) => (told += data));
  const ended = new Promise((resolve) => process_.once("exit", resolve));
  const links = await within(new Promise((resolve, reject) => {
    createInterface({ input: process_.stdout }).on("line", (line) => line.startsWith("{") && resolve(JSON.parse(line)));
    void ended.then((code) => reject(new Error(`the server ended with ${code}: ${told}`)));
  }), `the links of ${command.join(" ")}`);
  const token = new URL(links.controller_url).hash.slice(7);
  const viewerToken = new URL(links.viewer_url).hash.slice(7);
  const base = links.controller_url.split("#")[0];
  return {
    controller: links.controller_url, viewer: links.viewer_url, token, viewerToken, base, port: Number(new URL(base).port),
    /** Its exit code, once it ends by itself. */
    end: () => within(ended, "the end of the program"),
    text: (path) => asked(`${base}api/${path}`, token),
    ask: async (path) => JSON.parse(await asked(`${base}api/${path}`, token)),
    async stop() {
      if (process_.exitCode !== null) return;
      process_.kill("SIGTERM");
      setTimeout(() => process_.kill("SIGKILL"), 5000).unref();
      await ended;
    },
  };
}

const types = { js: "text/javascript", css: "text/css", html: "text/html", svg: "image/svg+xml" };
/** Answers requests for the page's files from a folder. */
export async function serveFrom(page, folder) {
  await page.route((url) => !url.pathname.startsWith("/api"), (route) => {
    const path = join(folder, new URL(route.request().url()).pathname.replace(/\/$/, "/index.html"));
    return existsSync(path) ? route.fulfill({ body: readFileSync(path), contentType: types[path.split(".").at(-1)] }) : route.continue();
  });
}

/** A mesh of the ground that is drawn in a fraction of the time. pages: one, or a context. */
export const coarseGround = (pages) => pages.route(/\/api\/terrain/, (route) => route.continue({ url: route.request().url().replace(/max_cells=\d+/, "max_cells=8000") }));

export class Run {
  passed = 0;
  failed = 0;
  problems = [];
  requests = [];
  servers = [];

  /** command: how the server is started, for all parts: each starts its own. */
  constructor(browser, output, command, only) {
    Object.assign(this, { browser, output, command, only });
    mkdirSync(output, { recursive: true });
  }
  /** The command's scene is the last word. */
  get scene() {
    return this.command.at(-1);
  }
  /** A server with further arguments. Few particles show as much of the page as many; `particles`: null leaves the scene's. */
  async start(further = [], { scene = this.scene, particles = 2500, port = 0 } = {}) {
    const few = particles === null ? [] : ["--set", `solver.target_particle_count=${particles}`];
    const server = await startServer([...this.command.slice(0, -1), "--json", "--port", String(port), ...few, ...further, scene]);
    this.servers.push(server);
    return server;
  }
  async stopServers() {
    await Promise.all(this.servers.map((server) => server.stop()));
  }
  async check(name, body) {
    if (this.only && !new RegExp(this.only).test(name)) return;
    const begun = Date.now();
    try {
      await within(body(), "the end of this check", longest_check_ms);
      ++this.passed;
      console.log(`ok      ${name} (${((Date.now() - begun) / 1000).toFixed(1)} s)`);
    } catch (error) {
      ++this.failed;
      console.log(`FAILED  ${name}\n        ${String(error.message).split("\n").slice(0, 14).join("\n        ")}`);
      await this.last?.screenshot({ path: join(this.output, `failed-${this.failed}.png`), timeout: 30_000 }).catch(() => {});
    }
  }
  context(options, sharp) {
    return contextOf(this.browser, options, sharp);
  }
  /** finest: with the whole mesh of the ground; a coarser one is drawn in a fraction of the time. look: natural ones take far longer to draw without a graphics card. edits: how runs that have begun are edited; null: not chosen yet. touch: as on a phone. late: which texts of the server come late, as from a busy one. sharp: the view has as many pixels as the page around it, for checks of what people see; otherwise half as many a side, drawn in a third of the time. scale: pixels of the screen per pixel of the page; with fewer than one, text moves by whole pixels between two pictures of one view. opening: with the first view of the scene; otherwise the whole ground is shown, where places are at the same shares of the view whatever the scene holds. prepare: called with the page before it loads. TALUS_SITE=FOLDER: with another build of the page than the program's. */
  async open(link, { width = 1280, height = 720, reduced = true, name, finest = false, edits = "now", look = "scientific", touch = false, late, sharp = false, scale = 1, opening = false, prepare } = {}) {
    const context = await this.context({ viewport: { width, height }, deviceScaleFactor: scale, reducedMotion: reduced ? "reduce" : "no-preference", acceptDownloads: true, hasTouch: touch, isMobile: touch }, sharp);
    const page = await context.newPage();
    if (name) await page.addInitScript((n) => localStorage.setItem("talus-name", n), name);
    await page.addInitScript((l) => localStorage.getItem("talus-look") ?? localStorage.setItem("talus-look", l), look);
    if (edits) await page.addInitScript((habit) => sessionStorage.getItem("talus-edits") ?? sessionStorage.setItem("talus-edits", habit), edits);
    page.on("console", (message) => {
      if (["error", "warning"].includes(message.type()) && !/WebSocket connection|ERR_CONNECTION|GPU stall|GL Driver|Failed to load resource|does not answer|software WebGL/i.test(message.text())) {
        this.problems.push(message.text());
      }
    });
    page.on("pageerror", (error) => this.problems.push(error.stack ?? String(error)));
    page.on("request", (request) => {
      if (!/^(data|blob):/.test(request.url())) this.requests.push(request.url());
    });
    page.setDefaultTimeout(limit_ms);
    if (!finest) await coarseGround(page);
    if (late) {
      await page.routeWebSocket(/\/ws/, (toPage) => {
        const toServer = toPage.connectToServer();
        toServer.onMessage((message) => (typeof message === "string" && late.test(message) ? setTimeout(() => toPage.send(message), 1000) : toPage.send(message)));
      });
    }
    if (process.env.TALUS_SITE) await serveFrom(page, process.env.TALUS_SITE);
    await prepare?.(page);
    const begun = Date.now();
    await page.goto(link);
    await shows(page, () => window.talusStats?.frames > 0 && document.querySelector(".transport"), "the first picture");
    page.firstPicture_ms = Date.now() - begun;
    await shows(page, () => !document.querySelector(".connection:not([hidden])"), "the connection");
    if (!opening) await page.evaluate(() => document.querySelector("[aria-label=Fit]").click());
    this.last = page;
    return page;
  }
  /** A part of the page, once what was asked for before is drawn. */
  async picture(page, clip) {
    await within(page.evaluate(drawn), "two pictures");
    const png = await page.screenshot(clip ? { clip } : {});
    return { png, hash: createHash("sha1").update(png).digest("hex") };
  }
  /** The same with its colours, read from pixels on the screen: how many, shares of the commonest, of clear red and of clear blue. */
  async colours(page, clip) {
    return this.counted(page, await this.picture(page, clip));
  }
  async counted(page, seen) {
    return { ...seen, ...(await page.evaluate(readPixels, seen.png.toString("base64"))) };
  }
  /** Share of a part of the page that is clearly more red than green and blue. */
  async reddish(page, clip) {
    const png = await page.screenshot({ clip });
    return (await page.evaluate(readPixels, png.toString("base64"))).reddish;
  }
  /** The colours of a part of the page at rest: two looks in a row find the same picture (but for the noise of drawing the same text again, 2 of 255), all its pixels drawn, while nothing is asked of the server. */
  async still(page, clip) {
    const at = () => page.evaluate(() => {
      const { frames, pixelRatio, reads } = window.talusStats;
      return { frames, pixelRatio, begun: reads.begun, ended: reads.ended, sharpest: Math.min(2, devicePixelRatio) };
    });
    let last = null;
    const { seen } = await until(async () => {
      const before = await at();
      const seen = await this.picture(page, clip);
      const after = await at();
      const quiet = before.begun === before.ended && after.begun === before.begun && before.pixelRatio === before.sharpest && after.frames === before.frames;
      const same = quiet && last !== null && (last.hash === seen.hash || await page.evaluate(largestDifference, [last.png.toString("base64"), seen.png.toString("base64")]) <= sameShade);
      last = quiet ? seen : null;
      return { seen: same ? seen : null, quiet, before, after };
    }, ({ seen }) => seen !== null, "a view at rest");
    return this.counted(page, seen);
  }
  /** The same once it is another picture than `others`, hashes of earlier ones. */
  async changed(page, clip, others, what) {
    await until(async () => (await this.picture(page, clip)).hash, (hash) => !others.includes(hash), what);
    return this.still(page, clip);
  }
  /** The same once it is `one` again. */
  async back(page, clip, one, what) {
    let seen;
    await until(async () => {
      seen = await this.picture(page, clip);
      return seen.hash === one.hash ? 0 : page.evaluate(largestDifference, [one.png.toString("base64"), seen.png.toString("base64")]);
    }, (difference) => difference <= sameShade, what).catch((error) => {
      writeFileSync(join(this.output, "expected.png"), one.png);
      writeFileSync(join(this.output, "seen.png"), seen.png);
      throw error;
    });
  }
  async shot(page, name) {
    await page.screenshot({ path: join(this.output, `${name}.png`) });
  }
}

/** Of 255: pictures of one view may differ by so much where a mark lies between two pixels. */
const sameShade = 3;

/** Two display frames from now: what was asked for before is on the canvas, however slow the machine is. */
const drawn = () => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(() => resolve())));

async function readPixels(data) {
  const bytes = Uint8Array.from(atob(data), (c) => c.charCodeAt(0));
  const bitmap = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
  const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
  const context = canvas.getContext("2d");
  context.drawImage(bitmap, 0, 0);
  const pixels = context.getImageData(0, 0, canvas.width, canvas.height).data;
  const counts = new Map();
  let reddish = 0;
  let bluish = 0;
  for (let i = 0; i < pixels.length; i += 4) {
    const key = (pixels[i] << 16) | (pixels[i + 1] << 8) | pixels[i + 2];
    counts.set(key, (counts.get(key) ?? 0) + 1);
    reddish += pixels[i] > 1.5 * pixels[i + 1] && pixels[i] > 1.5 * pixels[i + 2];
    bluish += pixels[i + 2] > 1.5 * pixels[i];
  }
  return { reddish: reddish / (pixels.length / 4), bluish: bluish / (pixels.length / 4), different: counts.size, commonest: Math.max(...counts.values()) / (pixels.length / 4) };
}

/** Between two pictures of one size, of 255. */
async function largestDifference(pictures) {
  const [a, b] = await Promise.all(pictures.map(async (data) => {
    const bitmap = await createImageBitmap(new Blob([Uint8Array.from(atob(data), (c) => c.charCodeAt(0))], { type: "image/png" }));
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
    context.drawImage(bitmap, 0, 0);
    return context.getImageData(0, 0, bitmap.width, bitmap.height).data;
  }));
  if (a.length !== b.length) return 255;
  let most = 0;
  for (let i = 0; i < a.length; ++i) most = Math.max(most, Math.abs(a[i] - b[i]));
  return most;
}

/** The middle of the view: without bars, legends and labels' edges. */
export async function viewClip(page, scenario) {
  const box = await page.locator(scenario ? `.pane[data-scenario=${scenario}]` : ".stage canvas").boundingBox();
  return { x: box.x + 0.1 * box.width, y: box.y + 0.25 * box.height, width: 0.8 * box.width, height: 0.5 * box.height };
}
/** The height in the page, px, of the middle of a plan: it lies below the bars. */
export async function middleOfPlan(page) {
  const box = await boxOf(page.locator(".stage canvas"));
  const bars = await page.evaluate(() => Number.parseFloat(document.querySelector(".middle").style.getPropertyValue("--bars")));
  return box.y + (bars + box.height) / 2;
}
/** A click on the ground at a share of the canvas. */
export async function clickGround(page, u, v, options = {}) {
  const box = await page.locator(".stage canvas").boundingBox();
  await page.mouse.click(box.x + u * box.width, box.y + v * box.height, options);
}
/** Waits until a question has the wanted answer; says the last answer if it never has. */
export async function until(question, wanted, what) {
  const begun = Date.now();
  for (;;) {
    const answer = await within(question(), what);
    if (wanted(answer)) return answer;
    if (Date.now() - begun > limit_ms) throw new Error(`${what}: still ${JSON.stringify(answer)?.slice(0, 600)}`);
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
}
/** Where an element is, once it is there: what lies over the view comes and goes with pictures. */
export const boxOf = (locator) => until(() => locator.boundingBox({ timeout: 1000 }).catch(() => null), (box) => box !== null, String(locator));
export const inControl = (page) => until(() => page.textContent(".control"), (t) => /You have control/.test(t), "control");
/** Drags an element by so many pixels. */
export async function drag(page, locator, dx, dy) {
  const box = await boxOf(locator);
  await page.mouse.move(box.x + 6, box.y + 6);
  await page.mouse.down();
  await page.mouse.move(box.x + 6 + dx, box.y + 6 + dy, { steps: 4 });
  await page.mouse.up();
}
/** Presses Pause, unless the run ends by itself meanwhile. `state`: asks the server for the scenario's. */
export async function pause(page, state) {
  const ended = (s) => s.status !== "running";
  await until(async () => {
    // A button that is no longer Pause, or off because the run has ended, is not waited for: the server says how it is.
    if (!ended(await state())) await page.click(".run[data-face=Pause]", { timeout: 10_000 }).catch(() => {});
    return state();
  }, ended, "the pause");
}
export const shownTime = async (page) => Number((await page.textContent(".clock")).replace("−", "-").split(" ")[0]);
export async function saved(page, click) {
  const [download] = await Promise.all([page.waitForEvent("download"), click()]);
  return { name: download.suggestedFilename(), bytes: readFileSync(await within(download.path(), "the downloaded file")) };
}
/** The members of a ZIP, as its directory lists them, by name. */
export function unzipped(bytes) {
  const members = {};
  const end = bytes.lastIndexOf(Buffer.from([0x50, 0x4b, 5, 6]));
  let at = bytes.readUInt32LE(end + 16);
  for (let left = bytes.readUInt16LE(end + 10); left > 0; --left) {
    const [packed, size, local] = [bytes.readUInt16LE(at + 10) === 8, bytes.readUInt32LE(at + 20), bytes.readUInt32LE(at + 42)];
    const [name, extra, comment] = [28, 30, 32].map((k) => bytes.readUInt16LE(at + k));
    const begin = local + 30 + bytes.readUInt16LE(local + 26) + bytes.readUInt16LE(local + 28);
    const content = bytes.subarray(begin, begin + size);
    members[bytes.subarray(at + 46, at + 46 + name).toString()] = packed ? inflateRawSync(content) : content;
    at += 46 + name + extra + comment;
  }
  return members;
}
export { assert };
