// The moving flow as files for other programs, in the dialog of exports: what, how large, how far, and to be saved.
import { Refused } from "../protocol/api";
import type { FlowExport, FlowFormat, FlowOffer } from "../protocol/messages";
import type { ScenarioName } from "../protocol/frame";
import { flowProgress, flowSummary, flowTitles, intervalProblem } from "../state/flow";
import { bytes } from "../state/format";
import type { Twin } from "../state/twin";
import { mostZipped_bytes, zip, type Member } from "../state/zip";
import { button, h } from "../ui/dom";
import { save } from "../ui/save";

const askEvery_ms = 400;

/** `name`: of what is saved, without its ending. */
export async function flowExport(twin: Twin, scenario: ScenarioName, name: string): Promise<HTMLElement> {
  let offer = await twin.api.flowOffer(scenario, null);
  let job = await twin.api.flow();
  const chosen = new Set<FlowFormat>(["gltf"]);
  const reader = twin.you.value?.role === "viewer";

  const table = h("tbody", {});
  const summary = h("p", { class: "hint flow-summary", role: "status" });
  const interval = h("input", { type: "number", step: "any", min: offer.shortest_interval_s, "aria-label": "Seconds between frames", value: String(offer.interval_s) });
  const start = button("Write files", { class: "primary", onclick: () => void begin() });
  const bar = h("progress", { "aria-label": "Share written", max: 1 });
  const told = h("p", { class: "flow-told", role: "status" });
  const cancel = button("Cancel", { class: "small", onclick: () => void twin.attempt(async () => show(await twin.api.cancelFlow())).then(follow) });
  const saving = button("", { class: "primary", icon: "download", onclick: () => {
    saving.disabled = true;
    void twin.attempt(() => saveFiles(twin, job, name)).then(() => (saving.disabled = false));
  } });
  const element = h("section", { class: "flow-export", "aria-label": "Moving flow" }, h("h3", {}, "Moving flow"),
    h("p", { class: "hint" }, "The debris over time as shown in the view, including changes made during the run. An animation has at most 100 frames; maps may use up to 2 GB of disk while they are being written."),
    reader ? h("p", { class: "hint" }, "This is a viewer's link: ask somebody with the controllers' link to write the files.") : h("div", {},
      h("table", { class: "plain exports" }, table),
      h("div", { class: "row" }, h("label", { class: "row grow" }, "One frame every", interval, "s"), start), summary),
    told, h("div", { class: "row" }, bar, cancel), saving);

  const showOffer = (): void => {
    table.replaceChildren(...offer.formats.map((format) => {
      const tick = h("input", { type: "checkbox", checked: chosen.has(format.name) && format.refused === null, disabled: format.refused !== null, onchange: () => {
        if (tick.checked) chosen.add(format.name);
        else chosen.delete(format.name);
        summarise();
      } });
      return h("tr", {}, h("th", { scope: "row" }, h("label", { class: "check" }, tick, flowTitles[format.name]),
        h("div", { class: "muted" }, format.refused === null ? `${format.what}: ${format.files.join(", ")}` : `Not available: ${format.refused}`)),
      h("td", {}, format.refused === null ? `about ${bytes(format.bytes)}` : ""));
    }));
    summarise();
  };
  const wanted = (): FlowFormat[] => offer.formats.filter((format) => chosen.has(format.name) && format.refused === null).map((format) => format.name);
  const problem = (): string => intervalProblem(interval.value, offer.shortest_interval_s);
  const enable = (): void => void (start.disabled = problem() !== "" || wanted().length === 0 || busy(job));
  const summarise = (): void => {
    summary.textContent = problem() || flowSummary(offer, wanted());
    enable();
  };
  const show = (now: FlowExport): void => {
    job = now;
    const text = flowProgress(job);
    if (told.textContent !== text) told.textContent = text;
    told.hidden = text === "";
    told.classList.toggle("bad", job.state === "failed");
    bar.hidden = cancel.hidden = !busy(job);
    cancel.disabled = reader || job.state === "cancelling";
    bar.value = job.share ?? 0;
    saving.hidden = job.state !== "done";
    saving.replaceChildren(h("span", {}, job.files.length === 1 ? `Save ${job.files[0]?.name ?? ""}` : `Save ${job.files.length} files as ZIP`));
    summarise();
  };
  let following = false;
  /** Asks until it has ended or nobody sees it. */
  const follow = async (): Promise<void> => {
    if (following) return;
    following = true;
    while (busy(job) && (await twin.attempt(async () => show(await twin.api.flow())))) {
      await new Promise((resolve) => setTimeout(resolve, askEvery_ms));
      if (!element.isConnected) break;
    }
    following = false;
  };
  const begin = async (): Promise<void> => {
    // As it is typed: the offer for it may not have come yet.
    if (problem() !== "") return summarise();
    start.disabled = true;
    await twin.attempt(async () => show(await twin.api.startFlow(scenario, wanted(), Number(interval.value))));
    summarise();
    await follow();
  };
  let asked = 0;
  interval.addEventListener("input", enable);
  interval.addEventListener("change", () => {
    const question = ++asked;
    if (problem() !== "") return summarise();
    void twin.attempt(async () => {
      const answer: FlowOffer = await twin.api.flowOffer(scenario, Number(interval.value));
      if (question !== asked) return;
      offer = answer;
      showOffer();
    });
  });
  showOffer();
  show(job);
  queueMicrotask(() => void follow());
  return element;
}

const busy = (job: FlowExport): boolean => job.state === "running" || job.state === "cancelling";

async function saveFiles(twin: Twin, job: FlowExport, name: string): Promise<void> {
  const [first] = job.files;
  if (first === undefined) return;
  if (job.files.length === 1) {
    save(`${name}-${job.scenario}${first.name.slice(first.name.lastIndexOf("."))}`, await twin.api.flowFile(first.name));
    return;
  }
  const size = job.files.reduce((sum, file) => sum + file.bytes, 0);
  if (size > mostZipped_bytes) throw new Refused(0, `The files are larger than ${bytes(mostZipped_bytes)} together: write fewer formats at a time, or choose a longer interval.`);
  const members: Member[] = [];
  for (const file of job.files) members.push({ name: file.name, bytes: new Uint8Array(await (await twin.api.flowFile(file.name)).arrayBuffer()) });
  save(`${name}-${job.scenario}-flow.zip`, zip(members, new Date()));
}
