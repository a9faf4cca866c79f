import "./style/base.css";
import "./style/layout.css";
import "./style/panels.css";
import "./style/view.css";
import "./style/touch.css";
import { Api, Refused } from "./protocol/api";
import { Server } from "./protocol/server";
import { takeToken } from "./protocol/token";
import { h } from "./ui/dom";

const meshCells = 400_000;

async function begin(page: HTMLElement): Promise<void> {
  const token = takeToken();
  if (token === "") {
    say(page, "This page needs the complete link", "Open the link that talus serve printed. It ends in #token=…, which grants access.");
    return;
  }
  const server = new Server(token);
  const api = new Api(server);
  try {
    const place = await api.start();
    if (place.available && (place.open === null || location.hash === "#start")) {
      const { openStart } = await import("./start/start");
      openStart(page, api, place);
      return;
    }
    // The scene is fetched while the browser reads the larger part of the script.
    const [scene, terrain, { openPage }] = await Promise.all([api.scene(), api.terrain(meshCells), import("./page")]);
    document.title = `${scene.title} · talus`;
    page.classList.remove("starting");
    openPage(page, server, scene, terrain, api, place);
  } catch (error) {
    console.error(error);
    if (error instanceof Refused && (error.status === 401 || error.status === 403)) {
      say(page, "This link is not valid", `${error.message}. The server makes new links each time it starts: ask for the present one.`);
    } else {
      say(page, "The scene could not be opened", error instanceof Error ? error.message : String(error), true);
    }
  }
}

function say(page: HTMLElement, title: string, sentence: string, retry = false): void {
  page.replaceChildren(h("div", { class: "boot", role: "alert" }, h("h1", {}, title), h("p", {}, sentence),
    retry ? h("button", { type: "button", onclick: () => location.reload() }, "Try again") : null));
}

const page = document.getElementById("page");
if (page) void begin(page);
// A link opened in a tab that already shows the page only changes the fragment.
window.addEventListener("hashchange", () => {
  if (location.hash.includes("token=") || location.hash === "#start") location.reload();
});
