// Files of the run so far, the journal, and pictures of the view.
import type { ExportFile } from "../protocol/messages";
import { bytes } from "../state/format";
import type { Twin } from "../state/twin";
import { button, h } from "../ui/dom";
import { dialog, openDialog } from "../ui/dialog";
import { save, type Picture } from "./picture";

export function exportButtons(twin: Twin, picture: Picture): HTMLElement[] {
  const video = button("Record a video", { icon: "video", bare: true, title: "Record a video of the view (WebM)", onclick: () => picture.video(() => {
    video.setAttribute("aria-pressed", String(picture.recording));
    video.title = picture.recording ? "End the video and save it" : "Record a video of the view (WebM)";
    video.setAttribute("aria-label", picture.recording ? "End the video and save it" : "Record a video");
    twin.notice(picture.recording ? "Recording the view; click again to save the video" : "Video saved", "done");
  }) });
  return [
    button("Picture", { icon: "picture", bare: true, title: "Save a picture of the view (PNG)", onclick: () => void picture.png() }),
    video,
    button("Export", { icon: "download", onclick: () => void open(twin) }),
  ];
}

async function open(twin: Twin): Promise<void> {
  const scenario = twin.edited.value;
  let files: ExportFile[] = [];
  if (!(await twin.attempt(async () => void (files = await twin.api.exports(scenario))))) return;
  const fetchFile = (control: HTMLButtonElement, name: string, get: () => Promise<Blob>): void => {
    control.disabled = true;
    void twin.attempt(async () => save(name, await get())).then(() => (control.disabled = false));
  };
  const row = (name: string, what: string, size: number | null, get: () => Promise<Blob>): HTMLElement => {
    const control = button("Save", { class: "small", "aria-label": `Save ${name}`, onclick: () => fetchFile(control, name, get) });
    return h("tr", {}, h("th", { scope: "row" }, name, h("div", { class: "muted" }, what)), h("td", {}, size === null ? "" : bytes(size)), h("td", {}, control));
  };
  openDialog(dialog(`Export scenario ${scenario}`, h("p", { class: "hint" }, "The files contain the run up to now, as talus run writes them."),
    h("table", { class: "plain exports" }, h("tbody", {}, ...files.map((f) => row(f.name, f.what, f.bytes, () => twin.api.exported(scenario, f.name))),
      row("journal.json", "Every action with its step: a replay ends in the same state", null, () => twin.api.journal(scenario)))),
    files.length === 0 ? h("p", { class: "hint" }, "No results yet: run the simulation first.") : null));
}
