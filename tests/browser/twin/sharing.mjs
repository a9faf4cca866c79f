// Several people in one session, breaks of the connection, sizes of the window, keyboard and names of controls.
import { testPhone } from "./phone.mjs";
import { assert, clickGround, shownTime, shows, until, viewClip } from "./harness.mjs";
import jsQR from "jsqr";

/** The colours of a PNG file, decoded by the browser. */
const pixels = (page, png) => page.evaluate(async (content) => {
  const image = new Image();
  image.src = `data:image/png;base64,${content}`;
  await image.decode();
  const canvas = new OffscreenCanvas(image.width, image.height).getContext("2d");
  canvas.drawImage(image, 0, 0);
  return { data: [...canvas.getImageData(0, 0, image.width, image.height).data], width: image.width, height: image.height };
}, png.toString("base64"));

export async function testSharing(run) {
  const server = await run.start();
  const small = { width: 1024, height: 640 };
  const ada = await run.open(server.controller, { ...small, name: "Ada" });
  const state = () => server.ask("scenarios/A/state");

  await run.check("a viewer sees the same time and cannot change anything, and is told why", async () => {
    await until(async () => (await ada.textContent(".control")).trim(), (t) => t === "You have control", "control of the first");
    const eve = await run.open(server.viewer, { ...small, name: "Eve" });
    await until(async () => Math.abs((await shownTime(eve)) - (await state()).time_s), (d) => d < 0.2, "the same time for the late comer");
    assert.equal(await eve.isDisabled(".run"), true);
    assert.match(await eve.textContent(".why"), /viewer's link/);
    for (const control of await eve.locator(".controls input, .controls [data-draw], .controls button:has-text('Undo'), .controls button:has-text('Compare')").all()) {
      if (await control.isVisible()) assert.equal(await control.isDisabled(), true, await control.evaluate((e) => e.outerHTML.slice(0, 120)));
    }
    assert.equal(await eve.locator(".control:visible").count(), 0);
    const seen = await run.still(eve, await viewClip(eve));
    assert.ok(seen.different > 800);
    await until(() => ada.locator(".chips .person").count(), (n) => n === 2, "two people");
    await eve.click("button:has-text('Share')");
    assert.equal(await eve.locator("dialog input[readonly]").count(), 1, "a viewer passes on the viewers' link alone");
    assert.ok((await eve.inputValue("dialog input[readonly]")).endsWith(`#token=${server.viewerToken}`));
    await eve.keyboard.press("Escape");
    await ada.click("[title^='Back to time 0']");
    await ada.selectOption("[aria-label='Speed of the simulation']", "0.1");  // however slow the page is, the end is far
    await ada.click(".run");
    await until(() => eve.textContent(".status"), (t) => /Running/.test(t), "running for the viewer too");
    await ada.click(".run");
    await until(() => eve.textContent(".status"), (t) => /Paused/.test(t), "paused for the viewer too");
    await ada.selectOption("[aria-label='Speed of the simulation']", "");

    const box = await ada.locator(".stage canvas").boundingBox();
    await ada.mouse.move(box.x + 0.5 * box.width, box.y + 0.5 * box.height);
    await ada.mouse.move(box.x + 0.52 * box.width, box.y + 0.55 * box.height, { steps: 3 });
    await until(() => eve.locator(".person-mark:not([hidden])").allTextContents(), (names) => names.includes("Ada"), "Ada's mark");
    await run.shot(eve, "14-viewer");
    await eve.context().close();
    await until(() => ada.locator(".chips .person").count(), (n) => n === 1, "one person again");
  });

  await run.check("control is asked for, declined, granted, given back; names and links are shared", async () => {
    const ben = await run.open(server.controller, { ...small, name: "Ben" });
    assert.match(await ben.textContent(".why"), /Ada has control/);
    await ben.click(".control");
    const request = ada.locator(".request");
    await request.waitFor();
    assert.match(await request.textContent(), /Ben asks for control/);
    await run.shot(ada, "15-request");
    await request.locator("button:has-text('Decline')").click();
    await until(() => ben.textContent(".control"), (t) => /Ask for control/.test(t), "declined");
    await ben.click(".control");
    await request.locator("button:has-text('Grant')").click();
    await until(() => ben.textContent(".control"), (t) => /You have control/.test(t), "granted");
    await until(() => ada.isDisabled(".run"), (d) => d, "Ada's controls are off");
    assert.match(await ada.textContent(".why"), /Ben has control/);
    await ben.click("button:has-text('Share')");
    assert.equal(await ben.locator("dialog input[readonly]").count(), 2);
    const name = ben.locator("dialog input[aria-label='Your name']");
    await name.fill("Benedict");
    await name.press("Enter");
    await until(() => ada.textContent(".why"), (t) => /Benedict has control/.test(t), "the new name");
    await run.shot(ben, "16-share");
    await ben.keyboard.press("Escape");
    await ben.click(".control");
    await until(() => ada.textContent(".control"), (t) => /Take control/.test(t), "given back");
    await ada.click(".control");
    await until(() => ada.textContent(".control"), (t) => /You have control/.test(t), "taken");
    await ben.context().close();
  });

  await run.check("a note and a gauge that one puts on the ground are seen by the other, changed, removed and undone", async () => {
    const eve = await run.open(server.viewer, { ...small, name: "Eve" });
    await ada.locator("[data-tab=points]").click();
    await ada.click("button:has-text('Pin a note')");
    await clickGround(ada, 0.5, 0.55);
    await ada.fill("[aria-label='Text of the note']", "Culvert blocked in 2019");
    await ada.keyboard.press("Enter");
    const seen = (page) => page.locator(".label.note").allTextContents();
    await until(() => seen(eve), (texts) => texts.includes("Culvert blocked in 2019"), "the note in the other's view");
    const [note] = (await server.ask("scenarios/A/setup")).notes;
    assert.equal(note.name, "Culvert blocked in 2019");
    await eve.locator("[data-tab=points]").click();
    assert.equal(await eve.isDisabled("button:has-text('Pin a note')"), true, "a viewer pins none");
    await eve.click("button.item:has-text('Culvert')");
    await run.still(eve, await viewClip(eve));
    await run.shot(eve, "16-note");
    await ada.click("[aria-label='Edit the note “Culvert blocked in 2019”']");
    await ada.fill("[aria-label='Text of the note']", "Culvert cleared");
    await ada.keyboard.press("Enter");
    await until(() => seen(eve), (texts) => texts.includes("Culvert cleared"), "the changed note");
    await ada.click("[aria-label='Remove the note “Culvert cleared”']");
    await until(() => seen(eve), (texts) => texts.length === 0, "no note");
    await ada.click(".controls button:has-text('Undo')");
    await until(() => seen(eve), (texts) => texts.includes("Culvert cleared"), "the note that came back");
    await ada.click(".controls button:has-text('Undo')");
    await ada.click("button:has-text('Add a gauge')");
    await clickGround(ada, 0.45, 0.5);
    await ada.fill("[aria-label='Name of the gauge']", "Footbridge");
    await ada.keyboard.press("Enter");
    await until(() => eve.locator(".pins.gauges").textContent(), (text) => /Footbridge/.test(text), "the gauge in the other's list");
    await ada.click("[title^='Back to time 0']");
    await eve.locator("[data-tab=impact]").click();
    await until(() => eve.locator(".impacts.gauges tbody th").allTextContents(), (names) => names.includes("Footbridge"), "what the gauge reads");
    await ada.click("[aria-label='Remove the gauge “Footbridge”']");
    await until(() => eve.locator(".pins.gauges").textContent(), (text) => !/Footbridge/.test(text), "no gauge");
    await eve.context().close();
  });

  await run.check("sharing in the network is off until it is pressed, shows a QR code, lets others in, and ends", async () => {
    await ada.click("button:has-text('Share')");
    await ada.locator(".beyond .hint").first().waitFor();
    if ((await server.ask("share")).addresses.length === 0) {
      assert.match(await ada.textContent(".beyond"), /no address that others could reach/);
      return ada.keyboard.press("Escape");
    }
    assert.match(await ada.textContent(".beyond"), /Off: only this computer.*Not encrypted/);
    await ada.click("text=Share in the network");
    await ada.locator(".qr svg path").waitFor();
    const url = await ada.inputValue("[aria-label='Link for viewers in the network']");
    assert.ok(url.endsWith(`/#token=${server.viewerToken}`) && !url.includes("127.0.0.1"), url);
    await ada.locator(".beyond button").scrollIntoViewIfNeeded();
    await run.shot(ada, "16-beyond");
    const seen = await pixels(ada, await ada.locator(".qr svg").screenshot());
    assert.equal(jsQR(Uint8ClampedArray.from(seen.data), seen.width, seen.height)?.data, url, "what a phone's camera reads");
    const context = await run.context();
    const eve = await context.newPage();
    await eve.goto(url);
    await shows(eve, () => document.querySelector(".transport"), "the page of another computer");
    await context.close();
    await ada.click("text=Stop sharing");
    await ada.locator("text=Off: only this computer").waitFor();
    await assert.rejects(fetch(url.split("#")[0]));
    await ada.keyboard.press("Escape");
  });

  for (const [width, height] of [[1280, 720], [1024, 768]]) {
    await run.check(`works at ${width} x ${height}: nothing is cut off, readings can be reached`, async () => {
      await ada.setViewportSize({ width, height });
      await run.still(ada);
      const outside = await ada.evaluate(() => [...document.querySelectorAll("button, select, input, .legend, .clock")].filter((e) => {
        const r = e.getBoundingClientRect();
        if (r.width === 0 || !e.checkVisibility({ visibilityProperty: true }) || e.closest(".controls, .tab-panels, .unseen")) return false;
        return r.left < -1 || r.right > innerWidth + 1 || r.top < -1 || r.bottom > innerHeight + 1;
      }).map((e) => e.outerHTML.slice(0, 90)));
      assert.deepEqual(outside, []);
      assert.ok(await ada.evaluate(() => document.scrollingElement.scrollWidth <= innerWidth), "nothing is wider than the screen");
      const overlaps = await ada.evaluate(() => {
        const boxes = [...document.querySelectorAll(".bar, .legend, .map-marks, .topbar > *, .transport > *")].filter((e) => e.checkVisibility({ visibilityProperty: true }))
          .map((e) => [e.className, e.getBoundingClientRect()]).filter(([, r]) => r.width > 0);
        const pairs = [];
        boxes.forEach(([n, a], i) => boxes.slice(i + 1).forEach(([m, b]) => {
          if (a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1) pairs.push(`${n} / ${m}`);
        }));
        return pairs;
      });
      assert.deepEqual(overlaps, []);
      const drawer = ada.locator(".drawer-switch");
      if (width <= 1000) await drawer.click();
      await ada.click("[data-tab=balance]");
      await ada.locator("caption:has-text('Mass balance')").waitFor();
      await run.shot(ada, `17-size-${width}`);
      if (width <= 1000) await drawer.click();
    });
  }

  await run.check("every control has a name, and the focus is seen", async () => {
    const nameless = await ada.evaluate(() => [...document.querySelectorAll("button, input, select, [role=tab]")].filter((e) => {
      if (!e.checkVisibility({ visibilityProperty: true })) return false;
      const label = e.getAttribute("aria-label") || e.getAttribute("title") || e.textContent.trim() || [...(e.labels ?? [])].map((l) => l.textContent).join("");
      return label.trim() === "";
    }).map((e) => e.outerHTML.slice(0, 100)));
    assert.deepEqual(nameless, []);
    await ada.locator(".run").focus();
    await ada.keyboard.press("Tab");
    const outline = await ada.evaluate(() => {
      const s = getComputedStyle(document.activeElement);
      return `${s.outlineStyle} ${s.outlineWidth}`;
    });
    assert.match(outline, /solid 2/);
    await ada.locator(".stage canvas").focus();
    await ada.keyboard.press("?");
    assert.equal(await ada.locator("dialog[open]").count(), 1);
    assert.match(await ada.locator("dialog").textContent(), /Ctrl \+ Shift \+ Z/);
    await run.shot(ada, "18-help");
    await ada.keyboard.press("Escape");
    assert.equal(await ada.locator("dialog[open]").count(), 0);
  });

  await testPhone(run, server);

  await run.check("after a restart of the server the page comes back by itself and shows the present state", async () => {
    await server.stop();
    await until(() => ada.textContent(".connection"), (t) => /Connection lost|Reconnecting/.test(t), "the break is told");
    assert.equal(await ada.isDisabled(".run"), true);
    const next = await run.start(["--token", server.token, "--token", server.viewerToken], { port: server.port });
    await ada.locator("dialog[open]", { hasText: "This is a new session" }).waitFor();
    await ada.keyboard.press("Escape");
    await until(() => ada.locator(".connection:visible").count(), (n) => n === 0, "the connection");
    await until(async () => Math.abs((await shownTime(ada)) - (await next.ask("scenarios/A/state")).time_s), (d) => d < 0.2, "the present time");
    await until(() => ada.isDisabled(".run"), (d) => !d, "control again");
    await ada.click("[aria-label='Step']");
    await until(() => next.ask("scenarios/A/state"), (s) => s.step >= 1, "a step");
  });
  await ada.context().close();
}
