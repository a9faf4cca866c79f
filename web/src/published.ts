// The page of a published twin: everything it shows is in the file itself, or in files beside it.
import "./style/base.css";
import "./style/layout.css";
import "./style/panels.css";
import "./style/view.css";
import "./style/touch.css";
import "./style/published.css";
import { openPage } from "./page";
import { Api } from "./protocol/api";
import { blockOf, inflatedBlock } from "./protocol/block";
import type { StartPage } from "./protocol/start";
import { Local, type HostPort } from "./protocol/local";
import { Recorded } from "./protocol/recorded";
import { Tape } from "./protocol/tape";
import type { Transport } from "./protocol/transport";
import { button, h } from "./ui/dom";
import { dialog, openDialog } from "./ui/dialog";

const meshCells = 400_000;
/** Of the address of the page on which the engine computes; without it the recording is shown. */
const engineMark = "#compute";

/** What talus publish says of its file. */
interface About { version: number; title: string; program: string; program_version: string; made_at: string; engine: boolean; sources: string[] }

const textOf = (id: string): string | null => document.getElementById(id)?.textContent ?? null;

/** A block as it is, otherwise a file beside the page. */
const bytesOf = async (id: string, file: string): Promise<Uint8Array> =>
  blockOf(id) ?? new Uint8Array(await (await fetch(file)).arrayBuffer());

/** The worker of the engine: from the file itself, or from beside the page. */
async function engineWorker(): Promise<Worker> {
  const script = await (await inflatedBlock("worker"))?.arrayBuffer();
  // No module: it imports nothing, and a page from disk has no origin that a module could be asked from.
  return new Worker(script === undefined ? "worker.js" : URL.createObjectURL(new Blob([script], { type: "text/javascript" })));
}

async function openEngine(beside: Transport): Promise<Local> {
  const [scene, inFile, worker] = await Promise.all([bytesOf("scene", "scene.bin"), inflatedBlock("engine"), engineWorker()]);
  const wasm = await (inFile ?? await fetch("talus_engine.wasm")).arrayBuffer();
  return Local.open(worker as unknown as HostPort, scene, wasm, beside, (sentence) =>
    openDialog(dialog("The computation has ended", h("p", { class: "hint" }, sentence), h("p", { class: "hint" }, "Reload the page to begin again; what was not exported is lost."))));
}
/** To the engine, or back to the recording: another page, since neither knows the other's session. */
const turn = (engine: boolean): void => {
  history.replaceState(null, "", engine ? engineMark : "#");
  location.reload();
};

async function begin(page: HTMLElement): Promise<void> {
  try {
    const about = JSON.parse(textOf("about") ?? "") as About;
    const recorded = new Recorded(await Tape.open(await bytesOf("tape", "tape.bin")));
    const computes = about.engine && location.hash === engineMark;
    const transport: Transport = computes ? await openEngine(recorded) : recorded;
    const api = new Api(transport);
    const [scene, terrain] = await Promise.all([api.scene(), api.terrain(meshCells)]);
    page.classList.remove("starting");
    page.classList.add("published");
    page.classList.toggle("recording", !transport.can.change);
    openPage(page, transport, scene, terrain, api, { available: false } as StartPage);
    page.querySelector("h1")?.setAttribute("title", [`Published ${about.made_at.slice(0, 10)} with talus ${about.program_version}.`, ...about.sources].join(" "));
    if (about.engine) page.querySelector(".topbar .spring")?.after(computes
      ? button("Recording", { class: "turn", title: "Back to the run that this file holds; changes that were not exported are lost", onclick: () => turn(false) })
      : button("Change it", { class: "primary turn", title: "Compute on this device: change values, draw barriers, run again", onclick: () => turn(true) }));
  } catch (error) {
    console.error(error);
    page.replaceChildren(h("div", { class: "boot", role: "alert" }, h("h1", {}, "This twin could not be opened"), h("p", {}, error instanceof Error ? error.message : String(error)),
      location.hash === engineMark ? button("Show the recording", { onclick: () => turn(false) }) : null));
  }
}

const page = document.getElementById("page");
if (page) void begin(page);
