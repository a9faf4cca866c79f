// A published twin in Chromium, opened from disk, with real clicks: nothing is asked for outside the file.
// Usage: node publish_test.mjs OUTPUT_FOLDER TALUS. Exit code 77: skipped, the browser or its driver is missing.
import { spawnSync } from "node:child_process";
import { existsSync, mkdirSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { contextOf, end, findChromium, Score, serve, serveFolder, softwareWebGL } from "./chromium.mjs";
import { clickGround, startServer, until } from "./twin/harness.mjs";

const [, , folder, talus] = process.argv;
const output = resolve(folder);
const launch = await findChromium("publish");
mkdirSync(output, { recursive: true });
const score = new Score();
const { check } = score;
const same = (found, wanted, what) => {
  if (found !== wanted) throw new Error(`${what}: ${found}, not ${wanted}`);
};
const run = (...options) => spawnSync(talus, options, { encoding: "utf8", cwd: output });
const small = ["--set", "solver.target_particle_count=500", "--set", "solver.end_time_s=20"];

const file = join(output, "twin.html");
const site = join(output, "site");
const made = run("publish", "-o", file, "--force", "--without-engine", ...small);
if (made.status !== 0) throw new Error(`talus publish: ${made.status}\n${made.stderr}`);
const served = run("publish", "-o", site, "--folder", "--force", "--without-engine", ...small);
if (served.status !== 0) throw new Error(`talus publish --folder: ${served.status}\n${served.stderr}`);

const browser = await launch(softwareWebGL);

/** Opens a twin; `asked`: addresses that it asked for, `problems`: what the console said. */
async function open(address, viewport, settings = {}) {
  const context = await contextOf(browser, { viewport, acceptDownloads: true, reducedMotion: "reduce", ...settings });
  const page = await context.newPage();
  const asked = [];
  const problems = [];
  page.on("request", (request) => asked.push(request.url()));
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && !/GPU stall|GL Driver/.test(message.text()) && problems.push(message.text()));
  page.on("pageerror", (error) => problems.push(error.stack ?? String(error)));
  await page.goto(address);
  await page.waitForSelector(".topbar h1", { timeout: 60_000 });
  await page.waitForFunction(() => document.querySelector(".clock")?.textContent.startsWith("0.00"), null, { timeout: 60_000 });
  return { page, asked, problems, close: () => context.close() };
}
/** Waits until `condition` holds. */
async function shown(condition) {
  while (!(await condition())) await new Promise((next) => setTimeout(next, 100));
}
const clock = (page) => page.locator(".clock").innerText().then((text) => Number.parseFloat(text));
const silent = ({ asked, problems }, own) => {
  const foreign = asked.filter((url) => !own(url));
  if (foreign.length > 0) throw new Error(`asked for ${foreign.map((url) => url.slice(0, 200)).join(", ")}`);
  if (problems.length > 0) throw new Error(problems.join("\n"));
};
/** A file of an archive that holds its files as they are. */
function fileOf(archive, name) {
  for (let at = 0; archive.readUInt32LE(at) === 0x04034b50;) {
    const [size, ofName, ofRest] = [archive.readUInt32LE(at + 18), archive.readUInt16LE(at + 26), archive.readUInt16LE(at + 28)];
    const begin = at + 30 + ofName + ofRest;
    if (archive.toString("utf8", at + 30, at + 30 + ofName) === name) return archive.toString("utf8", begin, begin + size);
    at = begin + size;
  }
  throw new Error(`${name} is not in the archive`);
}
/** The page computes: changes by clicks, runs, compares, and its journal gives the same hash in the program. */
async function testEngine(opened, address) {
  const { page } = opened;
  const row = (name) => page.locator(`button[data-scenario=${name}]`);
  const friction = page.locator(".field", { hasText: "riction" }).first().locator("input[type=number]");
  const setFriction = async (value) => {
    await friction.fill(value);
    await friction.press("Enter");
  };
  const ended = (name) => until(() => row(name).textContent(), (text) => /End reached, 4\.0 s/.test(text), `the end of ${name}`);
  await check("engine: the reader changes from the recording to computing", async () => {
    await page.getByRole("button", { name: "Change it" }).click();
    await page.waitForFunction(() => document.querySelector(".topbar h1, .boot[role=alert]"), null, { timeout: 120_000 });
    await until(() => clock(page), (time) => time === 0, "time 0");
    same(await page.getByRole("tab", { name: "Calibrate" }).filter({ visible: true }).count(), 0, "tabs Calibrate");
  });
  await check("engine: friction and a barrier are changed, and the run goes to its end", async () => {
    await setFriction("0.35");
    await page.click("[data-draw=barrier]");
    await clickGround(page, 0.4, 0.6);
    await clickGround(page, 0.55, 0.6);
    await page.keyboard.press("Enter");
    await until(() => page.locator("main.middle, aside").allInnerTexts(), (texts) => /Barrier 1|barrier-1/i.test(texts.join(" ")), "the barrier");
    await page.selectOption("select[aria-label^=Speed]", "");
    await page.click(".run");
    await ended("A");
  });
  await check("engine: another scenario is computed, and both are compared", async () => {
    await setFriction("0.2");
    await page.locator("dialog[open]").waitFor();
    await page.keyboard.press("Enter");  // a new scenario from the start
    await row("B").waitFor();
    await page.click(".run");
    await ended("B");
    await page.click("[data-tab=compare]");
    await until(() => page.locator(".comparison thead th").allTextContents(), (heads) => /^A 4\.0.s$/.test(heads[1] ?? "") && /^B 4\.0.s$/.test(heads[2] ?? ""), "both in the table");
    await page.screenshot({ path: join(output, "engine.png") });
  });
  await check("engine: the depth-averaged model computes the same setup, and its map is drawn", async () => {
    await row("A").click();
    const box = page.locator(".depth-averaged-switch input");
    await box.check();
    await until(() => page.getByLabel("Map layer on the ground").inputValue(), (layer) => layer === "depth_averaged/peak_depth", "its map");
    await page.click("[data-tab=front]");
    await until(() => page.locator("table.both-models tbody tr").count(), (rows) => rows > 3, "figures of both models");
    await page.screenshot({ path: join(output, "engine_depth_averaged.png") });
    await box.uncheck();
    await until(() => page.getByLabel("Map layer on the ground").inputValue(), (layer) => !layer.startsWith("depth_averaged"), "the map of the particles");
  });
  let archive = Buffer.alloc(0);
  await check("engine: tables, maps and journal of the run are saved", async () => {
    await row("A").click();
    await page.getByRole("button", { name: "Export" }).click();
    await page.getByLabel("All files").check();
    const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: /^Save \d+ file/ }).click()]);
    archive = readFileSync(await download.path());
    writeFileSync(join(output, "computed.zip"), archive);
    if (!/^chainage_m,[^]*\n[\d.]+,[\d.]+,/.test(fileOf(archive, "front.csv"))) throw new Error(`front.csv is\n${fileOf(archive, "front.csv")}`);
    for (const name of ["timeseries.csv", "buildings.csv"]) if (!fileOf(archive, name).includes("\n")) throw new Error(`${name} is empty`);
    for (const name of ["peak_depth.tif", "peak_speed.tif", "intensity.tif"]) same(fileOf(archive, name).slice(0, 3), "II*", name);
  });
  await check("engine: the program replays the journal of the page to the same hash", async () => {
    const text = fileOf(archive, "journal.json");
    const journal = JSON.parse(text);
    same(journal.actions.map((one) => one.action.action).join(" "), "set_parameter put_barrier", "actions");
    writeFileSync(join(output, "journal.json"), text);
    const replayed = run("replay", join(output, "journal.json"), "--scene", fileURLToPath(new URL("../../scenes/sham_tseng/scene.toml", import.meta.url)));
    same(replayed.status, 0, replayed.stderr);
    if (!replayed.stdout.includes(`hash ${journal.last.hash}`)) throw new Error(`${replayed.stdout}, the page has ${journal.last.hash}`);
  });
  await check("engine: no request leaves the page, and the console is silent", async () => silent(opened, (url) => url.split("#")[0] === address || url.startsWith("blob:") || url.startsWith("data:")));
  await check("engine: a page and its engine have at most 4 MB", async () => {
    const { size } = statSync(fileURLToPath(address));
    if (size > 4e6) throw new Error(`${size} bytes`);
  });
  await opened.close();
}
/** Of a picture of the view, as a PNG: an empty one is small. */
const pictureBytes = async (page) => (await page.screenshot({ clip: await page.locator(".view canvas").boundingBox() })).length;

try {
  await check("what a twin contains is said before it is written", async () => {
    for (const line of [/^ {2}run A: to /m, /^ {2}data of: /m, /^ {2}orthophoto: none$/m, /^ {2}size: /m]) {
      if (!line.test(made.stdout)) throw new Error(`no ${line} in\n${made.stdout}`);
    }
  });

  const address = pathToFileURL(file).href;
  const desktop = await open(address, { width: 1400, height: 860 });
  const { page } = desktop;
  await check("it opens from disk at the start of the run, with the scene's name", async () => {
    if (!(await page.locator("h1").innerText()).startsWith("Sham Tseng")) throw new Error("another title");
    same(await clock(page), 0, "time shown");
    const bytes = await pictureBytes(page);
    if (bytes < 100_000) throw new Error(`the view is empty: ${bytes} bytes`);
  });
  await check("nothing is refused while it opens", async () => same((await page.locator(".toasts").allInnerTexts()).join("").trim(), "", "notices"));
  await check("what needs a program is not there", async () => {
    for (const name of ["Share", "Save", "Run", "Step", "Restart", "Draw a barrier", "Put a probe here and run"]) {
      same(await page.getByRole("button", { name, exact: true }).filter({ visible: true }).count(), 0, `buttons ${name}`);
    }
    same(await page.getByRole("tab", { name: "Calibrate" }).filter({ visible: true }).count(), 0, "tabs Calibrate");
  });
  await check("the recording plays, and goes to the time that is chosen", async () => {
    await page.getByRole("button", { name: "Play the recording" }).click();
    await page.waitForFunction(() => Number.parseFloat(document.querySelector(".clock").textContent) > 1);
    await page.getByRole("button", { name: "Pause the recording" }).click();
    const line = await page.locator(".timeline").boundingBox();
    await page.mouse.click(line.x + line.width / 2, line.y + line.height / 2);
    await page.waitForFunction(() => Math.abs(Number.parseFloat(document.querySelector(".clock").textContent) - 10) < 1);
    await page.screenshot({ path: join(output, "desktop.png") });
  });
  await check("a map layer is drawn with its legend", async () => {
    await page.getByLabel("Map layer on the ground").selectOption("peak_depth");
    await page.waitForFunction(() => /Peak depth/.test(document.querySelector("main.middle").textContent));
    await page.screenshot({ path: join(output, "layer.png") });
  });
  await check("charts and tables have the run's values", async () => {
    for (const [tab, text] of [["Time", /Volume/], ["Impact", /House|kPa/], ["Balance", /m³/]]) {
      await page.getByRole("tab", { name: tab }).click();
      await page.waitForFunction((pattern) => new RegExp(pattern).test(document.querySelector(".tab-panels").innerText), text.source);
    }
  });
  await check("a probe reads depth and speed from the recording", async () => {
    await page.getByRole("tab", { name: "Points" }).click();
    await page.getByRole("button", { name: "Put a probe" }).click();
    const view = await page.locator(".view canvas").boundingBox();
    await page.mouse.click(view.x + view.width / 2, view.y + view.height / 2);
    await page.waitForFunction(() => /peaks\s.*\sm,\s.*\sm\/s/.test(document.querySelector(".probes")?.innerText ?? ""));
    for (const what of [".placed .group-head button", ".placed > .hint", ".placed li > button:not(.item)"]) {
      same(await page.locator(what).filter({ visible: true }).count(), 0, `shown ${what}`);
    }
  });
  await check("report, tables and journal are saved from the file", async () => {
    await page.getByRole("button", { name: "Export" }).click();
    const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: /^Save \d+ files/ }).click()]);
    const bytes = readFileSync(await download.path());
    for (const name of ["report.html", "front.csv", "journal.json"]) {
      if (!bytes.includes(name)) throw new Error(`${name} is not in the archive`);
    }
    await page.keyboard.press("Escape");
  });
  await check("no request leaves the page, and the console is silent", async () => silent(desktop, (url) => url === address || url.startsWith("blob:") || url.startsWith("data:")));
  await check("its own policy refuses the network", async () => {
    const reached = await page.evaluate(() => fetch("https://example.org/").then(() => true, () => false));
    same(reached, false, "reached");
    const policy = await page.locator("meta[http-equiv=Content-Security-Policy]").getAttribute("content");
    for (const part of ["default-src 'none'", "connect-src 'none'", "script-src 'sha256-"]) if (!policy.includes(part)) throw new Error(`no ${part} in ${policy}`);
  });
  await desktop.close();

  await check("on a phone the view, the time and the figures have room", async () => {
    const phone = await open(address, { width: 390, height: 844 }, { hasTouch: true, isMobile: true, deviceScaleFactor: 1 });
    same(await phone.page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), true, "no sideways scrolling");
    await phone.page.getByRole("button", { name: "Play the recording" }).tap();
    await phone.page.waitForFunction(() => Number.parseFloat(document.querySelector(".clock").textContent) > 2);
    same((await phone.page.locator(".toasts").allInnerTexts()).join("").trim(), "", "notices");
    await phone.page.screenshot({ path: join(output, "phone.png") });
    silent(phone, (url) => url === address || url.startsWith("blob:") || url.startsWith("data:"));
    await phone.close();
  });

  await check("a server that names another character set does not spoil it", async () => {
    const server = await serve((request, response) => response.writeHead(request.url === "/" ? 200 : 404, { "Content-Type": "text/html; charset=iso-8859-1" })
      .end(request.url === "/" ? readFileSync(file) : ""));
    try {
      const web = await open(server.base, { width: 900, height: 700 });
      if (!(await web.page.locator("h1").innerText()).startsWith("Sham Tseng")) throw new Error("another title");
      await web.close();
    } finally {
      server.close();
    }
  });

  await check("a folder opens from a web server, and asks for its own files alone", async () => {
    const server = await serveFolder(site);
    try {
      const web = await open(server.base, { width: 1200, height: 800 });
      silent(web, (url) => ["", "page.js", "page.css", "tape.bin", "favicon.ico"].some((name) => url === server.base + name) || url.startsWith("blob:"));
      await web.close();
    } finally {
      server.close();
    }
  });

  await check("a name is text, never markup, and a damaged file says so in a sentence", async () => {
    const html = readFileSync(file, "utf8");
    const hostile = join(output, "hostile.html");
    const made = run("publish", "-o", hostile, "--force", "--without-engine", "--no-files", ...small, "--set", 'scene.title="</script><img src=x onerror=document.title=1>"');
    same(made.status, 0, made.stderr);
    const named = await open(pathToFileURL(hostile).href, { width: 900, height: 700 });
    same(await named.page.locator("h1").innerText(), "</script><img src=x onerror=document.title=1>", "title");
    same(await named.page.locator("img[src=x]").count(), 0, "pictures of a name");
    await named.close();
    const damaged = join(output, "damaged.html");
    for (const block of ["tape", "script"]) {
      writeFileSync(damaged, html.replace(new RegExp(`(id="${block}">[^<]{400})[^<]*`), "$1"));
      const context = await browser.newContext();
      const broken = await context.newPage();
      await broken.goto(pathToFileURL(damaged).href);
      await broken.getByRole("alert").waitFor();
      if (!/cut off/.test(await broken.getByRole("alert").innerText())) throw new Error(await broken.getByRole("alert").innerText());
      await context.close();
    }
  });

  await check("the live twin exports its session as such a page", async () => {
    const server = await startServer([talus, "serve", "--port", "0", "--json", "--run", ...small]);
    try {
      await shown(async () => (await server.ask("scenarios/A/state")).time_s > 1);
      const listed = (await server.ask("scenarios/A/exports")).files.map((one) => one.name);
      if (!listed.includes("twin.html")) throw new Error(`exports are ${listed}`);
      const exported = join(output, "exported.html");
      writeFileSync(exported, await server.text("scenarios/A/exports/twin.html"));
      const opened = await open(pathToFileURL(exported).href, { width: 1000, height: 700 });
      silent(opened, (url) => url === pathToFileURL(exported).href || url.startsWith("blob:") || url.startsWith("data:"));
      await opened.close();
    } finally {
      await server.stop();
    }
  });

  const computing = join(output, "engine.html");
  rmSync(computing, { force: true });  // of a former program
  const engine = run("publish", "-o", computing, ...small, "--set", "solver.end_time_s=4");
  if (engine.status === 0) {
    await testEngine(await open(pathToFileURL(computing).href, { width: 1200, height: 800 }), pathToFileURL(computing).href);
  } else {
    console.log("SKIPPED the engine in the page: this program was built without it");
    await check("without an engine, a twin with one is refused in one sentence, and nothing is written", async () => {
      same(engine.status, 2, "exit code");
      same(engine.stderr.trim().split("\n").length, 1, "lines");
      if (!/--without-engine/.test(engine.stderr)) throw new Error(engine.stderr);
      same(existsSync(join(output, "engine.html")), false, "written");
    });
  }
} finally {
  await browser.close();
}
end(score);
