// Layers that people lay over the terrain: dropped files, what everybody sees, styles, attributes, undo, the saved session, map tiles.
import { assert, inControl, middleOfPlan, saved, until, viewClip } from "./harness.mjs";

// The terrain of the scene, in the Hong Kong 1980 grid.
const [west, south, east, north] = [824090, 825520, 824440, 825920];
const crs = { type: "name", properties: { name: "EPSG:2326" } };
const feature = (type, coordinates, properties) => ({ type: "Feature", properties, geometry: { type, coordinates } });
const layer = (features) => JSON.stringify({ type: "FeatureCollection", crs, features });
const red = "#ff0000";

/** A red quarter in the north-west, and a road with an attribute that looks like a script. */
const parcels = layer([
  feature("Polygon", [[[west + 5, 825730], [824260, 825730], [824260, north - 5], [west + 5, north - 5], [west + 5, 825730]]], { name: "Lot <b>7</b>", owner: "Ada", fill: red, "fill-opacity": 1, stroke: red }),
]);
const routes = layer([feature("LineString", [[west - 500, 825600], [east + 500, 825600]], { name: "Route", stroke: "#0000ff", "stroke-width": 12 }), feature("Point", [0, 0], { name: "far" })]);

/** Drops files onto the view as a person does. */
async function drop(page, files) {
  const data = await page.evaluateHandle((list) => {
    const transfer = new DataTransfer();
    for (const { name, text } of list) transfer.items.add(new File([text], name));
    return transfer;
  }, files);
  await page.dispatchEvent(".stage canvas", "dragover", { dataTransfer: data });
  await page.waitForSelector(".stage.dropping");
  await page.dispatchEvent(".stage canvas", "drop", { dataTransfer: data });
}
const listed = (page) => page.locator(".overlays li b").allTextContents();
/** In a plan, the north-western quarter of the ground in the page. */
async function quarter(page) {
  const clip = await viewClip(page);
  const middle = await middleOfPlan(page);
  const height = 0.3 * clip.height;
  return { x: clip.x + 0.28 * clip.width, y: middle - 1.1 * height, width: 0.15 * clip.width, height };
}

export async function testLayers(run) {
  const tile = "https://tile.example.org/{z}/{x}/{y}.png";
  const own = await run.start(["--tiles", tile]);
  const ada = await run.open(own.controller, { name: "Ada" });
  await inControl(ada);
  const bo = await run.open(own.viewer, { name: "Bo" });
  const pages = [ada, bo];
  for (const page of pages) {
    await page.click("[aria-label='Top view']");
    await page.locator("label:has-text('Names') input").uncheck();
    await page.click("[data-tab=layers]");
  }
  await run.check("a dropped file is seen by both browsers, in its own style, the right way round", async () => {
    await drop(ada, [{ name: "parcels.geojson", text: parcels }, { name: "routes.geojson", text: routes }]);
    for (const page of pages) {
      await until(() => listed(page), (names) => names.join() === "routes,parcels", "both layers");
      const clip = await quarter(page);
      await until(() => run.reddish(page, clip), (share) => share > 0.8, "the red quarter");
      assert.ok((await run.reddish(page, { ...clip, x: clip.x + 0.42 * (await viewClip(page)).width })) < 0.1, "the east is not red");
      assert.match(await page.textContent(".overlays"), /1 feature · 1 outside the terrain/);
    }
    await run.shot(ada, "layers-plan");
  });
  await run.check("a click tells the attributes of a feature, as text", async () => {
    const clip = await quarter(bo);
    await bo.mouse.click(clip.x + clip.width / 2, clip.y + clip.height / 2);
    await bo.waitForSelector(".feature-card:not([hidden])");
    assert.equal(await bo.textContent(".feature-card b"), "Lot <b>7</b>");
    assert.match(await bo.textContent(".feature-card dl"), /ownerAda/);
    assert.equal(await bo.locator(".feature-card b b").count(), 0);
  });
  await run.check("a layer switched off by who has control is off for all, by a viewer for that one alone", async () => {
    const clips = await Promise.all(pages.map(quarter));
    const red = (k, wanted, what) => until(() => run.reddish(pages[k], clips[k]), (share) => (wanted ? share > 0.8 : share < 0.3), what);
    await ada.uncheck("[aria-label='Show parcels']");
    await red(0, false, "off for Ada");
    await red(1, false, "off for Bo");
    await ada.check("[aria-label='Show parcels']");
    await red(0, true, "on for Ada");
    await red(1, true, "on for Bo");
    await bo.uncheck("[aria-label='Show parcels']");
    await red(1, false, "off for Bo alone");
    await red(0, true, "still on for Ada");
    await bo.check("[aria-label='Show parcels']");
    await red(1, true, "on again");
    assert.ok(await bo.isDisabled("[aria-label='Remove parcels']"), "a viewer removes nothing");
  });
  await run.check("a layer is renamed, removed and brought back", async () => {
    await ada.click("[aria-label='Rename parcels']");
    await ada.fill("[aria-label='Name of the layer']", "Lots");
    await ada.keyboard.press("Enter");
    await until(() => listed(bo), (names) => names.join() === "routes,Lots", "the new name");
    await ada.click("[aria-label='Remove Lots']");
    await until(() => listed(bo), (names) => names.join() === "routes", "one layer");
    await ada.click("text=Undo removal of Lots");
    await until(() => listed(bo), (names) => names.includes("Lots"), "both again");
  });
  await run.check("what cannot be read is refused in one sentence; the button takes files without a mouse", async () => {
    await drop(ada, [{ name: "notes.txt", text: "no layer" }]);
    await ada.waitForSelector(".toast.error:has-text('notes.txt: is no layer')");
    await drop(ada, [{ name: "alone.dbf", text: "x" }]);
    await ada.waitForSelector(".toast.error:has-text('alone.dbf belongs to another file')");
    const [chooser] = await Promise.all([ada.waitForEvent("filechooser"), ada.locator("button:has-text('Add layer…')").press("Enter")]);
    await chooser.setFiles([{ name: "shelters.geojson", mimeType: "application/json", buffer: Buffer.from(layer([feature("Point", [824300, 825650], { name: "Shelter" })])) }]);
    await until(() => listed(bo), (names) => names.includes("shelters"), "the third layer");
  });
  await run.check("the saved session holds the layers", async () => {
    await ada.click("button:has-text('Save') >> nth=0");
    const file = await saved(ada, () => ada.click("text=Download the file"));
    const names = JSON.parse(file.bytes.toString()).overlays.map(({ name }) => name);
    assert.deepEqual([...names].sort(), ["Lots", "routes", "shelters"]);
  });
  await run.check("lines and points lie on the ground in the oblique and in the natural view", async () => {
    for (const page of pages) await page.locator("label:has-text('Names') input").check();
    await ada.click("[aria-label=Orbit]");
    await ada.click("[aria-label=Fit]");
    const middle = await viewClip(ada);
    const clip = { ...middle, height: 1.4 * middle.height };  // the road is near the lower edge
    /** Without the layer there is less of its colour, and with it as much again. */
    const adds = async (name, colour, least) => {
      const shown = (await run.still(ada, clip))[colour];
      await ada.uncheck(`[aria-label='Show ${name}']`);
      await until(async () => (await run.colours(ada, clip))[colour], (share) => share < shown - least, `${name}, of ${shown}, goes`);
      await ada.check(`[aria-label='Show ${name}']`);
      await until(async () => (await run.colours(ada, clip))[colour], (share) => share > shown - least / 2, `${name} is back`);
    };
    await adds("routes", "bluish", 0.002);
    await run.shot(ada, "layers-oblique");
    await ada.locator("label:has-text('Natural') input").check();
    await adds("Lots", "reddish", 0.02);
    await run.shot(ada, "layers-natural");
  });
  const blue = Buffer.from(await bo.evaluate(() => {
    const canvas = document.createElement("canvas");
    canvas.width = canvas.height = 256;
    const context = canvas.getContext("2d");
    context.fillStyle = "#0000ff";
    context.fillRect(0, 0, 256, 256);
    return canvas.toDataURL().split(",")[1];
  }), "base64");
  await run.check("map tiles are off until somebody chooses them, are fetched by that browser alone, and go again", async () => {
    const tiles = () => run.requests.filter((url) => url.startsWith("https://tile.example.org/"));
    assert.equal(tiles().length, 0);
    for (const page of pages) {
      await page.route("https://tile.example.org/**", (route) => route.fulfill({ contentType: "image/png", headers: { "access-control-allow-origin": "*" }, body: blue }));
    }
    assert.match(await bo.textContent(".tiles"), /fetched by your browser from this address/);
    await bo.selectOption("[aria-label='Background map']", tile);
    const clip = await viewClip(bo);
    await until(() => run.colours(bo, clip), ({ bluish }) => bluish > 0.3, "blue ground");
    await run.shot(bo, "layers-tiles");
    const asked = tiles().length;
    assert.ok(asked > 0 && asked <= 64, `${asked} tiles`);
    await bo.selectOption("[aria-label='Background map']", "");
    await until(() => run.colours(bo, clip), ({ bluish }) => bluish < 0.1, "the ground again");
    assert.equal(tiles().length, asked, "nobody else asked");
    run.requests = run.requests.filter((url) => !url.startsWith("https://tile.example.org/"));
  });
  await run.check("an address typed in the page is offered to everybody, and shown once a page is loaded again by who wants it", async () => {
    const typed = "https://maps.example.net/wmts?TILEMATRIX={TileMatrix}&TILEROW={TileRow}&TILECOL={TileCol}";
    const asked = () => run.requests.filter((url) => url.startsWith("https://maps.example.net/"));
    const field = ada.locator("[aria-label='Address of map tiles']");
    await field.fill("https://maps.example.net/wmts");
    await ada.click("button:has-text('Add address')");
    await ada.waitForSelector(".toast.error:has-text('has no {z}, {x} and {y}')");
    await field.fill("");
    await field.pressSequentially(typed);
    await field.press("Enter");
    for (const page of pages) await until(() => page.locator("[aria-label='Background map'] option").count(), (count) => count === 3, "the address in the list");
    assert.equal(await field.inputValue(), "");
    assert.ok(!(await bo.isVisible("[aria-label='Address of map tiles']")), "a viewer adds none");
    assert.ok(await bo.isDisabled("[aria-label^='Remove the map maps.example.net']"), "and removes none");
    assert.match(await bo.textContent(".tiles"), /by Ada/);
    await bo.route("https://maps.example.net/**", (route) => route.fulfill({ contentType: "image/png", headers: { "access-control-allow-origin": "*" }, body: blue }));
    await bo.selectOption("[aria-label='Background map']", typed);
    await bo.waitForSelector("button:has-text('Reload and show')");
    assert.equal(asked().length, 0, "this page may not ask yet");
    await bo.click("button:has-text('Reload and show')");
    await until(() => asked().length, (count) => count > 0, "tiles");
    const clip = await viewClip(bo);
    await until(() => run.colours(bo, clip), ({ bluish }) => bluish > 0.3, "blue ground");
    assert.equal(await bo.inputValue("[aria-label='Background map']"), typed);
    assert.ok(await bo.isVisible(".tiles"), "the tab of layers is open");
    assert.ok(asked().every((url) => /TILEMATRIX=\d+&TILEROW=\d+&TILECOL=\d+$/.test(url)), asked()[0]);
    await run.shot(bo, "layers-typed-tiles");
    await ada.click("[aria-label^='Remove the map maps.example.net']");
    await until(() => run.colours(bo, clip), ({ bluish }) => bluish < 0.1, "the ground again");
    await ada.click("text=Undo removal of maps.example.net");
    await until(() => bo.locator("[aria-label='Background map'] option").count(), (count) => count === 3, "it is back");
    assert.equal(await bo.inputValue("[aria-label='Background map']"), "", "and off");
    await bo.reload();
    await until(() => bo.locator("[aria-label='Background map'] option").count(), (count) => count === 3, "the page again");
    assert.equal(await bo.inputValue("[aria-label='Background map']"), "", "a page that nobody asked to show it does not");
    run.requests = run.requests.filter((url) => !url.startsWith("https://maps.example.net/"));
  });
  for (const page of pages) await page.context().close();
  await own.stop();
}
