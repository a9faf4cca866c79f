// Run, pause, step, restart, speed; the timeline with the recording, and the return to live.
import { scenarioNames } from "../protocol/frame";
import { watchAll } from "../state/cell";
import { fixed } from "../state/format";
import type { Playback } from "../state/playback";
import { standingText } from "../state/standing";
import { aboutTime, timeLeft } from "../state/time_left";
import type { Twin } from "../state/twin";
import { button, h, icon, type IconName } from "../ui/dom";

const speeds: [string, string][] = [
  ["0.1", "0.1 × real time"], ["0.25", "0.25 ×"], ["0.5", "0.5 ×"], ["1", "1 × real time"], ["2", "2 ×"], ["4", "4 ×"], ["10", "10 ×"],
  ["", "Fastest"],
];

export function transport(twin: Twin, playback: Playback): HTMLElement {
  const run = button("Run", { class: "primary run", icon: "run", onclick: () => void toggle(twin) });
  const step = button("Step", { icon: "step", bare: true, title: "One step (period key)", onclick: () => void twin.drive("step") });
  const restart = button("Restart", { icon: "restart", bare: true, title: "Back to time 0 with the present setup: every scenario shown",
    onclick: () => void twin.restart() });
  const speed = h("select", { "aria-label": "Speed of the simulation", title: "Speed of the simulation; “Fastest” is without limit", onchange: () =>
    void twin.act({ action: "set_speed", factor: speed.value === "" ? null : Number(speed.value) }) },
    ...speeds.map(([value, text]) => h("option", { value }, text)));

  const clock = h("output", { class: "clock", "aria-label": "Time shown, s" });
  const status = h("span", { class: "status", role: "status" });
  const slider = h("input", { type: "range", class: "timeline", min: "0", step: "0.05", "aria-label": "Time of the recording, s",
    oninput: () => playback.seek(Number(slider.value)) });
  const alarms = alarmMarks(twin, playback);
  const ends = h("div", { class: "timeline-ends" }, h("span", {}, "0 s"), h("span", {}));
  const play = button("Play the recording", { icon: "run", bare: true, class: "bare play", onclick: () => playback.toggle() });
  const live = button("Live", { class: "live", onclick: () => playback.live(), title: "Return to the running simulation (L)" });

  const showTime = (): void => {
    const state = twin.now.state.value;
    if (!state) return;
    const at = twin.replay_s.value ?? state.time_s;
    // Two that are shown may be at different times: this is that of one.
    const whose = twin.shown.value.length > 1 ? ` ${twin.edited.value}` : "";
    clock.replaceChildren(`${fixed(at, 2)} s`, whose ? h("small", {}, whose) : "");
    slider.max = String(state.end_time_s);
    if (document.activeElement !== slider || twin.replay_s.value === null) slider.value = String(at);
    slider.style.setProperty("--recorded", `${(100 * (state.recording.last_s ?? 0)) / state.end_time_s}%`);
    slider.style.setProperty("--shown", `${(100 * at) / state.end_time_s}%`);
    slider.setAttribute("aria-valuetext", `${fixed(at, 2)} s of ${fixed(state.end_time_s, 0)} s${whose && `, scenario${whose}`}${twin.replay_s.value === null ? ", live" : ", from the recording"}`);
    const going = state.status === "running" && twin.replay_s.value === null;
    const left = going ? aboutTime(timeLeft(state)) : "";
    ends.lastElementChild?.replaceChildren(`${left ? `${left} left · ` : ""}${fixed(state.end_time_s, 0)} s`);
  };
  const showState = (): void => {
    const state = twin.now.state.value;
    const { running } = twin;
    face(run, running ? "Pause" : "Run", running ? "pause" : "run");
    const hindrance = twin.hindrance;
    for (const control of [run, step, restart, speed]) {
      control.disabled = hindrance !== null;
      if (hindrance) control.setAttribute("data-why", hindrance);
      else control.removeAttribute("data-why");
    }
    const over = twin.shown.value.every((name) => ["ended", "at_rest"].includes(twin.cells[name].state.value?.status ?? ""));
    run.disabled ||= over;
    step.disabled ||= running || over;
    const chosen = state?.speed_factor;
    const value = chosen === null || chosen === undefined ? "" : String(chosen);
    if (state) {
      if (![...speed.options].some((o) => o.value === value)) speed.prepend(h("option", { value }, `${value} ×`));
      speed.value = value;
    }
    status.textContent = state ? (twin.replay_s.value === null ? standingText(state, false) : "Playback") : "";
    status.dataset["status"] = twin.replay_s.value === null ? (state?.status ?? "") : "replay";
    status.title = twin.replay_s.value === null ? (state?.message ?? "") : "";
    live.classList.toggle("on", twin.replay_s.value === null);
    live.setAttribute("aria-pressed", String(twin.replay_s.value === null));
    face(play, twin.playing.value ? "Pause the recording" : "Play the recording", twin.playing.value ? "pause" : "run");
    showTime();
  };
  for (const name of scenarioNames) twin.cells[name].state.watch(showState);
  watchAll([twin.replay_s, twin.playing, twin.edited, twin.shown, twin.you, twin.controller, twin.connection, twin.people], showState);

  return h("footer", { class: "transport", "aria-label": "Time" },
    h("div", { class: "drive" }, run, step, restart, speed),
    h("div", { class: "time" }, clock, status),
    play,
    h("div", { class: "line" }, slider, alarms, ends),
    live);
}

/** Where the alarms of the run were raised; a click shows the recording at that time. */
function alarmMarks(twin: Twin, playback: Playback): HTMLElement {
  const marks = h("div", { class: "timeline-alarms", role: "group", "aria-label": "Alarms on the timeline" });
  let shown = "";
  watchAll([twin.alerts, twin.edited, ...twin.every("state")], () => {
    const raised = (twin.alerts.value?.alarms ?? []).filter((alarm) => alarm.scenario === twin.edited.value);
    const end_s = twin.now.state.value?.end_time_s ?? 0;
    const key = JSON.stringify([end_s, ...raised.map((alarm) => [alarm.alarm, alarm.time_s])]);
    if (key === shown) return;
    shown = key;
    marks.replaceChildren(...(end_s > 0 ? raised : []).map((alarm) => {
      const text = `Alarm ${alarm.alarm}, ${fixed(alarm.time_s, 1)} s`;
      const mark = h("button", { type: "button", class: "alarm-mark", "aria-label": text, title: `${text}: ${alarm.sentence}`, onclick: () => playback.seek(alarm.time_s) });
      mark.style.left = `${Math.min(100, (100 * alarm.time_s) / end_s)}%`;
      return mark;
    }));
  });
  return marks;
}

export async function toggle(twin: Twin): Promise<void> {
  if (!twin.running) twin.replay_s.value = null;
  await twin.drive(twin.running ? "pause" : "run");
}

function face(control: HTMLButtonElement, text: string, name: IconName): void {
  if (control.dataset["face"] === text) return;
  control.dataset["face"] = text;
  const bare = control.classList.contains("bare");
  control.replaceChildren(icon(name), ...(bare ? [] : [h("span", {}, text)]));
  if (bare) {
    control.title = text;
    control.setAttribute("aria-label", text);
  }
}
