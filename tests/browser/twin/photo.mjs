// The scene's orthophoto over the terrain, on a server of its own: the shipped scene has none.
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { assert, middleOfPlan, viewClip } from "./harness.mjs";

/** A picture of squares with a world file beside it, over an extent; its north-western quarter is red. */
function writePhoto(file, [west, south, east, north], size = 96) {
  const row = 3 * size;
  const bytes = Buffer.alloc(54 + row * size);
  bytes.write("BM");
  bytes.writeUInt32LE(bytes.length, 2);
  bytes.writeUInt32LE(54, 10);
  bytes.writeUInt32LE(40, 14);
  bytes.writeInt32LE(size, 18);
  bytes.writeInt32LE(size, 22);
  bytes.writeUInt16LE(1, 26);
  bytes.writeUInt16LE(24, 28);
  for (let j = 0; j < size; ++j) {
    for (let i = 0; i < size; ++i) {
      const red = j >= size / 2 && i < size / 2; // rows begin in the south
      const light = (i >> 3) + (j >> 3) & 1 ? 220 : 120;
      bytes.set(red ? [20, 20, light] : [light, light, 60], 54 + row * j + 3 * i); // blue, green, red
    }
  }
  writeFileSync(file, bytes);
  const [dx, dy] = [(east - west) / size, (north - south) / size];
  writeFileSync(file.replace(/bmp$/, "bpw"), [dx, 0, 0, -dy, west + dx / 2, north - dy / 2].join("\n"));
}

export async function testPhoto(run) {
  const file = join(run.output, "photo.bmp");
  writePhoto(file, [824090, 825520, 824440, 825920]); // the terrain of the scene
  const own = await run.start(["--set", `terrain.orthophoto=${file}`]);
  const page = await run.open(own.viewer, { name: "Fay" });
  await run.check("an orthophoto is draped over the terrain, the right way round, and can be put away", async () => {
    await page.click("[aria-label='Top view']");
    await page.locator("label:has-text('Names') input").uncheck();
    const clip = await viewClip(page);
    const plain = await run.still(page, clip);
    await page.locator("label:has-text('Photo') input").check();
    await run.changed(page, clip, [plain.hash], "the photo");
    await run.shot(page, "20-photo");
    const middle = await middleOfPlan(page), height = 0.3 * clip.height;
    const quarter = (left, top) => run.reddish(page, { x: clip.x + (left ? 0.2 : 0.55) * clip.width, y: middle + (top ? -1.2 : 0.2) * height, width: 0.2 * clip.width, height });
    assert.ok((await quarter(true, true)) > 0.8, "the north-western quarter is red");
    for (const [left, top] of [[false, true], [true, false], [false, false]]) assert.ok((await quarter(left, top)) < 0.1, `${left} ${top}`);
    await page.locator("label:has-text('Photo') input").uncheck();
    await run.back(page, clip, plain, "the ground without it");
  });
  await page.context().close();
  await own.stop();
}
