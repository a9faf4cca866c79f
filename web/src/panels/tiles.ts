// The background map: addresses of map tiles that the program or people gave, and which of them this browser shows.
import type { TileAddress } from "../protocol/messages";
import { reloadWith } from "../protocol/token";
import { watchAll } from "../state/cell";
import { mayLoad, withoutScheme } from "../state/overlays";
import type { Twin } from "../state/twin";
import { button, h } from "../ui/dom";

/** What this tab shall show once it is loaded again. */
const wantedKey = "talus-tiles";

/** presentView: what a page that is loaded again opens with. */
export function tilesPanel(twin: Twin, presentView: () => string): HTMLElement {
  /** Chosen, but not allowed to this page before it is loaded again. */
  let waiting: string | null = null;
  let listed = "";
  const choice = h("select", { "aria-label": "Background map", onchange: () => choose(choice.value === "" ? null : choice.value) });
  const again = h("div", { class: "row", role: "status", hidden: true },
    h("p", { class: "hint grow" }, "This page was loaded before the address was added, and may not load from its host yet."),
    button("Reload and show", { class: "small", onclick: () => {
      if (waiting !== null) sessionStorage.setItem(wantedKey, waiting);
      reloadWith(presentView());
    } }));
  const list = h("ul", { class: "items" });
  const field = h("input", { type: "text", class: "grow", "aria-label": "Address of map tiles", placeholder: "https://tile.example.org/{z}/{x}/{y}.png", maxlength: 500, spellcheck: "false", autocomplete: "off", inputmode: "url" });
  const add = h("button", { type: "submit", class: "small" }, "Add address");
  const form = h("form", { onsubmit: (event: Event) => {
    event.preventDefault();
    const address = field.value.trim();
    if (address === "") return field.focus();
    void tell(() => twin.api.addTiles(address)).then((done) => {
      if (done) field.value = "";
    });
  } }, h("div", { class: "row" }, field, add),
  h("p", { class: "hint" }, "XYZ with {z}, {x} and {y}, or WMTS with {TileMatrix}, {TileCol} and {TileRow}, in Web Mercator. Everybody here sees the address, and any key in it; the map is off until somebody chooses it."));
  const whole = h("div", { class: "tiles", hidden: true }, h("label", { class: "row" }, "Background", choice), again,
    h("p", { class: "hint" }, "Tiles are fetched by your browser from this address and shown only to you; the provider can tell where the terrain is."), list, form);

  const choose = (address: string | null): void => {
    const allowed = address === null || mayLoad(address, twin.tilesAtLoad ?? []);
    waiting = allowed ? null : address;
    twin.tileAddress.value = allowed ? address : null;
    show();
  };
  const show = (): void => {
    choice.value = waiting ?? twin.tileAddress.value ?? "";
    again.hidden = waiting === null;
  };
  const tell = (ask: () => Promise<{ done: string }>): Promise<boolean> => twin.attempt(async () => {
    const { done } = await ask();
    twin.notice(`${done.charAt(0).toUpperCase()}${done.slice(1)}`, "done");
  });
  const row = ({ id, address, by }: TileAddress): HTMLElement => h("li", {}, h("div", { class: "row" },
    h("small", { class: "grow" }, `${withoutScheme(address)} · by ${by}`),
    button("Remove", { icon: "remove", bare: true, class: "bare quiet small", "aria-label": `Remove the map ${withoutScheme(address)}`, title: "Remove", disabled: twin.hindrance !== null, onclick: () => void tell(() => twin.api.removeTiles(id)) })));

  twin.tileAddress.watch(show);
  watchAll([twin.overlays, twin.you, twin.controller, twin.connection, twin.people], () => {
    const { hindrance } = twin;
    const mayAdd = twin.can.server && twin.you.value?.role === "controller";
    const tiles = twin.overlays.value?.tiles ?? [];
    whole.hidden = !twin.can.server || (tiles.length === 0 && !mayAdd);
    form.hidden = !mayAdd;
    field.disabled = add.disabled = hindrance !== null;
    field.title = add.title = hindrance ?? "";
    const key = JSON.stringify([tiles, hindrance !== null]);
    if (twin.overlays.value === null || key === listed) return;
    listed = key;
    choice.replaceChildren(h("option", { value: "" }, "No background map"), ...tiles.map(({ address }) => h("option", { value: address, title: address }, withoutScheme(address))));
    choice.disabled = tiles.length === 0;
    list.replaceChildren(...tiles.filter(({ by }) => by !== "").map(row));
    const there = (address: string | null): boolean => address !== null && tiles.some((one) => one.address === address);
    const wanted = sessionStorage.getItem(wantedKey);
    sessionStorage.removeItem(wantedKey);
    if (there(wanted)) choose(wanted);
    else if (twin.tileAddress.value !== null && !there(twin.tileAddress.value)) choose(null);  // somebody has removed it
    else if (waiting !== null && !there(waiting)) choose(null);
    else show();
  });
  return whole;
}
