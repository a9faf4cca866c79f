// The actions of docs/protocol.md on a stand-in scenario. Each answers {done, created} or {error}.
import { groundItem } from "./ground_actions.mjs";

const lengthOf = (line) => line.slice(1).reduce((sum, [x, y], k) => sum + Math.hypot(x - line[k][0], y - line[k][1]), 0);
const between = (key, value, low, high, unit) =>
  typeof value === "number" && value >= low && value <= high ? null : `${key} is ${value}; allowed is ${low} to ${high} ${unit}`.trim();

function put(scenario, list, kind, given, measure) {
  const item = Object.fromEntries(Object.entries(given).filter(([, value]) => value !== undefined));
  const old = list.find((entry) => entry.id === item.id);
  if (item.id !== undefined && !old) return { error: `${kind}: there is none with id ${item.id}` };
  const number = list.length + 1;
  const fresh = { name: `${kind} ${number}`, ...old, ...item, id: old?.id ?? `${kind}-${scenario.nextId++}` };
  scenario.change(`${old ? "change" : "add"} ${kind} ${fresh.name}`, () => {
    const inside = scenario.setup[`${kind}s`];
    if (old) inside[inside.findIndex((entry) => entry.id === fresh.id)] = measure(fresh);
    else inside.push(measure(fresh));
  });
  return { done: `${fresh.name} ${old ? "changed" : "added"}`, created: old ? null : fresh.id };
}

function remove(scenario, kind, id) {
  const list = scenario.setup[`${kind}s`];
  const old = list.find((entry) => entry.id === id);
  if (!old) return { error: `id is ${id}; there is no ${kind} of that id` };
  scenario.change(`remove ${kind} ${old.name}`, () => {
    scenario.setup[`${kind}s`] = list.filter((entry) => entry.id !== id);
    if (kind === "release") scenario.debris.remove(id);
  });
  return { done: `${old.name} removed`, created: null };
}

export function act(scenario, body) {
  const { action, ...rest } = body;
  const setup = scenario.setup;
  switch (action) {
    case "run":
      if (scenario.status === "ended") return { error: "the run has ended; restart it first" };
      scenario.status = "running";
      return { done: "running", created: null };
    case "pause":
      scenario.status = "paused";
      return { done: "paused", created: null };
    case "step": {
      scenario.status = "running";
      scenario.left = 0;
      scenario.advance(0.0251);
      scenario.status = "paused";
      scenario.sample();
      return { done: "one step", created: null };
    }
    case "restart":
      scenario.restart();
      ++scenario.revision;
      return { done: "restarted", created: null };
    case "set_speed":
      if (rest.factor !== null) {
        const error = between("factor", rest.factor, 0.05, 100, "");
        if (error) return { error };
      }
      scenario.speedFactor = rest.factor;
      return { done: "speed set", created: null };
    case "set_parameter": {
      const p = scenario.options.parameters.find((entry) => entry.key === rest.key);
      if (!p) return { error: `key is ${rest.key}; there is no such parameter` };
      const error = between(p.key, rest.value, p.range.low ?? -Infinity, p.range.high ?? Infinity, p.unit);
      if (error) return { error };
      scenario.change(`set ${p.label} to ${rest.value} ${p.unit}`.trim(), () => { setup.parameters[rest.key] = rest.value; });
      return { done: `${p.label} is ${rest.value} ${p.unit}`.trim(), created: null };
    }
    case "put_release": {
      const old = setup.releases.find((r) => r.id === rest.id);
      const error = between("thickness_m", rest.thickness_m ?? old?.thickness_m, 0.01, 100, "m");
      if (error) return { error };
      const { polygon, ...others } = rest;
      return put(scenario, setup.releases, "release", { ...(old ? {} : { status: "held", from_scene: false, start_time_s: null }), ...others,
        polygons: polygon && [polygon] }, (r) => scenario.measured(r));
    }
    case "trigger_release": {
      const found = setup.releases.find((r) => r.id === rest.id);
      if (!found || found.status === "released") return { error: `id is ${rest.id}; there is no held release of that id` };
      scenario.change(`trigger ${found.name}`, () => {});
      scenario.release(setup.releases.find((r) => r.id === rest.id));
      scenario.sample();
      return { done: `${found.name} triggered`, created: null };
    }
    case "put_barrier": {
      const old = setup.barriers.find((b) => b.id === rest.id);
      const error = between("height_m", rest.height_m ?? old?.height_m, 0.1, 100, "m") ?? between("thickness_m", rest.thickness_m ?? old?.thickness_m, 0.1, 100, "m");
      return error ? { error } : put(scenario, setup.barriers, "barrier", rest, (b) => ({ ...b, crest_length_m: lengthOf(b.line) }));
    }
    case "put_building": {
      const old = setup.buildings.find((b) => b.id === rest.id);
      const error = between("height_m", rest.height_m ?? old?.height_m, 0.1, 1000, "m");
      return error ? { error } : put(scenario, setup.buildings, "building", { ...(old ? {} : { from_scene: false }), ...rest,
        footprint: rest.footprint && [[rest.footprint]] }, (b) => scenario.based(b));
    }
    case "put_zone":
    case "put_bed":
    case "put_inflow": {
      const kind = action.slice(4);
      const item = groundItem(kind, setup[`${kind}s`].find((entry) => entry.id === rest.id), rest);
      return item.error ? item : put(scenario, setup[`${kind}s`], kind, item, (entry) => entry);
    }
    case "remove_release":
    case "remove_barrier":
    case "remove_building":
    case "remove_zone":
    case "remove_bed":
    case "remove_inflow":
      return remove(scenario, action.slice(7), rest.id);
    case "undo":
    case "redo": {
      const sentence = action === "undo" ? scenario.swap(scenario.past, scenario.future) : scenario.swap(scenario.future, scenario.past);
      return sentence ? { done: `${action}: ${sentence}`, created: null } : { error: `there is nothing to ${action}` };
    }
    default:
      return { error: `action is ${action}; allowed are those of docs/protocol.md` };
  }
}
