// The examples of the npm package talus-engine in Chromium. Usage: node engine_package_test.mjs OUTPUT_FOLDER PACKAGE SCENE, the package
// unpacked, a packed scene. Exit code 77: skipped, the browser, its driver or the package is missing.
import { spawnSync } from "node:child_process";
import { cpSync, existsSync, mkdirSync, readFileSync, realpathSync, rmSync, symlinkSync } from "node:fs";
import { join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { end, findChromium, Score, serveFolder, skip, softwareWebGL } from "./chromium.mjs";

const [, , folder, unpacked, scene] = process.argv;
const output = resolve(folder);
const web = fileURLToPath(new URL("../../web", import.meta.url));
if (!existsSync(join(unpacked, "index.js"))) skip("engine_package", `no package at ${unpacked}; scripts/test.sh publish builds the engine and packs it`);
const launch = await findChromium("engine_package");
const score = new Score();
const { check } = score;

/** A folder as a reader of the README makes it. */
function site(name, modules) {
  const made = join(output, name);
  rmSync(made, { recursive: true, force: true });
  mkdirSync(join(made, "node_modules"), { recursive: true });
  cpSync(join(unpacked, "examples", name), made, { recursive: true });
  cpSync(scene, join(made, "scene.bin"));
  symlinkSync(resolve(unpacked), join(made, "node_modules/talus-engine"));
  for (const [module, at] of Object.entries(modules)) symlinkSync(realpathSync(at), join(made, "node_modules", module));
  return made;
}
const server = await serveFolder(output);
const { base } = server;
const browser = await launch(softwareWebGL);

/** Opens an example. `foreign`: requests that left this server, `problems`: what the console said. */
async function open(name) {
  const page = await browser.newPage({ viewport: { width: 640, height: 480 } });
  page.setDefaultTimeout(300_000);
  const foreign = [];
  const problems = [];
  page.on("request", (request) => !/^(blob|data):/.test(request.url()) && !request.url().startsWith(base) && foreign.push(request.url()));
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && !/GPU stall|GL Driver/.test(message.text()) && problems.push(message.text()));
  page.on("pageerror", (error) => problems.push(error.stack ?? String(error)));
  await page.goto(`${base}${name}/`);
  return { page, silent: () => {
    if (foreign.length > 0) throw new Error(`asked for ${foreign.join(", ")}`);
    if (problems.length > 0) throw new Error(problems.join("\n"));
  } };
}
/** How many points of the picture have about the colour of debris, #c2410c. */
async function debrisIn(page, file) {
  const picture = (await page.screenshot({ path: join(output, file) })).toString("base64");
  return page.evaluate(async (data) => {
    const image = await createImageBitmap(await (await fetch(`data:image/png;base64,${data}`)).blob());
    const canvas = new OffscreenCanvas(image.width, image.height);
    const context = canvas.getContext("2d");
    context.drawImage(image, 0, 0);
    const { data: rgba } = context.getImageData(0, 0, image.width, image.height);
    let count = 0;
    for (let i = 0; i < rgba.length; i += 4) if (rgba[i] > 150 && rgba[i + 1] < 100 && rgba[i + 2] < 60) ++count;
    return count;
  }, picture);
}
const isDebris = (count) => {
  if (count < 20) throw new Error(`${count} points of the picture show debris`);
};
/** Waits until the text of an element says a simulated time from `low` s on; and which. */
async function time(page, selector, low) {
  await page.waitForFunction(([at, least]) => Number.parseFloat(/([0-9.]+) s,/.exec(document.querySelector(at).textContent)?.[1] ?? "-1") >= least, [selector, low]);
  return Number.parseFloat(/([0-9.]+) s,/.exec(await page.locator(selector).innerText())[1]);
}

try {
  const three = site("three", { three: join(web, "node_modules/three") });
  await check("three.js: the page has fewer than 150 lines", () => {
    const lines = readFileSync(join(three, "index.html"), "utf8").split("\n").length;
    if (lines >= 150) throw new Error(`${lines} lines`);
  });
  const { page, silent } = await open("three");
  await check("three.js: a worker steps the scene, and its debris is drawn on the terrain", async () => {
    await time(page, "#figures", 0.5);
    isDebris(await debrisIn(page, "three.png"));
    if (page.workers().length !== 1) throw new Error(`${page.workers().length} workers`);
  });
  await check("three.js: another friction begins the run again", async () => {
    const before = await time(page, "#figures", 1);
    await page.locator("#friction").fill("0.5");
    await page.waitForFunction((was) => Number.parseFloat(document.querySelector("#figures").textContent) < was, before);
    await time(page, "#figures", 0.3);
  });
  await check("three.js: nothing is asked for elsewhere, and the console is silent", silent);
  await page.close();

  const cesiumModules = join(web, "engine_package/examples/cesium/node_modules");
  if (existsSync(join(cesiumModules, "@cesium/engine"))) {
    const engine = join(cesiumModules, "@cesium/engine");
    const cesium = site("cesium", {});
    mkdirSync(join(cesium, "cesium"));
    for (const part of ["Build/Workers", "Source/Assets", "Source/Widget"]) symlinkSync(realpathSync(join(engine, part)), join(cesium, "cesium", part.split("/")[1]));
    await check("CesiumJS: the example is bundled", () => {
      const made = spawnSync(join(web, "node_modules/.bin/esbuild"), ["main.js", "--bundle", "--format=esm", "--external:talus-engine", "--log-level=error", "--outfile=built.js"],
        { cwd: cesium, encoding: "utf8", env: { ...process.env, NODE_PATH: cesiumModules } });
      if (made.status !== 0) throw new Error(made.stderr);
    });
    const globe = await open("cesium");
    await check("CesiumJS: debris lies on the globe where the scene is, and moves", async () => {
      await time(globe.page, "#panel", 0.5);
      isDebris(await debrisIn(globe.page, "cesium.png"));
      // The globe below it, which workers of Cesium make.
      await globe.page.waitForFunction(() => document.querySelector("#panel").dataset.globe === "drawn");
      const [x, y, z] = (await globe.page.locator("#panel").getAttribute("data-first")).split(" ").map(Number);
      const longitude = Math.atan2(y, x) * 180 / Math.PI;
      const latitude = Math.atan2(z, Math.hypot(x, y) * (1 - 0.00669437999)) * 180 / Math.PI;
      // Sham Tseng San Tsuen: gdaltransform of the terrain's corners, EPSG:2326 to EPSG:4326.
      if (!(longitude > 114.0586 && longitude < 114.0621 && latitude > 22.3688 && latitude < 22.3725)) throw new Error(`${longitude}, ${latitude}`);
    });
    await check("CesiumJS: nothing is asked for elsewhere, and the console is silent", globe.silent);
  } else {
    console.log("SKIPPED CesiumJS: run `npm ci` in web/engine_package/examples/cesium");
  }
} finally {
  await browser.close();
  server.close();
}
end(score);
