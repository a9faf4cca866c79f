// Lists of observations, triggers and alarms, and the form of one.
import type { ScenarioName } from "../protocol/frame";
import type { Action, Point, Setup, TableEntry, TableKey, TableKind, TableSection, TableValue } from "../protocol/messages";
import { placeOnPath } from "../scene/scenario_view";
import type { Stage } from "../scene/stage";
import { watchAll } from "../state/cell";
import { unitText } from "../state/format";
import { entriesOf, hintOf, needsText, placeOf, placeValues, sectionOf, sectionsOf, summaryOf, titleOf, valueFrom } from "../state/tables";
import type { Twin } from "../state/twin";
import { dialog, openDialog } from "../ui/dialog";
import { button, freshId, h, type IconName } from "../ui/dom";

interface Kind { title: string; add: string; what: string; icon: IconName; does: string; hint: string }
const kinds: Record<TableKind, Kind> = {
  observation: { title: "Observations", add: "Add an observation", what: "observation", icon: "ruler", does: "What was measured in the field, at a place of the ground (O)",
    hint: "Field measurements: velocities, arrival times, run-up marks, deposit depths, damage and run-out. They do not affect the run. They appear in the charts, next to the computed values (tab Front) and in reports; a calibration fits those of scenario A. Outlines and maps of elevation change are read from files: name them in the scene file." },
  trigger: { title: "Triggers", add: "Add a trigger", what: "trigger", icon: "trigger", does: "A message that may start a run",
    hint: "A message that names a trigger of scenario A starts a run of the scene file; structures drawn in the page are not part of it. Who may send messages and where alarms are sent is set in the files the server was started with; it can be neither seen nor changed here." },
  alarm: { title: "Alarms", add: "Add an alarm", what: "alarm", icon: "live", does: "A condition that the run is checked against",
    hint: "An alarm has one place and one condition and is raised at most once per run. Everybody sees it above the view, and it is sent to the recipients listed in the server's own files. Addresses and passwords are not part of an alarm." },
};

/** With the tool for a click in the view where `pick` says so. */
export function tableList(twin: Twin, stage: Stage, kind: TableKind, pick: (() => void) | null = null): HTMLElement {
  const { title, add: label, what, icon, does, hint } = kinds[kind];
  const add = button(label, { icon, class: "small", onclick: () => (pick ? pick() : entryForm(twin, kind, null, null)) });
  const list = h("ul", { class: `items pins ${what}s` });
  watchAll([twin.tool], () => {
    const tool = twin.tool.value;
    if (pick) add.setAttribute("aria-pressed", String(tool.kind === "pin" && tool.what === what));
  });
  watchAll([twin.edited, twin.scenarios, ...twin.every("setup"), twin.you, twin.controller, twin.connection], () => {
    const { hindrance } = twin;
    add.disabled = hindrance !== null;
    add.title = hindrance ?? does;
    list.replaceChildren(...entriesOf(twin.cells[scenarioOf(twin, kind)].setup.value, kind).map((entry) => row(twin, stage, kind, entry, hindrance !== null)));
  });
  return h("section", { class: "placed" }, h("div", { class: "group-head" }, h("h3", {}, title), add), list, h("p", { class: "hint" }, hint));
}

/** Triggers are those of the first scenario, whichever is edited. */
const scenarioOf = (twin: Twin, kind: TableKind): ScenarioName => (kind === "trigger" ? "A" : twin.edited.value);

const act = async (twin: Twin, scenario: ScenarioName, action: Action): Promise<void> => void (await twin.api.act(scenario, action));

function row(twin: Twin, stage: Stage, kind: TableKind, entry: TableEntry, fixed: boolean): HTMLElement {
  const section = sectionOf(twin.scene, entry.section);
  const onPath = (chainage: number): Point | null => {
    const place = placeOnPath(twin.scene, chainage);
    return place ? [place.at[0], place.at[1]] : null;
  };
  const scenario = scenarioOf(twin, kind);
  const at = placeOf(entry, onPath);
  const told = [h("b", {}, entry.name), h("span", { class: "muted" }, [kind === "observation" ? titleOf(entry.section) : "", summaryOf(section, entry)].filter(Boolean).join(": "))];
  const go = (place: Point): void => stage.rig.visit(stage.reliefOf(twin.edited.value).local(place[0], place[1], 0.5), 70);
  return h("li", { class: "row" },
    at ? h("button", { type: "button", class: "item grow", title: "Show its place", onclick: () => go(at) }, ...told) : h("span", { class: "item grow" }, ...told),
    button("Edit", { class: "small quiet", "aria-label": `Edit the ${kind} “${entry.name}”`, disabled: fixed, onclick: () => entryForm(twin, kind, entry, null) }),
    button(`Remove the ${kind} “${entry.name}”`, { icon: "remove", bare: true, class: "bare quiet small", disabled: fixed,
      onclick: () => void twin.attempt(() => act(twin, scenario, { action: `remove_${kind}`, id: entry.id })) }));
}

/** Names that a text may be, as suggestions. */
function namesFor(setup: Setup | null, key: string): string[] {
  if (!setup) return [];
  if (key === "structure") return [...setup.buildings, ...setup.barriers].map((s) => s.name);
  if (key === "building") return setup.buildings.filter((b) => b.from_scene).map((b) => b.name);
  if (key === "release") return setup.releases.filter((r) => r.from_scene).map((r) => r.name);
  return key === "inflow" ? setup.inflows.filter((i) => i.from_scene).map((i) => i.name) : [];
}

interface Field { key: TableKey; element: HTMLElement; value(): TableValue }
function fieldOf(setup: Setup | null, key: TableKey, value: TableValue): Field {
  const id = freshId("entry");
  const label = `${key.label[0]?.toUpperCase() ?? ""}${key.label.slice(1)}${key.unit ? ` (${unitText(key.unit)})` : ""}`;
  const hint = h("small", { class: "muted", id: `${id}-hint` }, hintOf(key));
  if (key.is === "boolean") {
    const box = h("input", { type: "checkbox", id, checked: value === true, "aria-describedby": `${id}-hint` });
    return { key, element: h("div", { class: "entry-field" }, h("label", { class: "check" }, box, label), hint), value: () => box.checked };
  }
  const names = namesFor(setup, key.key);
  const input = h("input", { type: "text", id, value: value === null || value === undefined ? "" : String(value), maxlength: 200, autocomplete: "off", "data-key": key.key,
    inputmode: key.is === "number" ? "decimal" : "text", required: key.required, "aria-describedby": `${id}-hint`, list: names.length > 0 ? `${id}-names` : null });
  return { key, value: () => valueFrom(key, input.value), element: h("div", { class: "entry-field" }, h("label", { for: id }, label), input,
    names.length > 0 ? h("datalist", { id: `${id}-names` }, ...names.map((name) => h("option", { value: name }))) : null, hint) };
}

/** existing: what is changed; null: a new one, at a place where one was chosen. */
export function entryForm(twin: Twin, kind: TableKind, existing: TableEntry | null, at: Point | null): void {
  const sections = sectionsOf(twin.scene, kind);
  const begin = existing ? sectionOf(twin.scene, existing.section) : sections[0];
  if (!begin) return;
  // Whatever is shown when it is sent.
  const scenario = scenarioOf(twin, kind);
  let section: TableSection = begin;
  let fields: Field[] = [];
  let name: TableValue = null;
  let sending = false;
  const needs = h("p", { class: "hint" });
  const holder = h("div", { class: "entry-fields" });
  const problem = h("p", { class: "problem", role: "alert", hidden: true });
  const show = (): void => {
    const first = existing ? existing.values : { ...Object.fromEntries(section.keys.map((k) => [k.key, k.default])), ...placeValues(section, at, twin.scene.flow_path), ...(name === null ? {} : { name }) };
    fields = section.keys.map((key) => fieldOf(twin.cells[scenario].setup.value, key, first[key.key] ?? null));
    needs.textContent = `${section.help} ${needsText(section) ? `Required: ${needsText(section)}.` : ""}`;
    holder.replaceChildren(...fields.map((f) => f.element));
  };
  const pick = h("select", { "aria-label": "What was observed", onchange: () => {
    name = fields.find(({ key }) => key.key === "name")?.value() ?? null;
    section = sections.find((s) => s.section === pick.value) ?? section;
    show();
  } }, ...sections.map((s) => h("option", { value: s.section }, titleOf(s.section))));
  const tell = (sentence: string): void => {
    problem.textContent = sentence;
    problem.hidden = false;
  };
  const send = async (event: Event): Promise<void> => {
    event.preventDefault();
    if (sending) return;
    sending = true;
    problem.hidden = true;
    try {
      const values = Object.fromEntries(fields.map((f) => [f.key.key, f.value()]));
      // A name that is left empty is given by the server.
      if (!existing && values["name"] === null) delete values["name"];
      const which = existing ? { id: existing.id } : kind === "observation" ? { section: section.section } : {};
      await act(twin, scenario, { action: `put_${kind}`, ...which, values } as Action);
      element.close();
    } catch (error) {
      tell((error as Error).message);  // beside the fields: the form stays
    } finally {
      sending = false;
    }
  };
  show();
  const element = dialog(existing ? `Edit the ${kind}` : kinds[kind].add,
    h("form", { class: "entry-form", novalidate: true, onsubmit: (event: Event) => void send(event) },
      existing || sections.length === 1 ? null : h("div", { class: "row" }, pick), needs, holder, problem,
      h("div", { class: "row answers" }, h("button", { type: "submit", class: "primary" }, existing ? "Save" : "Add"), button("Cancel", { class: "quiet", onclick: () => element.close() }))));
  openDialog(element);
  holder.querySelector<HTMLElement>("input")?.focus();
}
