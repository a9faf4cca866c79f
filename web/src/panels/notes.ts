// Notes that people pin to places of the ground: their list, and the dialog that writes one.
import type { Note, Point } from "../protocol/messages";
import type { Stage } from "../scene/stage";
import { watchAll } from "../state/cell";
import type { Twin } from "../state/twin";
import { dialog, openDialog } from "../ui/dialog";
import { button, h } from "../ui/dom";

/** Characters; the server accepts 200 bytes. */
const longest = 120;

export function togglePinning(twin: Twin): void {
  if (twin.hindrance !== null) return twin.notice(twin.hindrance, "error");
  twin.tool.value = twin.tool.value.kind === "note" ? { kind: "none" } : { kind: "note" };
}

export function notesPanel(twin: Twin, stage: Stage): HTMLElement {
  const pin = button("Pin a note", { icon: "note", class: "small", onclick: () => togglePinning(twin) });
  const list = h("ul", { class: "items notes" });
  const hint = h("p", { class: "hint" }, "Everybody sees notes, also in copies of the scenario and in the saved session. They change nothing of the run.");
  twin.pinned.watch((at) => {
    if (at === null) return;
    twin.pinned.value = null;
    write(twin, at, null);
  });
  watchAll([twin.tool], () => pin.setAttribute("aria-pressed", String(twin.tool.value.kind === "note")));
  watchAll([twin.edited, ...twin.every("setup"), twin.you, twin.controller, twin.connection], () => {
    const { hindrance } = twin;
    pin.disabled = hindrance !== null;
    pin.title = hindrance ?? "Write a note at a place of the ground (P)";
    list.replaceChildren(...(twin.now.setup.value?.notes ?? []).map((note) => row(twin, stage, note, hindrance !== null)));
    hint.hidden = list.childElementCount > 0;
  });
  return h("div", {}, h("div", { class: "row" }, pin), hint, list);
}

function row(twin: Twin, stage: Stage, note: Note, fixed: boolean): HTMLElement {
  const go = (): void => stage.rig.visit(stage.reliefOf(twin.edited.value).local(note.x_m, note.y_m, 0.5), 70);
  return h("li", { class: "row" },
    h("button", { type: "button", class: "item grow", title: "Show its place", onclick: go }, h("b", {}, note.name)),
    button("Edit", { class: "small quiet", "aria-label": `Edit the note “${note.name}”`, disabled: fixed, onclick: () => write(twin, [note.x_m, note.y_m], note) }),
    button(`Remove the note “${note.name}”`, { icon: "remove", bare: true, class: "bare quiet small", disabled: fixed,
      onclick: () => void twin.act({ action: "remove_note", id: note.id }) }));
}

/** existing: the note whose text is changed; null: a new one. */
function write(twin: Twin, at: Point, existing: Note | null): void {
  const text = h("input", { type: "text", class: "grow", "aria-label": "Text of the note", maxlength: longest, value: existing?.name ?? "", autofocus: true });
  const send = async (event: Event): Promise<void> => {
    event.preventDefault();
    const name = text.value.trim();
    if (name === "") return text.focus();
    const [x_m, y_m] = at.map((v) => Number(v.toFixed(2)));
    const done = await twin.act(existing ? { action: "put_note", id: existing.id, name } : { action: "put_note", name, x_m, y_m });
    if (done) element.close();
  };
  const element = dialog(existing ? "Edit note" : "Pin a note",
    h("form", { onsubmit: (event: Event) => void send(event) }, h("div", { class: "row" }, text),
      h("div", { class: "row answers" }, h("button", { type: "submit", class: "primary" }, existing ? "Save" : "Pin"),
        button("Cancel", { class: "quiet", onclick: () => element.close() }))));
  openDialog(element);
}
