// The session as a file: all scenarios with their edits, to be opened again on the start page.
import type { Twin } from "../state/twin";
import { dialog, openDialog } from "../ui/dialog";
import { button, h } from "../ui/dom";
import { save } from "../ui/save";

export function sessionButton(twin: Twin): HTMLElement {
  return button("Save", { icon: "save", title: "Save the session: all scenarios with their edits", onclick: () => open(twin) });
}

function open(twin: Twin): void {
  const keeps = twin.place.available && twin.you.value?.role === "controller";
  const name = h("input", { type: "text", maxlength: 60, value: twin.scene.title, "aria-label": "Name of the session" });
  const fileName = (): string => `${name.value.trim().toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-|-$/g, "") || "session"}.json`;
  const keep = async (): Promise<void> => {
    if (await twin.attempt(async () => void (await twin.api.saveSession(name.value.trim())))) {
      twin.notice(`Saved as “${name.value.trim()}”; the start page lists it`, "done");
      box.close();
    }
  };
  const form = h("form", { class: "row own-name", onsubmit: (event: Event) => {
    event.preventDefault();
    if (keeps) void keep();
  } }, h("label", { class: "row grow" }, "Name", name), keeps ? h("button", { type: "submit", class: "primary" }, "Save") : null);
  const box = dialog("Save the session", h("p", { class: "hint" }, "Scenarios, their names and every edit with its step. Opened again, each scenario is computed to the same result, bit for bit."), form,
    h("div", { class: "row answers" }, button("Download the file", { icon: "download", onclick: () => void twin.attempt(async () => {
      save(fileName(), await twin.api.sessionFile());
      box.close();
    }) })));
  openDialog(box);
  name.select();
}
