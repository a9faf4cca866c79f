// Alarms and runs that a trigger started, above the view for everybody; all of them with messages in a tab.
import type { RaisedAlarm, TriggeredRun } from "../protocol/messages";
import { watchAll } from "../state/cell";
import { AlarmBook, alarmKey, clockText, readingText, runKey, startedText } from "../state/alerts";
import { fixed } from "../state/format";
import type { Twin } from "../state/twin";
import { chime } from "../ui/chime";
import { button, h } from "../ui/dom";

const acknowledgedKey = "talus-acknowledged";

/** Where it was raised: "scenario B, 12.3 s, 14:03:00". */
const raisedText = (alarm: RaisedAlarm): string => `scenario ${alarm.scenario}, ${fixed(alarm.time_s, 1)} s${alarm.raised_at ? `, ${clockText(alarm.raised_at)}` : ""}`;
const sentenceText = (alarm: RaisedAlarm): string =>
  alarm.sentence + (alarm.expected_s !== null && alarm.expected_s > alarm.time_s ? `; expected there at ${fixed(alarm.expected_s, 1)} s` : "");

/** Every alarm stands above the view, with a sound where the browser allows one, until this person acknowledges it. */
export function alarmBanner(twin: Twin): HTMLElement {
  const banner = h("div", { class: "alarm-banner", role: "alert" });
  const book = new AlarmBook(new Set(JSON.parse(sessionStorage.getItem(acknowledgedKey) ?? "[]") as string[]),
    (keys) => sessionStorage.setItem(acknowledgedKey, JSON.stringify(keys.slice(-1000))));
  const rows = new Map<string, HTMLElement>();
  const acknowledge = (alarms: readonly RaisedAlarm[]): void => {
    book.acknowledge(alarms);
    put();
  };
  const all = button("Acknowledge all", { class: "small all", onclick: () => acknowledge(book.pending) });
  const rowOf = (alarm: RaisedAlarm): HTMLElement => h("div", { class: "row" },
    h("span", { class: "grow" }, h("b", {}, `Alarm: ${alarm.alarm}`), ` (${raisedText(alarm)}). ${sentenceText(alarm)}${alarm.message ? `. ${alarm.message}` : ""}`),
    button("Acknowledge", { class: "small", "aria-label": `Acknowledge ${alarm.alarm}`, onclick: () => acknowledge([alarm]) }));
  const put = (): void => {
    const { pending } = book;
    for (const key of [...rows.keys()]) if (!pending.some((alarm) => alarmKey(alarm) === key)) rows.delete(key);
    const elements = pending.map((alarm) => {
      const row = rows.get(alarmKey(alarm)) ?? rowOf(alarm);
      rows.set(alarmKey(alarm), row);
      return row;
    });
    if (elements.length > 1) elements.unshift(all);
    banner.hidden = elements.length === 0;
    // A row stays between the press and the release of a click.
    if (elements.length !== banner.children.length || elements.some((element, i) => banner.children[i] !== element)) banner.replaceChildren(...elements);
  };
  twin.alerts.watch((alerts) => {
    if (book.hear(alerts?.alarms ?? []).length > 0) chime();
    put();
  });
  return banner;
}

/** Stays until the reader closes it; the next run opens it again. A row stays while its gauge speaks, also between the press and the release of a click. */
export function triggerBanner(twin: Twin): HTMLElement {
  const banner = h("div", { class: "trigger-banner", role: "alert" });
  const rows = new Map<string, { element: HTMLElement; reading: HTMLElement }>();
  const closed = new Set<string>();
  const rowOf = (run: TriggeredRun): { element: HTMLElement; reading: HTMLElement } => {
    const reading = h("span", { class: "muted" });
    const element = h("div", { class: "row", "data-scenario": run.scenario },
      h("span", { class: "grow" }, h("b", {}, `Scenario ${run.scenario}: `), startedText(run), reading),
      button("Show it", { class: "small", onclick: () => twin.show([run.scenario], run.scenario) }),
      button("Close", { icon: "close", bare: true, class: "bare quiet small", onclick: () => {
        closed.add(runKey(run));
        put();
      } }));
    return { element, reading };
  };
  const put = (): void => {
    const runs = (twin.alerts.value?.runs ?? []).filter((run) => !closed.has(runKey(run)));
    for (const key of [...rows.keys()]) if (!runs.some((run) => runKey(run) === key)) rows.delete(key);
    const elements = runs.map((run) => {
      const row = rows.get(runKey(run)) ?? rowOf(run);
      rows.set(runKey(run), row);
      row.reading.textContent = run.reading ? ` ${readingText(run)}` : "";
      return row.element;
    });
    banner.hidden = runs.length === 0;
    if (elements.length !== banner.children.length || elements.some((element, i) => banner.children[i] !== element)) banner.replaceChildren(...elements);
  };
  twin.alerts.watch(put);
  put();
  return banner;
}

export function alarmsPanel(twin: Twin): HTMLElement {
  const panel = h("div", { class: "alarms" });
  watchAll([twin.alerts], () => {
    const alerts = twin.alerts.value;
    if (!alerts) return;
    const rows = [...alerts.alarms].reverse().map((alarm) => h("li", { class: /not delivered/.test(alarm.delivery) ? "alarm bad" : "alarm" },
      h("b", {}, alarm.alarm), h("span", { class: "muted" }, ` ${raisedText(alarm)}`),
      h("div", {}, sentenceText(alarm)),
      alarm.message ? h("div", {}, alarm.message) : null,
      h("small", { class: "muted", title: `State after step ${alarm.step}: ${alarm.hash}` }, [alarm.delivery, `run ${alarm.hash}`].filter(Boolean).join(" · "))));
    const notes = [...alerts.notes].reverse().map(({ at, sentence }) => h("li", {}, h("span", { class: "muted" }, `${clockText(at)} `), sentence));
    const { http, mqtt } = alerts.listening;
    const ways = [http && "HTTP", mqtt !== null && `MQTT (${mqtt})`].filter(Boolean);
    panel.replaceChildren(
      rows.length > 0 ? h("ul", { class: "items" }, ...rows) : h("p", { class: "hint" }, "No alarm of the scene has been raised."),
      alerts.triggers.length > 0 ? h("p", { class: "hint" }, ways.length > 0 ? `Triggers come over ${ways.join(" and ")}: ${alerts.triggers.map(({ name }) => name).join(", ")}.`
        : `Triggers are off: ${alerts.triggers.map(({ name }) => name).join(", ")}.`) : "",
      notes.length > 0 ? h("details", {}, h("summary", {}, "Messages"), h("ul", { class: "items notes" }, ...notes)) : "");
  });
  return panel;
}
