// Gauges, observations and notes, which people put at places of the ground: their lists, and the dialog that names one.
import type { Point, Setup } from "../protocol/messages";
import type { Stage } from "../scene/stage";
import { watchAll } from "../state/cell";
import type { Pinned, Twin } from "../state/twin";
import { dialog, openDialog } from "../ui/dialog";
import { button, h, type IconName } from "../ui/dom";
import { entryForm, tableList } from "./tables";

interface Pin { id: string; name: string; x_m: number; y_m: number; in_force?: boolean }
interface Kind { title: string; add: string; key: string; icon: IconName; does: string; hint: string; field: string; longest: number; of(setup: Setup): readonly Pin[] }

/** What has a name and a place alone. */
type Named = Exclude<Pinned, "observation">;

/** longest: characters; the server accepts 80 and 200 bytes. */
const kinds: Record<Named, Kind> = {
  gauge: { title: "Gauges", add: "Add a gauge", key: "G", icon: "probe", does: "Record depth and speed at a place of the ground", field: "Name of the gauge", longest: 60, of: (setup) => setup.gauges,
    hint: "Gauges record depth and speed from the start of a run: one that is added later applies from the next restart. Their readings are in the tabs Impact and Time." },
  note: { title: "Notes", add: "Pin a note", key: "P", icon: "note", does: "Write a note at a place of the ground", field: "Text of the note", longest: 120, of: (setup) => setup.notes,
    hint: "Everybody sees notes, also in copies of the scenario and in the saved session. They change nothing of the run." },
};

export function togglePinning(twin: Twin, what: Pinned): void {
  const tool = twin.tool.value;
  if (tool.kind === "pin" && tool.what === what) twin.tool.value = { kind: "none" };
  else if (twin.hindrance !== null) twin.notice(twin.hindrance, "error");
  else twin.tool.value = { kind: "pin", what };
}

export function pinsPanel(twin: Twin, stage: Stage): HTMLElement {
  twin.pinned.watch((pinned) => {
    if (pinned === null) return;
    twin.pinned.value = null;
    if (pinned.what === "observation") entryForm(twin, "observation", null, pinned.at);
    else name(twin, pinned.what, pinned.at, null);
  });
  return h("div", {}, listOf(twin, stage, "gauge"), tableList(twin, stage, "observation", () => togglePinning(twin, "observation")), listOf(twin, stage, "note"));
}

function listOf(twin: Twin, stage: Stage, what: Named): HTMLElement {
  const kind = kinds[what];
  const add = button(kind.add, { icon: kind.icon, class: "small", onclick: () => togglePinning(twin, what) });
  const list = h("ul", { class: `items pins ${what}s` });
  const hint = h("p", { class: "hint" }, kind.hint);
  watchAll([twin.tool], () => {
    const tool = twin.tool.value;
    add.setAttribute("aria-pressed", String(tool.kind === "pin" && tool.what === what));
  });
  watchAll([twin.edited, ...twin.every("setup"), twin.you, twin.controller, twin.connection], () => {
    const { hindrance } = twin;
    add.disabled = hindrance !== null;
    add.title = hindrance ?? `${kind.does} (${kind.key})`;
    const setup = twin.now.setup.value;
    list.replaceChildren(...(setup ? kind.of(setup) : []).map((pin) => row(twin, stage, what, pin, hindrance !== null)));
    hint.hidden = list.childElementCount > 0;
  });
  return h("section", { class: "placed" }, h("div", { class: "group-head" }, h("h3", {}, kind.title), add), hint, list);
}

function row(twin: Twin, stage: Stage, what: Named, pin: Pin, fixed: boolean): HTMLElement {
  const go = (): void => stage.rig.visit(stage.reliefOf(twin.edited.value).local(pin.x_m, pin.y_m, 0.5), 70);
  return h("li", { class: "row" },
    h("button", { type: "button", class: "item grow", title: "Show its place", onclick: go }, h("b", {}, pin.name),
      pin.in_force === false ? h("span", { class: "muted" }, "from the next restart") : null),
    button("Edit", { class: "small quiet", "aria-label": `Edit the ${what} “${pin.name}”`, disabled: fixed, onclick: () => name(twin, what, [pin.x_m, pin.y_m], pin) }),
    button(`Remove the ${what} “${pin.name}”`, { icon: "remove", bare: true, class: "bare quiet small", disabled: fixed,
      onclick: () => void twin.act({ action: `remove_${what}`, id: pin.id }) }));
}

/** existing: what gets another name; null: a new one. */
function name(twin: Twin, what: Named, at: Point, existing: Pin | null): void {
  const kind = kinds[what];
  const text = h("input", { type: "text", class: "grow", "aria-label": kind.field, maxlength: kind.longest, value: existing?.name ?? "", autofocus: true });
  const send = async (event: Event): Promise<void> => {
    event.preventDefault();
    const given = text.value.trim();
    if (given === "") return text.focus();
    const [x_m, y_m] = at.map((v) => Number(v.toFixed(2)));
    const done = await twin.act(existing ? { action: `put_${what}`, id: existing.id, name: given } : { action: `put_${what}`, name: given, x_m, y_m });
    if (done) element.close();
  };
  const element = dialog(existing ? `Edit ${what}` : kind.add,
    h("form", { onsubmit: (event: Event) => void send(event) }, h("div", { class: "row" }, text),
      h("div", { class: "row answers" }, h("button", { type: "submit", class: "primary" }, existing ? "Save" : "Add"),
        button("Cancel", { class: "quiet", onclick: () => element.close() }))));
  openDialog(element);
}
