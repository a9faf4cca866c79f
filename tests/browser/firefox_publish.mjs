// A published twin in Firefox, through its own remote protocol (Marionette): it opens from disk, shows its picture and plays;
// with an engine it computes a run to its end. Usage: node firefox_publish.mjs OUTPUT_FOLDER TALUS [TWIN.html]; without TWIN a
// short run of the built-in scene is published. Exit code 77: skipped, since Firefox is missing, or Xvfb where there is no display,
// which WebGL needs.
import { spawn, spawnSync } from "node:child_process";
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { connect } from "node:net";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const firefox = process.env.TALUS_FIREFOX ?? "firefox-esr";
for (const program of process.env.DISPLAY ? [firefox] : [firefox, "Xvfb"]) {
  if (spawnSync("which", [program]).status === 0) continue;
  console.log(`SKIPPED browser.firefox_publish: ${program} is not there`);
  process.exit(77);
}
const [, , output, talus, given] = process.argv;
mkdirSync(output, { recursive: true });
const file = given ?? join(output, "twin.html");
if (given === undefined) {
  const small = ["-o", file, "--force", "--set", "solver.target_particle_count=500", "--set", "solver.end_time_s=4"];
  const published = (...more) => spawnSync(talus, ["publish", ...small, ...more], { encoding: "utf8" });
  const withEngine = published();
  const made = /without the engine/.test(withEngine.stderr) ? published("--without-engine") : withEngine;
  if (made.status !== 0) throw new Error(`talus publish: ${made.status}\n${made.stderr}`);
}
/** A display of its own, once it says its number. */
async function display() {
  if (process.env.DISPLAY) return { number: process.env.DISPLAY, end: () => undefined };
  const server = spawn("Xvfb", ["-displayfd", "3", "-screen", "0", "1400x1000x24", "-nolisten", "tcp"], { stdio: ["ignore", "ignore", "ignore", "pipe"] });
  const number = await new Promise((done, failed) => {
    server.stdio[3].once("data", (text) => done(`:${String(text).trim()}`));
    server.once("exit", (code) => failed(new Error(`Xvfb ended with ${code}`)));
  });
  return { number, end: () => server.kill() };
}
const screen = await display();
const profile = mkdtempSync(join(tmpdir(), "talus-firefox-"));
const port = 20_000 + (process.pid % 20_000);
writeFileSync(join(profile, "user.js"), `user_pref("marionette.port", ${port});
user_pref("webgl.force-enabled", true);
`);
const browser = spawn(firefox, ["--no-remote", "--profile", profile, "--marionette"], { stdio: "ignore", env: { ...process.env, DISPLAY: screen.number } });

/** The connection, once the browser listens. */
async function open() {
  for (const end = Date.now() + 60_000; ;) {
    if (Date.now() > end || browser.exitCode !== null) throw new Error("Firefox does not listen");
    const socket = connect(port, "127.0.0.1");
    const connected = await new Promise((done) => socket.once("connect", () => done(true)).once("error", () => done(false)));
    if (connected) return socket;
    await new Promise((next) => setTimeout(next, 200));
  }
}
let socket;
const asked = new Map();
let heard = Buffer.alloc(0), greeted;
const greeting = new Promise((done) => { greeted = done; });
/** Answers to what is asked; a browser that has ended answers nothing more. */
function listen() {
  socket.on("data", (data) => {
    heard = Buffer.concat([heard, data]);
    for (;;) {  // LENGTH:JSON
      const colon = heard.indexOf(":");
      const length = Number(heard.subarray(0, Math.max(0, colon)));
      if (colon < 0 || heard.length < colon + 1 + length) return;
      const message = JSON.parse(heard.toString("utf8", colon + 1, colon + 1 + length));
      heard = heard.subarray(colon + 1 + length);
      if (!Array.isArray(message)) greeted();
      else {
        const { done, failed } = asked.get(message[1]);
        if (message[2]) failed(new Error(`${message[2].error}: ${message[2].message}`));
        else done(message[3] !== null && "value" in message[3] ? message[3].value : message[3]);
      }
    }
  });
  socket.on("close", () => {
    for (const { failed } of asked.values()) failed(new Error("Firefox has ended"));
  });
}
let count = 0;
const ask = (command, parameters = {}) => new Promise((done, failed) => {
  const text = JSON.stringify([0, ++count, command, parameters]);
  asked.set(count, { done, failed });
  socket.write(`${Buffer.byteLength(text)}:${text}`);
});
const evaluate = (script) => ask("WebDriver:ExecuteScript", { script, args: [] });
const until = async (script, what) => {
  const end = Date.now() + 180_000;
  while (!(await evaluate(`return ${script};`))) {
    if (Date.now() > end) throw new Error(`waited for ${what}; the page shows ${await evaluate("return document.body.innerText.slice(0, 400);")}`);
    await new Promise((next) => setTimeout(next, 200));
  }
};
const picture = async (name) => writeFileSync(join(output, name), Buffer.from(await ask("WebDriver:TakeScreenshot", { full: false }), "base64"));
const button = (name) => `[...document.querySelectorAll("button")].find((one) => one.innerText.trim() === "${name}" || one.getAttribute("aria-label") === "${name}" || one.title === "${name}")`;

let status = 0;
try {
  socket = await open();
  listen();
  await greeting;
  await ask("WebDriver:NewSession", {});
  await ask("WebDriver:SetWindowRect", { width: 1400, height: 900 });
  const from = Date.now();
  await ask("WebDriver:Navigate", { url: pathToFileURL(resolve(file)).href });
  const clock = "Number.parseFloat(document.querySelector('.clock')?.textContent)";
  await until(`${clock} >= 0`, "the recording");
  console.log(`ok   it opens from disk (${((Date.now() - from) / 1e3).toFixed(1)} s)`);
  // It plays by itself once, as it does for every reader who has not asked for less motion.
  await until(`${button("Play the recording")} !== undefined`, "the end of the recording");
  const shown = await evaluate(`return ${clock};`);
  await evaluate(`${button("Play the recording")}.click();`);
  await until(`${clock} !== ${shown}`, "the recording to play");
  await picture("firefox_recording.png");
  console.log("ok   the recording plays");
  if (await evaluate(`return ${button("Change it")} !== undefined;`)) {
    await evaluate(`${button("Change it")}.click();`);
    await until("location.hash === '#compute' && document.querySelector('.run') !== null && document.querySelector('.clock')?.textContent.startsWith('0.00')", "the engine");
    await evaluate("document.querySelector('.run').click();");
    await until("/End reached|At rest/.test(document.querySelector('button[data-scenario=A]').textContent)", "the end of the run");
    await picture("firefox_engine.png");
    console.log(`ok   the engine computes a run to its end: ${await evaluate("return document.querySelector('button[data-scenario=A]').innerText;")}`);
  }
} catch (error) {
  console.error(`FAIL ${error.message}`);
  status = 1;
} finally {
  browser.kill();
  if (browser.exitCode === null && browser.signalCode === null) await new Promise((done) => browser.once("exit", done));
  screen.end();
  rmSync(profile, { recursive: true, force: true });
}
process.exit(status);
