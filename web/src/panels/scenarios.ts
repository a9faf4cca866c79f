// The list of scenarios: which are shown, which one is edited, what sets them apart, how far they are.
import { scenarioNames, type ScenarioName } from "../protocol/frame";
import { watchAll } from "../state/cell";
import { changesText, differences } from "../state/differences";
import { fixed } from "../state/format";
import { standingText } from "../state/standing";
import type { Habit, Twin } from "../state/twin";
import { askFor } from "../ui/dialog";
import { button, h } from "../ui/dom";

const habits: readonly (readonly [Habit, string])[] = [["new", "New scenario from the start"], ["now", "Change from now on"]];

export function scenarioList(twin: Twin): HTMLElement {
  twin.askHabit = (name) => askFor(`Scenario ${name} has begun`, [
    `It is at ${fixed(twin.cells[name].state.value?.time_s, 1)} s. A change from now on leaves what has happened as it is: peaks, arrivals and run-out are then those of no single set of values, and the run is marked as changed on the way.`,
    "The choice holds for this session; it can be changed below the list of scenarios."], habits);

  const list = h("ul", { class: "scenarios" });
  const rows = new Map(scenarioNames.map((name) => [name, scenarioRow(twin, name)]));
  const compare = button("Compare", { icon: "compare", class: "small", onclick: () => void twin.attempt(async () => {
    const { value: edited } = twin.edited;
    if (twin.shown.value.length > 1) return twin.show([edited], edited);
    const other = edited === "A" ? twin.scenarios.value.at(-1) : "A";
    if (other !== undefined && other !== edited) return twin.show([edited, other], edited);
    await twin.begin(edited, null);
  }) });
  const fresh = button("New", { icon: "plus", class: "small", title: "Another scenario with the setup of this one, from the start, shown beside it",
    "aria-label": "New scenario", onclick: () => void twin.attempt(async () => void (await twin.begin(twin.edited.value, null))) });
  const habit = h("select", { "aria-label": "Edits of a run that has begun", onchange: () => twin.setHabit(habit.value as Habit) },
    ...habits.map(([value, text]) => h("option", { value }, text)));
  const habitRow = h("label", { class: "habit muted", title: "What an edit of a run that has begun does" }, "Edits", habit);
  watchAll([twin.scenarios, twin.shown, twin.edited, twin.habit, twin.you, twin.controller, twin.connection, twin.people], () => {
    const { scenarios: { value: all }, shown: { value: shown }, hindrance } = twin;
    const present = all.map((name) => rows.get(name)!);
    if (list.children.length !== present.length || present.some((row, i) => list.children[i] !== row)) list.replaceChildren(...present);
    compare.setAttribute("aria-pressed", String(shown.length > 1));
    compare.disabled = all.length === 1 && hindrance !== null;
    compare.title = all.length === 1 ? "Another scenario with the same setup, from the start, beside this one" : "Two scenarios side by side";
    fresh.hidden = all.length === 1;
    fresh.disabled = hindrance !== null;
    habitRow.hidden = twin.habit.value === null;
    habit.value = twin.habit.value ?? "new";
    habit.disabled = hindrance !== null;
  });
  return h("div", { class: "which", role: "group", "aria-label": "Scenarios" },
    h("div", { class: "group-head" }, h("h2", {}, "Scenarios"), fresh, compare), list, habitRow);
}

function scenarioRow(twin: Twin, name: ScenarioName): HTMLElement {
  const title = h("b", {});
  const apart = h("span", { class: "muted apart" });
  const status = h("span", { class: "muted at" });
  const choose = button("", { class: "item", "data-scenario": name, onclick: () => {
    const { value: shown } = twin.shown;
    // Beside the other one, if two are shown.
    twin.show(shown.includes(name) ? shown : [...shown.filter((s) => s !== twin.edited.value), name], name);
  } });
  choose.replaceChildren(h("span", { class: "what" }, title, status), apart);
  const rename = button(`Name scenario ${name}`, { icon: "edit", bare: true, class: "bare quiet small", onclick: () => {
    field.value = twin.cells[name].setup.value?.name ?? "";
    field.hidden = false;
    field.focus();
  } });
  const field = h("input", { type: "text", maxlength: "60", "aria-label": `Name of scenario ${name}`, placeholder: `Scenario ${name}`, onkeydown: (event: KeyboardEvent) => {
    if (event.key === "Escape") field.value = twin.cells[name].setup.value?.name ?? "";
    if (event.key === "Enter" || event.key === "Escape") field.blur();
  }, onblur: () => {
    field.hidden = true;
    if (field.value !== twin.cells[name].setup.value?.name) void twin.attempt(async () => void (await twin.api.act(name, { action: "name_scenario", name: field.value })));
  } });
  field.hidden = true;
  const end = button(`End scenario ${name}`, { icon: "close", bare: true, class: "bare quiet small", onclick: () => void twin.attempt(async () => {
    const state = twin.cells[name].state.value;
    const sure = (state?.step ?? 0) === 0 || (await askFor(`End scenario ${name}?`, [`Its run of ${fixed(state?.time_s, 1)} s and its results are lost.`],
      [["end", "End it"]] as const)) === "end";
    if (sure) await twin.api.endScenario(name);
  }) });
  end.hidden = name === "A";
  const row = h("li", {}, choose, rename, end, field);
  const { state, setup } = twin.cells[name];
  watchAll([state, setup, twin.cells.A.setup, twin.shown, twin.edited, twin.scenarios, twin.you, twin.controller, twin.connection, twin.people], () => {
    const first = twin.cells.A.setup.value;
    const said = first && setup.value ? differences(first, setup.value, twin.scene.parameters) : [];
    const changes = changesText(setup.value) && `Changed on the way: ${changesText(setup.value)}`;
    title.textContent = setup.value?.name || `Scenario ${name}`;
    apart.textContent = name === "A" || said.length > 0 ? said.join(", ") : "Same as A";
    apart.hidden = apart.textContent === "";
    // No further line: what is below must not move while it is clicked.
    status.textContent = state.value ? `${standingText(state.value)}${changes ? ", changed" : ""}` : "";
    choose.title = [status.textContent, apart.textContent, changes].filter(Boolean).join("\n");
    choose.setAttribute("aria-pressed", String(twin.edited.value === name));
    row.classList.toggle("shown", twin.shown.value.includes(name));
    rename.disabled = end.disabled = twin.hindrance !== null;
    rename.hidden = twin.scenarios.value.length === 1;
  });
  return row;
}

/** Says of which scenarios shown the results are those of no single setup. */
export function changedOnTheWay(twin: Twin): HTMLElement {
  const note = h("div", { class: "on-the-way", role: "note" });
  watchAll([...twin.every("setup"), twin.shown], () => {
    const lines = twin.shown.value.flatMap((name) => {
      const changes = changesText(twin.cells[name].setup.value);
      return changes ? [h("p", {}, h("b", {}, `${twin.shown.value.length > 1 ? `${name} c` : "C"}hanged on the way: `), changes)] : [];
    });
    note.hidden = lines.length === 0;
    note.replaceChildren(...lines);
  });
  return note;
}
