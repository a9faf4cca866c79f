// Scenarios: runs with parameters from time 0. What is asked before a run is changed on the way, what is marked, and what Compare acts on.
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { assert, boxOf, clickGround, inControl, pause, saved, until, viewClip } from "./harness.mjs";

const key = "material.friction_coefficient";

export async function testScenarios(run) {
  const server = await run.start(["--set", "solver.end_time_s=4"], { particles: 500 });
  const page = await run.open(server.controller, { name: "Ada", edits: null });
  await inControl(page);
  const state = (s) => server.ask(`scenarios/${s}/state`);
  const setup = (s) => server.ask(`scenarios/${s}/setup`);
  const ended = (s) => until(() => state(s), (now) => now.status === "ended", `the end of ${s}`);
  const friction = page.locator(".field", { hasText: "riction" }).first().locator("input[type=number]");
  const setFriction = async (value) => {
    await friction.fill(String(value));
    await friction.press("Enter");
  };
  const row = (s) => page.locator(`button[data-scenario=${s}]`);
  await page.selectOption("select[aria-label^=Speed]", "");
  await page.click(".run");
  await ended("A");
  const first = (await setup("A")).parameters[key];
  const seriesOfA = JSON.stringify(await server.ask("scenarios/A/series"));

  await run.check("an edit of a finished run asks once: a new scenario from the start, listed with what sets it apart, status and time", async () => {
    await setFriction(0.3);
    const dialog = page.locator("dialog[open]");
    await dialog.waitFor();
    await page.keyboard.press("Escape");
    await until(() => friction.inputValue(), (v) => Number(v) === first, "the field goes back");
    assert.equal((await setup("A")).parameters[key], first);
    await setFriction(0.3);
    await dialog.waitFor();
    await run.shot(page, "37-ask");
    assert.equal(await page.evaluate(() => document.activeElement.textContent), "New scenario from the start");
    await page.keyboard.press("Enter");
    await row("B").waitFor();
    await until(() => row("B").textContent(), (t) => /Paused, 0\.0 s.*friction 0\.3/.test(t), "B in the list");
    assert.match(await row("A").textContent(), /End reached, 4\.0 s/);
    assert.equal((await setup("A")).parameters[key], first);
    assert.deepEqual((await setup("A")).changes, []);
    assert.equal(await page.locator(".pane").count(), 2);
    await until(() => page.locator(".pane-name").allTextContents(), (t) => t[0]?.startsWith(`A, friction ${first},`) && t[1]?.startsWith("B, friction 0.3,"), "panes with their parameters");
    // B has not begun: it is edited without a new scenario.
    await setFriction(0.25);
    await until(() => setup("B"), (s) => s.parameters[key] === 0.25, "an edit of B");
    assert.equal(await dialog.count(), 0);
    await run.shot(page, "38-two");
  });

  await run.check("two at different times: each view, the clock, the table, the picture and the page say their own", async () => {
    await until(() => page.locator(".pane-name").allTextContents(), (t) => /, 4\.0.s$/.test(t[0] ?? "") && /, 0\.0.s$/.test(t[1] ?? ""), "a time in each view");
    assert.match(await page.textContent(".clock"), /^0\.00 s B$/);
    await row("A").click();
    await until(() => page.textContent(".clock"), (t) => /^4\.\d\d s A$/.test(t), "the clock of A");
    await row("B").click();
    await page.click("[data-tab=compare]");
    await until(() => page.locator(".comparison thead th").allTextContents(), (t) => /^A 4\.0.s$/.test(t[1] ?? "") && /^B 0\.0.s$/.test(t[2] ?? ""), "a time above each column");
    // What is written into pictures cannot be read back from them.
    await page.evaluate(() => {
      window.written = [];
      const { fillText } = CanvasRenderingContext2D.prototype;
      CanvasRenderingContext2D.prototype.fillText = function (text, ...at) {
        window.written.push(text);
        return fillText.call(this, text, ...at);
      };
    });
    const report = await saved(page, () => page.click("button:has-text('Save the comparison')"));
    const times = (await page.evaluate(() => window.written)).filter((text) => /t = /.test(text));
    assert.deepEqual(times, ["A left: t = 4.0 s   B right: t = 0.0 s"]);
    assert.match(report.bytes.toString(), /<th>A <small>4\.0.s<\/small><\/th><th>B <small>0\.0.s<\/small><\/th>/);
    await row("A").click();
    await until(() => page.textContent(".clock"), (t) => /^4\.\d\d s A$/.test(t), "the clock of A");
    const line = await page.locator(".timeline").boundingBox();
    await page.mouse.click(line.x + 0.5 * line.width, line.y + 0.5 * line.height);
    await until(() => page.locator(".pane-name").allTextContents(), (t) => /, (1\.9|2\.0|2\.1).s$/.test(t[0] ?? "") && /, 0\.0.s$/.test(t[1] ?? ""), "the recording has no more of B");
    await page.click(".live");
    await row("B").click();
  });

  await run.check("run, pause and restart in Compare act on both scenarios, and B − A is not blank", async () => {
    await page.click(".run");
    await ended("B");
    assert.equal(JSON.stringify(await server.ask("scenarios/A/series")), seriesOfA, "A is as it was");
    await page.click("[aria-label=Restart]");
    for (const s of ["A", "B"]) await until(() => state(s), (now) => now.time_s === 0, `time 0 of ${s}`);
    await page.click(".run");
    for (const s of ["A", "B"]) await ended(s);
    await page.selectOption("select[aria-label^='Map layer']", "peak_depth");
    await page.locator("label:has-text('B − A') input").check();
    const legend = page.locator(".legend").last();
    await until(() => legend.getAttribute("aria-label"), (t) => /B − A: colours from −[\d.]*[1-9]/.test(t ?? ""), "depths that differ");
    await until(() => page.locator(".pane-map").allTextContents(), (t) => t.join("|") === "Map: B − A; debris of A|Map: B − A; debris of B", "the difference named in both views");
    await run.shot(page, "39-difference");
    await page.selectOption("select[aria-label^='Map layer']", "none");
  });

  await run.check("both in one picture, with a divider that is dragged or moved by keys", async () => {
    const clip = await viewClip(page);
    const beside = await run.still(page, clip);
    await page.click("[aria-label='Swipe']");
    const divider = page.locator(".divider");
    const box = await boxOf(divider);
    const view = await boxOf(page.locator(".stage canvas"));
    // Below the bars.
    const y = box.y + 0.7 * box.height;
    await page.mouse.move(box.x + box.width / 2, y);
    await page.mouse.down();
    await page.mouse.move(view.x + 0.3 * view.width, y, { steps: 4 });
    await page.mouse.up();
    assert.equal(await divider.getAttribute("aria-valuenow"), "30");
    await run.shot(page, "39-swipe");
    await page.click("[aria-label='Share']");
    await page.locator("label:has-text('Links open this view') input").check();
    const link = await page.inputValue("[aria-label='Link for viewers']");
    await page.keyboard.press("Escape");
    const other = await page.context().newPage();
    await other.goto(link);
    await other.locator(".divider").waitFor();
    assert.equal(await other.locator(".divider").getAttribute("aria-valuenow"), "30", "the view of the link");
    const names = JSON.stringify(await page.locator(".pane-name").allTextContents());
    await until(() => other.locator(".pane-name").allTextContents(), (t) => JSON.stringify(t) === names, "the scenarios of the link");
    await other.close();
    await divider.focus();
    await page.keyboard.press("End");
    const first = await run.still(page, clip);
    await page.keyboard.press("Home");
    const second = await run.still(page, clip);
    assert.equal(await divider.getAttribute("aria-valuenow"), "2");
    assert.notEqual(first.hash, second.hash, "A and B look alike");
    await page.click("[aria-label='Swipe']");
    await divider.waitFor({ state: "hidden" });
    await run.back(page, clip, beside, "two views side by side");
  });

  await run.check("two scenarios in numbers: figures, houses, barriers with differences, both curves, a report on one page", async () => {
    await page.click("[data-tab=compare]");
    const [a, b] = await Promise.all(["A", "B"].map(async (s) => (await server.ask(`scenarios/${s}/figures`)).figures.find((f) => f.key === "run_out_along_flow_m").value));
    const rows = () => page.locator(".comparison tbody tr:not(.group-row)").evaluateAll((list) => list.map((tr) => [...tr.children].map((cell) => cell.textContent)));
    const told = await until(rows, (list) => list.some(([name]) => name.startsWith("Run-out along the flow")), "key figures");
    const [, ...runOut] = told.find(([name]) => name.startsWith("Run-out along the flow"));
    const read = (text) => Number(text.replace("−", "-").replace("+", ""));
    for (const [i, wanted] of [a, b, b - a].entries()) assert.ok(Math.abs(read(runOut[i]) - wanted) <= 0.006 * Math.max(a, b), `${runOut[i]} for ${wanted} m`);
    assert.deepEqual(told[0].slice(1).map(read), [first, 0.25, Number((0.25 - first).toPrecision(3))], told[0].join());
    assert.ok(told.some(([name, one, other]) => /building friction/.test(name) && read(one) === first && read(other) === 0.25), "what follows friction");
    for (const [name, ...values] of told) {
      const [one, other, by] = values.map((text) => read(text.replace("\u202f", "")));
      if (![one, other, by].some(Number.isNaN)) assert.ok(Math.abs(other - one - by) <= 0.51 * 10 ** -Math.min(...values.map((text) => text.split(".")[1]?.length ?? 0)), `${name}: ${values.join(" | ")}`);
    }
    await run.shot(page, "41-numbers");
    const report = await saved(page, () => page.click("button:has-text('Save the comparison')"));
    assert.equal(report.name, "comparison.html");
    const text = report.bytes.toString();
    for (const words of [`B, friction 0.25`, "End reached, 4.0 s", "Run-out along the flow", "<polyline", "data:image/jpeg"]) assert.ok(text.includes(words), words);
    const paper = await page.context().newPage();
    await paper.setContent(text);
    await paper.pdf({ path: join(run.output, "comparison.pdf"), preferCSSPageSize: true });
    await run.shot(paper, "42-comparison");
    const pages = readFileSync(join(run.output, "comparison.pdf")).toString("latin1").match(/\/Type\s*\/Page\b/g);
    assert.equal(pages?.length, 1, "one page");
    await paper.close();
    await page.click("[data-tab=time]");
    const chart = page.locator(".tab-panel:visible .chart-plot").first();
    await until(() => chart.getAttribute("aria-label"), (t) => /Moving A from .*Moving B from/.test(t ?? ""), "both curves");
    for (const tab of ["time", "front"]) {
      await page.click(`[data-tab=${tab}]`);
      const legends = await until(() => page.locator(".tab-panel:visible .chart-plot:visible").evaluateAll((plots) => plots.map((plot) => [...plot.querySelectorAll(".u-series")].slice(1).map((row) => {
        const style = getComputedStyle(row.querySelector(".u-marker"));
        return { label: row.querySelector(".u-label").textContent, colour: style.borderTopColor, line: style.borderTopStyle };
      }))), (all) => all.length > 1 && all.every((rows) => rows.length > 1), `legends of ${tab}`);
      for (const rows of legends) {
        assert.equal(new Set(rows.map((row) => row.colour)).size, rows.length, `one colour twice: ${JSON.stringify(rows)}`);
        for (const { label, line } of rows) {
          const dashed = tab === "time" ? / B$/.test(label) : /^(Debris|Depth-averaged)/.test(label);
          assert.equal(line, dashed ? "dashed" : "solid", label);
        }
      }
      await run.shot(page, `45-curves-${tab}`);
    }
  });

  await run.check("restart, run and pause in Compare act on both", async () => {
    await page.click("[aria-label=Restart]");
    await page.selectOption("select[aria-label^=Speed]", "0.1");
    await page.click(".run");
    for (const s of ["A", "B"]) await until(() => state(s), (now) => now.status === "running", `${s} runs`);
    await pause(page, () => state("B"));
    assert.equal((await state("A")).status, "paused");
    await page.selectOption("select[aria-label^=Speed]", "");
  });

  await run.check("an edit made while a new scenario opens goes to it", async () => {
    await page.route("**/api/scenarios", async (route) => {
      await new Promise((resolve) => setTimeout(resolve, 700));
      await route.continue();
    });
    await page.click("[aria-label='New scenario']");
    await setFriction(0.31);
    await until(() => server.ask("session"), (s) => s.scenarios.includes("C"), "C");
    await until(() => setup("C"), (s) => s.parameters[key] === 0.31, "its friction");
    assert.equal((await setup("A")).parameters[key], first);
    assert.equal((await setup("B")).parameters[key], 0.25);
    await page.unroute("**/api/scenarios");
    assert.deepEqual((await server.ask("session")).scenarios, ["A", "B", "C"]);
  });

  await run.check("a scenario is named; one with results is ended only after a question", async () => {
    await page.click("[aria-label='Name scenario C']");
    await page.fill("[aria-label='Name of scenario C']", "Dry year");
    await page.keyboard.press("Enter");
    await until(() => row("C").textContent(), (t) => t.startsWith("Dry year"), "the name");
    await page.click(".run");
    await until(() => state("C"), (s) => s.step > 0, "a run of C");
    await pause(page, () => state("C"));
    await page.click("[aria-label='End scenario C']");
    await page.click("dialog[open] button:has-text('Cancel')");
    assert.deepEqual((await server.ask("session")).scenarios, ["A", "B", "C"]);
    await page.click("[aria-label='End scenario C']");
    await page.click("dialog[open] button:has-text('End it')");
    await until(() => server.ask("session"), (s) => s.scenarios.join("") === "AB", "C has ended");
  });

  await run.check("a barrier drawn on a finished run does not start it, and the run is marked wherever its results are", async () => {
    await row("A").click();
    if (await page.locator(".pane").count() > 1) await page.click("button:has-text('Compare')");
    await page.click(".run");
    await ended("A");
    await page.selectOption("[aria-label='Edits of a run that has begun']", "now");
    await page.click("[data-draw=barrier]");
    for (const [u, v] of [[0.4, 0.5], [0.5, 0.55]]) await clickGround(page, u, v);
    await page.keyboard.press("Enter");
    const { changes } = await until(() => setup("A"), (s) => s.barriers.length > 0, "the barrier");
    assert.equal(changes.length, 1);
    await setFriction(0.27);
    await until(() => setup("A"), (s) => s.changes.length === 2, "two changes");
    assert.notEqual((await state("A")).status, "running");
    const words = `friction coefficient ${first} -> 0.27 at 4.0 s`;
    await until(() => page.textContent(".readings .on-the-way"), (t) => t.includes(words), "marked above charts and tables");
    assert.match(await page.textContent(".legends .on-the-way"), /Changed on the way/);
    assert.match(await row("A").textContent(), /4\.0 s; [\d.]+.m³ still moving, changed/);
    await page.click("[data-tab=time]");
    const chart = page.locator(".tab-panel:visible .chart-plot").first();
    await until(() => chart.getAttribute("aria-label"), (t) => /Changed on the way at 4/.test(t ?? ""), "marked in the chart");
    await run.shot(page, "40-on-the-way");
    const ask = (name) => server.text(`scenarios/A/exports/${name}`);
    assert.match(await ask("report.html"), /changed at 4\.0 s, by Ada: friction coefficient/i);
    assert.match(await ask("manifest.json"), /changed at 4\.0 s, by Ada: barrier/);
    const [head, ...rows] = (await ask("front.csv")).trim().split("\n");
    assert.match(head, /,changed_on_the_way$/);
    for (const line of rows) assert.ok(line.includes(words), line);
    await page.click("[aria-label=Restart]");
    await until(() => setup("A"), (s) => s.changes.length === 0, "nothing is changed on the way any more");
    await until(() => page.locator(".on-the-way:visible").count(), (n) => n === 0, "no mark");
  });

  await run.check("a field with the focus shows what is; Ctrl+Z in it undoes typing first, then the model; a stale text is not sent by leaving", async () => {
    const parameter = async () => (await setup("A")).parameters[key];
    // Without taking the focus; once the page knows that there is something to undo or redo.
    const press = (text) => until(() => page.evaluate((t) => {
      const button = [...document.querySelectorAll(".controls button")].find((b) => b.textContent === t);
      if (button.disabled) return false;
      button.click();
      return true;
    }, text), (pressed) => pressed, text);
    await setFriction(0.33);
    await until(parameter, (v) => v === 0.33, "friction");
    await page.keyboard.type("9");
    assert.notEqual(Number(await friction.inputValue()), 0.33);
    await page.keyboard.press("Control+z");
    await until(() => friction.inputValue(), (v) => Number(v) === 0.33, "the text before");
    assert.equal(await parameter(), 0.33, "typing was undone, not the model");
    await setFriction(0.34);
    await until(parameter, (v) => v === 0.34, "friction");
    await page.keyboard.press("Control+z");
    await until(parameter, (v) => v === 0.33, "the model is undone");
    await until(() => friction.inputValue(), (v) => Number(v) === 0.33, "the field with the focus shows it");
    await page.keyboard.type("0.4");
    assert.equal(await friction.inputValue(), "0.4", "what is typed next replaces it");
    await page.keyboard.press("Escape");
    const { revision } = await setup("A");
    await page.keyboard.press("Control+a");
    await page.keyboard.type("0.5");
    await press("Redo");
    const note = page.locator(".field", { hasText: "riction" }).first().locator(".field-note");
    await until(() => note.textContent(), (t) => t === "Now 0.34; Enter sets 0.5", "the new value is told beside what is typed");
    assert.equal(await friction.inputValue(), "0.5");
    await page.keyboard.press("Tab");
    assert.match(await note.textContent(), /^0\.5 was not sent/);
    assert.equal(Number(await friction.inputValue()), 0.34);
    await friction.focus();
    await press("Undo");
    await until(() => friction.inputValue(), (v) => Number(v) === 0.33, "without typed text the field follows");
    await page.keyboard.press("Tab");
    assert.equal((await setup("A")).revision, revision + 2, "nothing else was sent");
  });

  await run.check("nothing is said of the flow before the first step, nor of its end while one looks back", async () => {
    assert.equal(await page.locator(".compression:visible, .run-message:visible").count(), 0);
    await page.click(".run");
    await ended("A");
    await until(() => page.locator(".run-message:visible").count(), (n) => n === 1, "why it has ended");
    await until(() => page.textContent(".status"), (t) => /^End reached; [\d.]+.m³ still moving$/.test(t), "the end, and what still moves");
    await run.shot(page, "44-end");
    const line = await page.locator(".timeline").boundingBox();
    await page.mouse.click(line.x + 0.4 * line.width, line.y + 0.5 * line.height);
    await until(() => page.textContent(".status"), (t) => t === "Playback", "the recording");
    await until(() => page.locator(".run-message:visible").count(), (n) => n === 0, "no message of the end");
    await until(() => page.textContent(".compression"), (t) => / at [\d.]+ s$/.test(t), "the verdict names its time");
    await page.click(".live");
  });

  await run.check("a large release is prepared beside the session: its size said before, progress shown, cancelled without a trace", async () => {
    await page.click("[aria-label=Restart]");
    await until(() => state("A"), (s) => s.time_s === 0, "time 0");
    const { revision } = await setup("A");
    await page.click("[data-draw=release]");
    const thickness = page.locator(".draft:visible input[type=number]").first();
    await thickness.fill("18");
    await thickness.press("Enter");
    for (const [u, v] of [[0.3, 0.4], [0.7, 0.4], [0.7, 0.75], [0.3, 0.75]]) await clickGround(page, u, v);
    assert.match(await page.textContent(".draft:visible .measure"), /m³, [\d\s]+ particles, [\d.]+\s[kMG]B/);
    await page.keyboard.press("Enter");
    const box = page.locator(".preparing:visible");
    await box.waitFor();
    assert.match(await box.textContent(), /Preparing: put release/);
    assert.equal((await state("A")).preparing.what, "put release", "the session answers meanwhile");
    await run.shot(page, "43-preparing");
    await box.locator("button").click();
    await until(() => state("A"), (s) => s.preparing === null, "the end of the preparation");
    assert.equal((await setup("A")).revision, revision, "nothing was changed");
    await page.click("[aria-label=Step]");
    await until(() => state("A"), (s) => s.step === 1, "the run goes on");
  });
  await page.context().close();
  await server.stop();
}
