// The start page: choose a scene, save the session, open it again, go back, end the program.
import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { assert, programEnvironment, until } from "./harness.mjs";

/** `talus start`: prints its links as one line of JSON. */
async function startTalus(program, folder) {
  const process_ = spawn(program, ["start", "--no-browser", "--json", "--folder", folder], { env: programEnvironment, stdio: ["ignore", "pipe", "inherit"] });
  const ended = new Promise((resolve) => process_.once("exit", resolve));
  const links = await new Promise((resolve) => createInterface({ input: process_.stdout }).on("line", (line) => resolve(JSON.parse(line))));
  return { port: links.port, link: links.controller_url, viewer: links.viewer_url, ended, async stop() {
    process_.kill("SIGTERM");
    await ended;
  } };
}

export async function testStart(run) {
  const folder = mkdtempSync(join(tmpdir(), "talus-start-"));
  const server = await startTalus(run.command[0], folder);
  run.servers.push(server);
  const context = await run.browser.newContext({ viewport: { width: 1440, height: 900 } });
  const page = await context.newPage();
  page.setDefaultTimeout(300_000);
  run.last = page;
  page.on("pageerror", (error) => run.problems.push(error.stack ?? String(error)));
  page.on("request", (request) => /^(data|blob):/.test(request.url()) || run.requests.push(request.url()));
  const token = new URL(server.link).hash.slice(7);
  const ask = async (path) => (await fetch(`http://127.0.0.1:${server.port}/api/${path}`, { headers: { Authorization: `Bearer ${token}` } })).json();

  await run.check("the start page lists the built-in scene and opens it with the keyboard", async () => {
    await page.goto(server.link);
    const row = page.locator("[data-scene=sham_tseng]");
    await row.waitFor();
    assert.match(await row.textContent(), /Sham Tseng/);
    assert.match(await page.textContent(".empty"), /session is saved/);
    await row.focus();
    await page.keyboard.press("Enter");
    await page.waitForFunction(() => window.talusStats?.frames > 0 && document.querySelector(".transport"));
    assert.match(await page.textContent(".topbar h1"), /Sham Tseng/);
  });

  await run.check("a session is saved with its name, and the start page opens it with the same result", async () => {
    for (let i = 0; i < 3; ++i) await page.click("[aria-label='Step']");
    await until(() => ask("scenarios/A/state"), (s) => s.step === 3, "three steps");
    const hash = (await ask("scenarios/A/state")).hash;
    await page.click("[title^='Save the session']");
    await page.fill("[aria-label='Name of the session']", "Three steps");
    await page.keyboard.press("Enter");
    await until(() => page.locator("dialog[open]").count(), (n) => n === 0, "the dialog closes");
    await page.click("button.wordmark");
    const saved = page.locator("[data-session=three-steps]");
    await saved.waitFor();
    assert.match(await page.textContent(".start-back"), /Back to Sham Tseng/);
    await page.screenshot({ path: join(run.output, "start-1440.png") });
    await saved.click();
    await page.click("dialog .primary");
    await page.waitForFunction(() => location.hash === "" && document.querySelector(".transport"));
    assert.equal((await ask("start")).count, 2);
    const state = await ask("scenarios/A/state");
    assert.deepEqual([state.step, state.hash], [3, hash]);
  });

  await run.check("on a phone nothing is wider than the screen, a viewer sees no files, and talus is ended on the page", async () => {
    const eye = await context.newPage();
    await eye.goto(`${server.viewer.replace("#", "?watch#")}`);
    await eye.waitForFunction(() => document.querySelector(".transport"));
    assert.equal(await eye.locator(".wordmark").evaluate((e) => e.tagName), "SPAN");
    await eye.close();
    await page.setViewportSize({ width: 390, height: 844 });
    await page.goto(`http://127.0.0.1:${server.port}/#start`);  // the page loads itself anew
    await page.locator(".start-list").first().waitFor();
    assert.ok(await page.evaluate(() => [...document.querySelectorAll("button, p, h1, li")].every((e) => e.getBoundingClientRect().right <= innerWidth + 1)), "nothing is cut off");
    await page.screenshot({ path: join(run.output, "start-390.png") });
    await page.click("text=End talus");
    await page.click("dialog .primary");
    await page.locator("text=talus has ended").waitFor();
    assert.equal(await server.ended, 0);
  });
  await context.close();
  rmSync(folder, { recursive: true, force: true });
}
