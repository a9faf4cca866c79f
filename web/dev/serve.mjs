// Stand-in for `talus serve` while the page is developed and tested: speaks docs/protocol.md with an invented flow.
//   node dev/serve.mjs [--port N] [--scene FOLDER] [--particles N] [--end SECONDS]
// Prints one line of JSON with the links. It serves dist/, so `npm run build` comes first.
import { createServer } from "node:http";
import { existsSync, readFileSync } from "node:fs";
import { dirname, extname, join, normalize } from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { WebSocketServer } from "ws";
import { act } from "./actions.mjs";
import { Scenario } from "./scenario.mjs";
import { describe, gridLayers, impacts, probe } from "./answers.mjs";
import { loadValley } from "./valley.mjs";
import { encodeGrid } from "./wire.mjs";

const { values: args } = parseArgs({ options: {
  port: { type: "string", default: "0" }, scene: { type: "string" }, particles: { type: "string", default: "6000" },
  end: { type: "string", default: "90" },
} });
const dist = join(dirname(fileURLToPath(import.meta.url)), "..", "dist");
const valley = loadValley(args.scene);
const { scene, options } = describe(valley, Number(args.particles), Number(args.end));
const tokens = { viewer: "viewer-token", controller: "controller-token" };
const scenarios = { A: new Scenario("A", valley, options) };
const people = new Map();
let controller = null, request = null, nextPerson = 1;
const colours = ["#0072b2", "#d55e00", "#009e73", "#b8428c", "#c78500", "#6b4a94"];

const session = () => ({ protocol: 1, program: "stand-in", title: scene.title, scenarios: Object.keys(scenarios),
  people: peopleList(), controller });
const peopleList = () => [...people.values()].map(({ id, name, role, colour, mark }) => ({ id, name, role, colour, mark }));
const tell = (message) => { for (const p of people.values()) p.socket.send(JSON.stringify(message)); };
const tellPeople = () => tell({ type: "people", people: peopleList(), controller, request });
const tellSetup = (s) => tell({ type: "setup", ...s.setupMessage() });
const tellState = (s) => tell({ type: "state", ...s.state() });
const roleOf = (token) => (token === tokens.controller ? "controller" : token === tokens.viewer ? "viewer" : null);

const types = { ".html": "text/html; charset=utf-8", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml" };
function file(path, response) {
  const name = normalize(path === "/" ? "/index.html" : path);
  const full = join(dist, name);
  if (name.includes("..") || !existsSync(full)) return answer(response, 404, { error: `${path}: there is no such file` });
  response.writeHead(200, { "Content-Type": types[extname(full)] ?? "application/octet-stream",
    "Content-Security-Policy": "default-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'",
    "X-Content-Type-Options": "nosniff" });
  response.end(readFileSync(full));
}
function answer(response, status, body) {
  const binary = Buffer.isBuffer(body), text = typeof body === "string";
  response.writeHead(status, { "Content-Type": binary ? "application/octet-stream" : text ? "text/plain" : "application/json" });
  response.end(binary || text ? body : JSON.stringify(body));
}
const bodyOf = async (message) => {
  let text = "";
  for await (const part of message) text += part;
  return text === "" ? {} : JSON.parse(text);
};

function passControl(to) {
  controller = to;
  request = null;
  tellPeople();
}
function control(body) {
  const person = people.get(body.person);
  if (!person || person.role !== "controller") return { error: "person must be a connected controller" };
  if (body.do === "request") {
    if (controller === null) passControl(person.id);
    else {
      request = { id: person.id, name: person.name };
      tellPeople();
      setTimeout(() => request?.id === person.id && passControl(person.id), 10000);
    }
  } else if (controller !== person.id) return { error: `${body.do} needs control` };
  else if (body.do === "release") passControl(null);
  else if (body.do === "grant" && request) passControl(request.id);
  else { request = null; tellPeople(); }
  return { done: body.do };
}

async function api(message, response, url) {
  const role = roleOf((message.headers.authorization ?? "").replace("Bearer ", ""));
  if (!role) return answer(response, 401, { error: "a token is needed" });
  const parts = url.pathname.split("/").slice(2);
  if (message.method !== "GET") {
    if (role !== "controller") return answer(response, 403, { error: "changing anything needs a controller token" });
    const person = message.headers["talus-person"];
    if (parts[0] !== "control" && controller !== null && person !== controller) {
      return answer(response, 403, { error: `${people.get(controller)?.name ?? "someone else"} has control` });
    }
    const body = await bodyOf(message);
    if (parts[0] === "control") {
      const result = control(body);
      return answer(response, result.error ? 400 : 200, result);
    }
    if (parts.length === 1) {
      if (scenarios.B) return answer(response, 409, { error: "there are two scenarios already" });
      scenarios.B = new Scenario("B", valley, options, scenarios.A.setup);
      tell({ type: "scenarios", scenarios: ["A", "B"] });
      tellSetup(scenarios.B);
      tellState(scenarios.B);
      return answer(response, 200, { done: "scenario B", created: "B" });
    }
    if (message.method === "DELETE") {
      delete scenarios.B;
      tell({ type: "scenarios", scenarios: ["A"] });
      return answer(response, 200, { done: "scenario B ended", created: null });
    }
    const s = scenarios[parts[1]];
    const result = act(s, body);
    if (result.error) return answer(response, 400, result);
    const both = ["run", "pause", "step", "set_speed"].includes(body.action) ? Object.values(scenarios) : [s];
    for (const other of both) if (other !== s) act(other, body);
    for (const other of both) { tellState(other); push(other); }
    tellSetup(s);
    if (both.length === 1 && both[0] === s && !["run", "pause", "step", "set_speed"].includes(body.action)) tell({ type: "done", scenario: s.letter, by: people.get(person)?.name ?? "a program", done: result.done });
    return answer(response, 200, result);
  }
  if (parts[0] === "session") {
    return answer(response, 200, { ...session(), you: { role }, links: role === "controller" ? tokens : { viewer: tokens.viewer } });
  }
  if (parts[0] === "scene") return answer(response, 200, scene);
  if (parts[0] === "ensembles") return answer(response, 200, { ensembles: [] });
  const g = valley.ground;
  if (parts[0] === "terrain") return answer(response, 200, encodeGrid(g.xMin, g.yMin, g.cell, g.columns, g.rows, g.z));
  const s = parts[0] === "scenarios" ? scenarios[parts[1]] : undefined;
  if (!s) return answer(response, 404, { error: `${url.pathname}: there is nothing here` });
  switch (parts[2]) {
    case "state": return answer(response, 200, s.state());
    case "setup": return answer(response, 200, s.setupMessage());
    case "frame": {
      const at = url.searchParams.get("time_s");
      if (at === null) return answer(response, 200, s.frame());
      const found = s.recorded.findLast((r) => r.time <= Number(at) + 1e-9) ?? s.recorded[0];
      return answer(response, 200, found.bytes);
    }
    case "recording": return answer(response, 200, { times_s: s.recorded.map((r) => r.time), bytes: 0 });
    case "layers": return answer(response, 200, encodeGrid(g.xMin, g.yMin, g.cell, g.columns, g.rows, gridLayers(s)[parts[3]]));
    case "series": return answer(response, 200, { time: s.series, front: s.front });
    case "impacts": return answer(response, 200, impacts(s));
    case "probe": return answer(response, 200, probe(s, Number(url.searchParams.get("x_m")), Number(url.searchParams.get("y_m"))));
    case "journal": return answer(response, 200, JSON.stringify({ actions: s.past.map((p) => p.sentence) }));
    case "exports": return parts[3] ? answer(response, 200, `${parts[3]} of the stand-in\n`) : answer(response, 200, { files: [
      { name: "report.html", bytes: null, what: "Report with maps and plots" }, { name: "front.csv", bytes: 2100, what: "Front velocity by chainage" },
      { name: "timeseries.csv", bytes: 8400, what: "Volumes, energies and speeds over time" }, { name: "peak_depth.tif", bytes: 90000, what: "Peak flow depth" }] });
    default: return answer(response, 404, { error: `${url.pathname}: there is nothing here` });
  }
}

const server = createServer((message, response) => {
  const url = new URL(message.url, "http://localhost");
  if (!url.pathname.startsWith("/api/")) return file(url.pathname, response);
  api(message, response, url).catch((error) => answer(response, 500, { error: String(error) }));
});

new WebSocketServer({ server, path: "/ws" }).on("connection", (socket, message) => {
  const query = new URL(message.url, "http://localhost").searchParams;
  const role = roleOf(query.get("token"));
  if (!role) return socket.close(4401, "token");
  const id = `p${nextPerson++}`;
  const person = { id, name: query.get("name") || `Guest ${id.slice(1)}`, role, mark: null, socket, view: null,
    colour: colours[(nextPerson - 2) % colours.length] };
  people.set(id, person);
  if (role === "controller" && controller === null) controller = id;
  socket.send(JSON.stringify({ type: "hello", protocol: 1, you: { id, name: person.name, role, colour: person.colour }, session: session() }));
  for (const s of Object.values(scenarios)) {
    socket.send(JSON.stringify({ type: "setup", ...s.setupMessage() }));
    socket.send(JSON.stringify({ type: "state", ...s.state() }));
  }
  tellPeople();
  socket.on("message", (data) => {
    const told = JSON.parse(data.toString());
    if (told.type === "view") {
      person.view = told;
      for (const letter of told.scenarios) if (scenarios[letter]) socket.send(scenarios[letter].frame());
    } else if (told.type === "mark") { person.mark = told.at; tellPeople(); }
    else if (told.type === "name") { person.name = told.name; tellPeople(); }
    else socket.close(1008, "unknown message");
  });
  socket.on("close", () => {
    people.delete(id);
    if (controller === id) passControl(request?.id ?? [...people.values()].find((p) => p.role === "controller")?.id ?? null);
    else tellPeople();
  });
});

function push(s) {
  const bytes = s.frame();
  for (const p of people.values()) if (p.view?.scenarios.includes(s.letter) && p.socket.bufferedAmount < 1e6) p.socket.send(bytes);
}
let tick = 0;
let before = Date.now();
setInterval(() => {
  const now = Date.now(), wall = Math.min(0.2, (now - before) / 1000);
  before = now;
  ++tick;
  for (const s of Object.values(scenarios)) {
    if (s.status !== "running") continue;
    s.advance(wall * (s.speedFactor ?? 4));
    push(s);
    if (tick % 6 === 0 || s.status !== "running") tellState(s);
  }
}, 1000 / 30);

server.listen(Number(args.port), "127.0.0.1", () => {
  const base = `http://127.0.0.1:${server.address().port}/`;
  console.log(JSON.stringify({ title: scene.title, port: server.address().port, controller_url: `${base}#token=${tokens.controller}`,
    viewer_url: `${base}#token=${tokens.viewer}` }));
});
