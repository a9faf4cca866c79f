// The page of a published twin: everything it shows is in the file itself, or in files beside it.
import "./style/base.css";
import "./style/layout.css";
import "./style/panels.css";
import "./style/view.css";
import "./style/touch.css";
import "./style/published.css";
import { openPage } from "./page";
import { Api } from "./protocol/api";
import type { StartPage } from "./protocol/start";
import { Recorded } from "./protocol/recorded";
import { Tape } from "./protocol/tape";
import type { Transport } from "./protocol/transport";
import { h } from "./ui/dom";

const meshCells = 400_000;

/** What talus publish says of its file. */
interface About { version: number; title: string; program: string; made_at: string; engine: boolean; sources: string[] }

const textOf = (id: string): string | null => document.getElementById(id)?.textContent ?? null;

/** Of a block of the file, in base64; otherwise of a file beside the page. */
async function bytesOf(id: string, file: string): Promise<Uint8Array> {
  const text = textOf(id);
  if (text === null) return new Uint8Array(await (await fetch(file)).arrayBuffer());
  document.getElementById(id)?.remove();
  return Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
}

async function begin(page: HTMLElement): Promise<void> {
  try {
    const about = JSON.parse(textOf("about") ?? "") as About;
    const transport: Transport = new Recorded(await Tape.open(await bytesOf("tape", "tape.bin")));
    const api = new Api(transport);
    const [scene, terrain] = await Promise.all([api.scene(), api.terrain(meshCells)]);
    page.classList.remove("starting");
    page.classList.add("published");
    page.classList.toggle("recording", !transport.can.change);
    openPage(page, transport, scene, terrain, api, { available: false } as StartPage);
    page.querySelector("h1")?.setAttribute("title", [`Published ${about.made_at.slice(0, 10)} with ${about.program}.`, ...about.sources].join(" "));
  } catch (error) {
    console.error(error);
    page.replaceChildren(h("div", { class: "boot", role: "alert" }, h("h1", {}, "This twin could not be opened"), h("p", {}, error instanceof Error ? error.message : String(error))));
  }
}

const page = document.getElementById("page");
if (page) void begin(page);
