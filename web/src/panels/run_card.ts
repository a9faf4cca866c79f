// The numbers of the run that are always visible, and the mass balance.
import { watchAll } from "../state/cell";
import { bytes, count, decimalsFor, fixed, percent, quantity } from "../state/format";
import { endText } from "../state/time_left";
import type { Twin } from "../state/twin";
import { h } from "../ui/dom";

const watched = (twin: Twin): Parameters<typeof watchAll>[0] =>
  [twin.edited, ...twin.every("state"), ...twin.every("series"), twin.replay_s, twin.replayOvercompressed];

export function runCard(twin: Twin): HTMLElement {
  const cell = (label: string, help: string): { element: HTMLElement; value: HTMLElement } => {
    const value = h("dd", {});
    return { element: h("div", { title: help }, h("dt", {}, label), value), value };
  };
  const front = cell("Front velocity", "Velocity of the front along the flow path");
  const fastest = cell("Largest speed", "Present maximum particle speed");
  const chainage = cell("Front at chainage", "Chainage of the front now, along the flow path of the scene; not the run-out");
  const particles = cell("Particles", "Particles in the simulation");
  const steps = cell("Steps", "Time steps computed per second");
  const real = cell("Real time", "Simulated seconds per second");
  const message = h("p", { class: "run-message", role: "alert" });
  const light = h("div", { class: "compression", role: "status" });
  const judgement = h("summary", {}), checks = h("ul", {});
  const verdict = h("details", { class: "verdict" }, judgement, checks);
  // The list lies over the readings: a click beside it puts it away.
  document.addEventListener("pointerdown", (event) => { if (!verdict.contains(event.target as Node)) verdict.open = false; });
  verdict.addEventListener("keydown", (event) => { if (event.key === "Escape") verdict.open = false; });
  let shown = "";
  watchAll(watched(twin), () => {
    const s = twin.shownState();
    const live = twin.replay_s.value === null;
    front.value.textContent = quantity(s?.front_velocity_mps, "m/s");
    fastest.value.textContent = quantity(s?.largest_speed_mps, "m/s");
    chainage.value.textContent = s?.front_chainage_m === null || !s ? "–" : `${fixed(s.front_chainage_m, decimalsFor(twin.scene.flow_path?.chainage_m.at(-1) ?? 0, 0))} m`;
    particles.value.textContent = count(s?.particles);
    steps.value.textContent = s && live ? `${fixed(s.steps_per_second, 0)} /s` : "–";
    real.value.textContent = s && live ? `${fixed(s.real_time_factor, 2)} ×` : "–";
    // Of the run's end, not of the time that is looked back at.
    const said = live && s ? endText(s) : "";
    message.hidden = said === "";
    if (message.textContent !== said) message.textContent = said;
    message.classList.toggle("bad", s?.status === "fault");
    // Before the first step there is nothing to judge.
    const overcompressed = live ? s?.too_compressed ?? null : twin.replayOvercompressed.value;
    light.hidden = overcompressed === null;
    light.className = `compression ${overcompressed ? "bad" : "good"}`;
    const text = `${overcompressed ? "Debris too compressed" : "Compression within limits"}${live || twin.replay_s.value === null ? "" : ` at ${fixed(twin.replay_s.value, 1)} s`}`;
    if (light.textContent !== text) light.textContent = text;
    light.title = s ? `Compression: mean ${percent(s.mean_compression, 2)}, above 3 % in ${percent(s.overcompressed_share, 1)} of the particles; limits 1 % and 1 %` : "";
    // Of the run so far: a recording does not keep it.
    const judged = live ? s?.verdict ?? null : null;
    verdict.hidden = judged === null;
    const now = JSON.stringify(judged);
    if (judged && now !== shown) {
      shown = now;
      verdict.classList.toggle("bad", !judged.within_limits);
      judgement.textContent = judged.text;
      checks.replaceChildren(...judged.checks.map((check) => h("li", { "data-state": check.state }, h("b", {}, `${check.name}. `), check.text)));
    }
  });
  return h("section", { class: "run-card", "aria-label": "State of the run" },
    h("dl", {}, front.element, fastest.element, chainage.element, particles.element, steps.element, real.element), light, verdict, message);
}

export function balance(twin: Twin): HTMLElement {
  const parts = [["volume_held_m3", "Held, not yet released", "#c9cfd4"], ["volume_moving_m3", "Moving", "#3b83b5"], ["volume_deposited_m3", "Deposited", "#b49a6c"],
    ["volume_left_m3", "Outflow", "#a3262a"]] as const;
  const bar = h("div", { class: "balance-bar", "aria-hidden": "true" });
  const body = h("tbody", {});
  const table = h("table", { class: "plain" }, body);
  const more = h("table", { class: "plain" }, h("caption", {}, "Run"), h("tbody", {}));
  const caption = h("caption", {}, "Mass balance");
  table.prepend(caption);
  watchAll(watched(twin), () => {
    const s = twin.shownState();
    if (!s) return;
    const live = twin.replay_s.value === null;
    caption.textContent = live ? "Mass balance" : `Mass balance at ${fixed(s.time_s, 2)} s`;
    const total = parts.reduce((sum, [key]) => sum + s[key], 0) || 1;
    bar.replaceChildren(...parts.map(([key, , colour]) => {
      const piece = h("i", {});
      piece.style.width = `${(100 * s[key]) / total}%`;
      piece.style.background = colour;
      return piece;
    }));
    const row = (label: string, value: string, colour?: string): HTMLElement => {
      const dot = colour ? h("i", { class: "dot" }) : null;
      if (dot && colour) dot.style.background = colour;
      return h("tr", {}, h("th", { scope: "row" }, dot, label), h("td", {}, value));
    };
    const error = s.volume_released_m3 + s.volume_entrained_m3 - s.volume_held_m3 - s.volume_moving_m3 - s.volume_deposited_m3 - s.volume_left_m3;
    const digits = decimalsFor(s.volume_released_m3 + s.volume_entrained_m3, 1);
    const volume = (value: number): string => `${fixed(value, digits)} m³`;
    body.replaceChildren(...parts.map(([key, label, colour]) => row(label, volume(s[key]), colour)), row("All releases", volume(s.volume_released_m3)),
      ...(s.volume_entrained_m3 > 0 ? [row("Entrained from the bed", volume(s.volume_entrained_m3))] : []),
      row("Residual", volume(Math.abs(error) < 0.5 * 10 ** -digits ? 0 : error)));
    more.tBodies[0]?.replaceChildren(row("Step", live ? count(s.step) : "–"), row("Compression, mean", percent(s.mean_compression, 2)),
      row("Particles above 3 %", percent(s.overcompressed_share, 2)), row("Compression, largest", percent(s.max_compression, 2)), row("Recording", `${s.recording.frames} frames, ${bytes(s.recording.bytes)}`),
      row("State hash", live ? (s.hash ?? "while paused") : "–"));
  });
  const { scene } = twin;
  const about = h("details", { class: "about" }, h("summary", {}, "About this scene"), h("p", {}, scene.description),
    scene.assumptions.length > 0 ? h("div", {}, h("h3", {}, "Assumptions"), h("ul", {}, ...scene.assumptions.map((a) => h("li", {}, a)))) : null,
    scene.sources.length > 0 ? h("div", {}, h("h3", {}, "Sources"), h("ul", {}, ...scene.sources.map((a) => h("li", {}, a)))) : null);
  return h("div", {}, bar, table, more, about);
}
