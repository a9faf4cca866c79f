// The server is restarted while a page stays open: the page says that the session is new and what was lost, or that its link is no longer
// valid, or leads to the start page, which offers the saved session.
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { assert, shows, startServer, until } from "./harness.mjs";

const tokens = ["--token", "controller-of-restarts", "--token", "viewer-of-restarts"];

export async function testRestart(run) {
  let server = await run.start(tokens);
  const { port } = server;
  const page = await run.open(server.controller, { name: "Ada" });
  const again = async (further) => {
    await server.stop();
    server = await run.start(further, { port });
  };

  await run.check("a server that was started again has a new session: the page tells what is gone and shows the new one", async () => {
    await shows(page, () => window.talusStats?.frames > 0, "the first picture");
    await page.click(".transport .run");
    await until(() => server.ask("scenarios/A/state"), (s) => s.time_s > 1, "a second");
    await shows(page, () => Number(document.querySelector(".clock").textContent.split(" ")[0]) > 1, "its time");
    await again(tokens);
    const told = page.locator("dialog[open]", { hasText: "This is a new session" });
    await told.waitFor();
    assert.match(await told.textContent(), /The session “.*Sham Tseng.*” has ended\. Lost: run A \([0-9.]+ s\), all edits that were not saved/);
    assert.match(await told.textContent(), /talus start/);
    await page.screenshot({ path: join(run.output, "new-session.png") });
    await page.keyboard.press("Escape");
    await shows(page, () => window.talusStats?.frames > 0 && document.querySelector(".connection").hidden, "the new session");
    assert.equal((await server.ask("scenarios/A/state")).step, 0);
    await page.reload();
    await shows(page, () => window.talusStats?.frames > 0, "the page, loaded again");
    assert.equal(await page.locator("dialog[open]").count(), 0, "it is told once");
  });

  await run.check("a page whose link has become invalid says so and tries no more", async () => {
    await again([]);
    const told = page.locator("dialog[open]", { hasText: "This link is no longer valid" });
    await told.waitFor();
    await page.keyboard.press("Escape");
    assert.equal(await page.textContent(".connection"), "This link is no longer valid.");
    await page.screenshot({ path: join(run.output, "invalid-link.png") });
  });

  await run.check("a start page that was started again leads to itself and offers the saved session", async () => {
    const folder = mkdtempSync(join(tmpdir(), "talus-restart-"));
    const start = async (port) => {
      server = await startServer([run.command[0], "start", "--no-browser", "--json", "--folder", folder, "--port", String(port), ...tokens]);
      run.servers.push(server);
    };
    await start(0);
    await page.goto(server.controller);
    await page.locator("[data-scene=sham_tseng]").click();
    await shows(page, () => window.talusStats?.frames > 0 && document.querySelector(".transport"), "the first picture");
    await page.click("[title^='Save the session']");
    await page.fill("[aria-label='Name of the session']", "Before the restart");
    await page.keyboard.press("Enter");
    await until(() => page.locator("dialog[open]").count(), (n) => n === 0, "the dialog closes");
    await server.stop();
    await start(server.port);
    const card = page.locator(".former");
    await card.waitFor();
    assert.match(await card.textContent(), /talus was restarted.*“.*Sham Tseng.*” has ended/);
    await page.screenshot({ path: join(run.output, "start-again.png") });
    await card.locator("text=Open “Before the restart”").click();
    await shows(page, () => window.talusStats?.frames > 0 && document.querySelector(".transport"), "the saved session");
    assert.equal(await page.locator("dialog[open]").count(), 0);
    await server.stop();
    rmSync(folder, { recursive: true, force: true });
  });
  await page.context().close();
}
