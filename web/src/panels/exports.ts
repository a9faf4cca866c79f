// Files of the run so far, the journal, and pictures of the view.
import { Refused } from "../protocol/api";
import type { ExportFile } from "../protocol/messages";
import { bytes } from "../state/format";
import { mostZipped_bytes, zip, type Member } from "../state/zip";
import type { Twin } from "../state/twin";
import { button, h } from "../ui/dom";
import { dialog, openDialog } from "../ui/dialog";
import type { Stage } from "../scene/stage";
import { briefingButton } from "./briefing";
import { flowExport } from "./flow_export";
import { save } from "../ui/save";
import type { Picture } from "./picture";

export function exportButtons(twin: Twin, stage: Stage, picture: Picture): HTMLElement[] {
  const video = button("Record a video", { icon: "video", bare: true, title: "Record a video of the view (WebM)", onclick: () => picture.video(() => {
    video.setAttribute("aria-pressed", String(picture.recording));
    video.title = picture.recording ? "End the video and save it" : "Record a video of the view (WebM)";
    video.setAttribute("aria-label", picture.recording ? "End the video and save it" : "Record a video");
    twin.notice(picture.recording ? "Recording the view; click again to save the video" : "Video saved", "done");
  }) });
  return [
    button("Picture", { icon: "picture", bare: true, title: "Save a picture of the view (PNG)", onclick: () => picture.png() }),
    video,
    briefingButton(twin, stage, picture),
    button("Export", { icon: "download", onclick: () => void open(twin, picture) }),
  ];
}

interface Offer { name: string; what: string; bytes: number | null; get: () => Promise<Blob> }

/** What is usually wanted of a run. */
const usual = new Set(["report.html", "front.csv", "run_out.csv", "buildings.csv", "timeseries.csv", "gauges.csv", "results.gpkg", "manifest.json", "journal.json"]);

async function open(twin: Twin, picture: Picture): Promise<void> {
  const scenario = twin.edited.value;
  let files: ExportFile[] = [];
  let flow: HTMLElement | null = null;
  if (!(await twin.attempt(async () => {
    files = await twin.api.exports(scenario);
    if (twin.can.server) flow = await flowExport(twin, scenario, picture.fileName);
  }))) return;
  const offers: Offer[] = [
    ...files.map((f): Offer => ({ name: f.name, what: f.what, bytes: f.bytes, get: () => twin.api.exported(scenario, f.name) })),
    { name: "journal.json", what: "Every action with its step: a replay ends in the same state", bytes: null, get: () => twin.api.journal(scenario) },
    { name: "view.png", what: "The view as it is, with legends and scale", bytes: null, get: async () => (await picture.file()).content },
  ];
  const rows = offers.map((offer) => {
    const tick = h("input", { type: "checkbox", checked: usual.has(offer.name), onchange: () => count() });
    return { offer, tick, element: h("tr", {}, h("th", { scope: "row" }, h("label", { class: "check" }, tick, offer.name), h("div", { class: "muted" }, offer.what)),
      h("td", {}, offer.bytes === null ? "" : bytes(offer.bytes))) };
  });
  const all = h("input", { type: "checkbox", onchange: () => {
    for (const row of rows) row.tick.checked = all.checked;
    count();
  } });
  const control = button("", { class: "primary", icon: "download", onclick: () => {
    control.disabled = true;
    void twin.attempt(async () => save(`${picture.fileName}-${scenario}.zip`, await packed(rows.filter((row) => row.tick.checked).map((row) => row.offer)))).then(count);
  } });
  const count = (): void => {
    const ticked = rows.filter((row) => row.tick.checked).length;
    control.replaceChildren(h("span", {}, `Save ${ticked} ${ticked === 1 ? "file" : "files"} as ZIP`));
    control.disabled = ticked === 0;
    all.checked = ticked === rows.length;
    all.indeterminate = ticked > 0 && ticked < rows.length;
  };
  count();
  const hint = files.length > 0
    ? `The files contain the run up to now, as talus run writes them${twin.can.change && !twin.can.server ? "; maps are not compressed and have no styles, and a report needs the program" : ""}.`
    : "No results yet: run the simulation first.";
  openDialog(dialog(`Export scenario ${scenario}`, h("p", { class: "hint" }, hint),
    h("div", { class: "row" }, h("label", { class: "check grow" }, all, "All files"), control),
    h("table", { class: "plain exports" }, h("tbody", {}, ...rows.map((row) => row.element))), flow));
}

/** One after the other: the server writes a run's files once. */
async function packed(offers: readonly Offer[]): Promise<Blob> {
  const members: Member[] = [];
  let sum = 0;
  for (const { name, get } of offers) {
    const content = new Uint8Array(await (await get()).arrayBuffer());
    sum += content.length;
    if (sum > mostZipped_bytes) throw new Refused(0, `The files ticked are larger than ${bytes(mostZipped_bytes)} together: untick some, or take the large ones by /api/scenarios.`);
    members.push({ name, bytes: content });
  }
  return zip(members, new Date());
}
