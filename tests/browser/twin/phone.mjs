// A viewer on a phone, with real touch events; light and dark as the system has it.
import { assert, boxOf, until } from "./harness.mjs";

/** Fingers put down, moved and lifted; each is a list of places in pixels of the page. */
async function touch(page, ...fingers) {
  const session = await page.context().newCDPSession(page);
  const send = (type, k) => session.send("Input.dispatchTouchEvent", { type,
    touchPoints: k === null ? [] : fingers.map((places, id) => ({ x: places[k][0], y: places[k][1], id })) });
  await send("touchStart", 0);
  for (let k = 1; k < fingers[0].length; ++k) await send("touchMove", k);
  await send("touchEnd", null);
  await session.detach();
}
/** A finger that rests too long, as on a busy machine, is no tap: tries again until it had its effect. */
async function tap(page, target, effect) {
  for (let k = 0; k < 5; ++k) {
    await page.tap(target);
    for (let wait = 0; wait < 20; ++wait) {
      if (await effect()) return;
      await page.waitForTimeout(100);
    }
  }
  assert.fail(`a tap on ${target} has no effect`);
}
const expanded = (page, target, open) => async () => (await page.getAttribute(target, "aria-expanded")) === String(open);
const turned = (page) => page.locator(".needle").evaluate((e) => e.style.transform);
/** Metres that a pixel shows. */
const scale = (page) => page.evaluate(() => {
  const [length, unit] = document.querySelector(".scale span").textContent.split(/\s/);
  return (parseFloat(length) * (unit === "km" ? 1000 : 1)) / document.querySelector(".scale-bar").getBoundingClientRect().width;
});
/** What reaches beyond the screen; what scrolls within itself does not count. */
const tooWide = (page) => page.evaluate(() => [document.scrollingElement.scrollWidth > innerWidth ? "the page" : null,
  ...[...document.querySelectorAll("#page *")].filter((e) => {
    const r = e.getBoundingClientRect();
    if (r.width === 0 || !e.checkVisibility({ visibilityProperty: true }) || e.closest(".tabs, .labels, .unseen, svg, .stage")) return false;
    return r.left < -1 || r.right > innerWidth + 1;
  }).map((e) => e.outerHTML.slice(0, 90))].filter(Boolean));
/** Texts with less contrast to what is behind them than WCAG 2.2 asks for (4.5; what is off is exempt). */
const faint = (page) => page.evaluate(() => {
  const read = (colour) => (colour.match(/[\d.]+/g) ?? []).map(Number);
  const light = (rgb) => rgb.slice(0, 3).map((v) => v / 255).map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)).reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
  const ground = (e) => {
    for (let at = e; at; at = at.parentElement) {
      const colour = read(getComputedStyle(at).backgroundColor);
      if ((colour[3] ?? 1) > 0.5) return colour;
    }
    return [255, 255, 255];
  };
  return [...document.querySelectorAll("body *")].filter((e) => [...e.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim() !== "")
    && e.checkVisibility({ visibilityProperty: true }) && !e.closest("script, option, :disabled, .unseen, .label.house, .label.chainage")).flatMap((e) => {
    const [a, b] = [light(read(getComputedStyle(e).color)), light(ground(e))];
    const contrast = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    return contrast < 4.5 ? [`${e.className} "${e.textContent.slice(0, 30)}": ${contrast.toFixed(2)}`] : [];
  });
});

/** Controls that are smaller than a finger needs; a tick box has its label, and what stands in a line of text has room around it. */
const small = (page) => page.evaluate(() => [...document.querySelectorAll("#page button, #page select, #page input, #page summary, #page a.button")]
  .filter((e) => e.checkVisibility({ visibilityProperty: true }) && !e.closest(".handle, .alarm-mark, thead, .unseen"))
  .flatMap((e) => {
    const own = /checkbox|radio/.test(e.type) ? e.closest("label, .free, .choice, .field, .optional") ?? e : e;
    const { width, height } = own.getBoundingClientRect();
    return height < 43.5 || (width < 43.5 && !e.matches("input")) ? [`${own.className} ${own.getAttribute("aria-label") ?? own.textContent.slice(0, 30)}: ${width.toFixed(0)} x ${height.toFixed(0)}`] : [];
  }));

export async function testPhone(run, server) {
  const page = await run.open(server.viewer, { width: 390, height: 844, name: "Eve", touch: true });
  const view = await boxOf(page.locator(".stage canvas"));
  const [x, y] = [view.x + view.width / 2, view.y + view.height / 2];

  await run.check("on a phone: picture, timeline, key figures; nothing is wider than the screen", async () => {
    assert.deepEqual(await tooWide(page), []);
    const order = [];
    for (const part of [".stage canvas", ".timeline", ".run-card"]) order.push((await boxOf(page.locator(part))).y);
    assert.deepEqual(order, [...order].sort((a, b) => a - b));
    assert.ok(view.height > 400, `${view.height} px of picture`);
    assert.equal(await page.locator(".run:visible, .controls:visible, .tabs:visible").count(), 0);
    await run.shot(page, "50-phone");
  });

  await run.check("one finger turns the view, two enlarge it, in the plan one moves it", async () => {
    const before = await turned(page);
    await touch(page, [[x, y], [x + 40, y], [x + 80, y]]);
    await until(() => turned(page), (t) => t !== before, "a view from elsewhere");
    const coarse = await scale(page);
    await touch(page, [[x - 20, y], [x - 60, y], [x - 100, y]], [[x + 20, y], [x + 60, y], [x + 100, y]]);
    await until(() => scale(page), (s) => s < 0.7 * coarse, "a closer view");
    await tap(page, "[aria-label='Top view']", async () => (await turned(page)) === "rotate(0rad)");
    const plan = await scale(page);
    await touch(page, [[x, y], [x + 40, y], [x + 80, y]]);
    assert.equal(await turned(page), "rotate(0rad)");
    assert.equal(await scale(page), plan);
    await page.tap("[aria-label='Orbit']");
  });

  await run.check("charts are on a sheet that a tap opens and a swipe closes; layers and values have their buttons", async () => {
    const handle = page.locator(".sheet-handle");
    await tap(page, ".sheet-handle", expanded(page, ".sheet-handle", true));
    await tap(page, "[data-tab=time]", async () => (await page.locator(".tab-panel:visible .chart").count()) > 0);
    assert.deepEqual(await tooWide(page), []);
    await run.shot(page, "51-sheet");
    const at = await boxOf(handle);
    const [hx, hy] = [at.x + at.width / 2, at.y + at.height / 2];
    await touch(page, [[hx, hy], [hx, hy + 60], [hx, hy + 120]]);
    await until(() => page.locator(".tabs:visible").count(), (n) => n === 0, "the sheet is closed");
    await tap(page, ".options-switch", expanded(page, ".options-switch", true));
    await page.selectOption("select[aria-label^='Map layer']", "peak_depth");
    await until(() => page.locator(".legend").last().textContent(), (t) => t.startsWith("Peak depth"), "its legend");
    assert.deepEqual(await tooWide(page), []);
    await tap(page, ".options-switch", expanded(page, ".options-switch", false));
    const setup = page.locator(".controls .scenarios");
    await tap(page, ".setup-switch", () => setup.isVisible());
    assert.deepEqual(await tooWide(page), []);
    await tap(page, ".setup-switch", async () => !(await setup.isVisible()));
  });

  await run.check("held sideways: picture, timeline and key figures at once, charts beside them; nothing is wider than the screen", async () => {
    await page.setViewportSize({ width: 844, height: 390 });
    const within = async (target) => {
      const box = await boxOf(page.locator(target).first());
      assert.ok(box.x >= 0 && box.y >= 0 && box.x + box.width <= 845 && box.y + box.height <= 391, `${target} at ${JSON.stringify(box)}`);
      return box;
    };
    const picture = await until(() => page.locator(".stage canvas").boundingBox(), (box) => box.width > 480 && box.width < 700, "the picture beside the figures");
    assert.ok(picture.height > 230, `${picture.height} px of picture`);
    const [timeline, figures] = [await within(".timeline"), await within(".run-card dl")];
    assert.ok(timeline.width > 250 && timeline.y > picture.y + picture.height - 1, `timeline at ${JSON.stringify(timeline)}`);
    assert.ok(figures.x > picture.x + picture.width - 1, `key figures at ${JSON.stringify(figures)}`);
    // Charts follow the width of their column after it.
    await until(() => tooWide(page), (list) => list.length === 0, "nothing wider than the screen");
    await run.shot(page, "53-sideways");
    await tap(page, "[data-tab=front]", async () => (await page.locator(".tab-panel:visible .chart").count()) > 0);
    await page.locator(".tab-panel:visible .chart").first().scrollIntoViewIfNeeded();
    await run.shot(page, "54-sideways-chart");
    await page.locator(".run-card").scrollIntoViewIfNeeded();
    const setup = page.locator(".controls .scenarios");
    await tap(page, ".setup-switch", () => setup.isVisible());
    assert.deepEqual(await tooWide(page), []);
    await tap(page, ".setup-switch", async () => !(await setup.isVisible()));
    await page.setViewportSize({ width: 390, height: 844 });
    await until(() => page.locator(".stage canvas").boundingBox(), (box) => box.width < 400, "upright again");
  });

  await run.check("every control is as large as a finger needs, and the button to share has its name", async () => {
    assert.equal(await page.getByRole("button", { name: "Share", exact: true }).count(), 1);
    assert.deepEqual(await small(page), []);
    await tap(page, ".sheet-handle", expanded(page, ".sheet-handle", true));
    assert.deepEqual(await small(page), []);
    await tap(page, ".sheet-handle", expanded(page, ".sheet-handle", false));
    const setup = page.locator(".controls .scenarios");
    await tap(page, ".setup-switch", () => setup.isVisible());
    assert.deepEqual(await small(page), []);
    await run.shot(page, "55-setup");
    await tap(page, ".setup-switch", async () => !(await setup.isVisible()));
  });

  await run.check("light and dark follow the system, and every text can be read in both", async () => {
    await tap(page, ".sheet-handle", expanded(page, ".sheet-handle", true));
    for (const colorScheme of ["light", "dark"]) {
      await page.emulateMedia({ colorScheme });
      await until(() => page.evaluate(() => getComputedStyle(document.querySelector(".topbar")).backgroundColor), (c) => (c === "rgb(255, 255, 255)") === (colorScheme === "light"), colorScheme);
      assert.deepEqual(await faint(page), [], colorScheme);
      await run.shot(page, `52-${colorScheme}`);
    }
  });
  await page.context().close();
}
