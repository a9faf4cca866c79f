// The layers that people lay over the terrain: their list, files that are dropped on the page, and what a feature is.
import type { Overlay, WantedOverlay } from "../protocol/messages";
import type { FoundFeature, OverlayLayers } from "../scene/overlays";
import type { Stage } from "../scene/stage";
import { watchAll } from "../state/cell";
import { count, number } from "../state/format";
import { groupFiles, listKey, seenAs, withOwn, withoutOwn, type OwnLook } from "../state/overlays";
import type { Twin } from "../state/twin";
import { zip } from "../state/zip";
import { dialog, openDialog } from "../ui/dialog";
import { button, h } from "../ui/dom";
import { tilesPanel } from "./tiles";

const accepted = ".gpkg,.geojson,.json,.zip,.shp,.shx,.dbf,.prj,.cpg,.fgb,.kml,.tif,.tiff,.tfw,.png,.pgw,.jpg,.jpeg,.jgw,.wld";
const nearest_px = 8;

/** Those that belong together as one file. */
async function packed(main: File, parts: readonly File[]): Promise<File> {
  if (parts.length === 0) return main;
  const members = await Promise.all([main, ...parts].map(async (file) => ({ name: file.name, bytes: new Uint8Array(await file.arrayBuffer()) })));
  return new File([zip(members, new Date())], `${main.name.replace(/\.[^.]*$/, "")}.zip`);
}

export class OverlaysPanel {
  readonly element: HTMLElement;
  /** Over the view: what was clicked. */
  readonly card = h("div", { class: "feature-card", role: "status", hidden: true });
  private readonly progress = h("p", { class: "hint", role: "status", hidden: true });
  private readonly list = h("ul", { class: "items overlays" });
  private listed = "";
  private busy = false;

  constructor(private readonly twin: Twin, private readonly stage: Stage, private readonly layers: OverlayLayers, presentView: () => string) {
    const chooser = h("input", { type: "file", multiple: true, accept: accepted, hidden: true, "aria-label": "Files of the layer", onchange: () => {
      void this.add([...(chooser.files ?? [])]);
      chooser.value = "";
    } });
    const add = button("Add layer…", { icon: "plus", class: "small", onclick: () => (twin.hindrance === null ? chooser.click() : twin.notice(twin.hindrance, "error")) });
    const undo = button("", { icon: "undo", class: "small", onclick: () => void this.tell(() => twin.api.restoreOverlay()) });
    const hint = h("p", { class: "hint" }, "Drop files onto the page: GeoPackage, GeoJSON, Shapefile (all of its files, or a ZIP) or GeoTIFF. Everybody sees them; they are saved with the session and do not affect the run.");
    watchAll([twin.overlays, twin.ownOverlays, twin.you, twin.controller, twin.connection, twin.people], () => {
      const { hindrance } = twin;
      const overlays = twin.overlays.value;
      add.disabled = hindrance !== null;
      add.title = hindrance ?? "Add roads, parcels, evacuation routes, geology or a map from files";
      hint.hidden = !twin.can.server || (overlays?.overlays.length ?? 0) > 0;
      undo.hidden = !twin.can.server || overlays === null || overlays.removed === null;
      undo.disabled = hindrance !== null;
      undo.querySelector("span")?.replaceChildren(`Undo removal of ${overlays?.removed ?? ""}`);
      this.fill();
    });
    this.element = h("div", { class: "overlays-panel" }, h("div", { class: "group-head" }, h("h3", {}, "Layers"), add, chooser), this.progress, hint, this.list, undo, tilesPanel(twin, presentView));
    this.listen();
  }

  /** Only where it changes: what is clicked, or open, would be lost. */
  private fill(): void {
    const { list, twin } = this;
    const overlays = twin.overlays.value?.overlays ?? [];
    const key = listKey(overlays, twin.ownOverlays.value, twin.hindrance !== null);
    if (key === this.listed) return;
    this.listed = key;
    const focused = list.contains(document.activeElement) ? document.activeElement?.getAttribute("aria-label") : null;
    // The uppermost first.
    list.replaceChildren(...[...overlays].reverse().map((overlay) => this.row(overlay)));
    if (focused) list.querySelector<HTMLElement>(`[aria-label="${CSS.escape(focused)}"]`)?.focus();
  }
  private row(overlay: Overlay): HTMLElement {
    const { twin } = this;
    const mine = twin.hindrance !== null;
    const { visible, opacity } = seenAs(overlay, twin.ownOverlays.value.get(overlay.id));
    const see = (wanted: OwnLook): void => {
      if (mine) twin.ownOverlays.value = withOwn(twin.ownOverlays.value, overlay.id, wanted);
      else {
        twin.ownOverlays.value = withoutOwn(twin.ownOverlays.value, overlay.id);
        this.change(overlay, wanted);
      }
    };
    const forWhom = mine ? "for yourself only" : "for everybody";
    const on = h("input", { type: "checkbox", "aria-label": `Show ${overlay.name}`, title: `Show or hide it ${forWhom}`, onchange: () => see({ visible: on.checked }) });
    on.checked = visible;
    const slider = h("input", { type: "range", min: "0.1", max: "1", step: "0.05", "aria-label": `Opacity of ${overlay.name}`, title: `Opacity ${forWhom}`, onchange: () => see({ opacity: slider.valueAsNumber }) });
    slider.value = String(opacity);
    const colour = overlay.kind === "vector" && !overlay.styled
      ? h("input", { type: "color", "aria-label": `Colour of ${overlay.name}`, title: "Colour", disabled: mine, value: overlay.colour, onchange: () => this.change(overlay, { colour: colour?.value ?? overlay.colour }) }) : null;
    const what = [overlay.kind === "picture" ? "picture" : `${count(overlay.features)} feature${overlay.features === 1 ? "" : "s"}`,
      overlay.outside > 0 ? `${count(overlay.outside)} outside the terrain` : "", overlay.low !== null && overlay.high !== null ? `${number(overlay.low)} to ${number(overlay.high)}` : "",
      overlay.styled && overlay.kind === "vector" ? "own style" : "", overlay.note, overlay.by ? `by ${overlay.by}` : ""].filter(Boolean).join(" · ");
    return h("li", { "data-overlay": overlay.id },
      h("div", { class: "row" }, h("label", { class: "check grow" }, on, h("b", { class: "grow" }, overlay.name)), colour,
        button("Zoom to", { icon: "fit", bare: true, class: "bare quiet small", "aria-label": `Zoom to ${overlay.name}`, title: "Zoom to it", onclick: () => this.layers.zoomTo(overlay.id) }),
        button("Rename", { icon: "edit", bare: true, class: "bare quiet small", "aria-label": `Rename ${overlay.name}`, title: "Rename", disabled: mine, onclick: () => this.rename(overlay) }),
        button("Remove", { icon: "remove", bare: true, class: "bare quiet small", "aria-label": `Remove ${overlay.name}`, title: "Remove", disabled: mine, onclick: () => void this.tell(() => twin.api.removeOverlay(overlay.id)) })),
      h("div", { class: "row" }, slider, h("small", { class: "muted grow" }, what)));
  }
  private change(overlay: Overlay, wanted: WantedOverlay): void {
    void this.tell(() => this.twin.api.changeOverlay(overlay.id, wanted), false).then((done) => {
      if (done) return;
      this.listed = "";  // the control shows what was refused
      this.fill();
    });
  }
  private tell(ask: () => Promise<{ done: string }>, loud = true): Promise<boolean> {
    return this.twin.attempt(async () => {
      const { done } = await ask();
      if (loud) this.twin.notice(`${done.charAt(0).toUpperCase()}${done.slice(1)}`, "done");
    });
  }
  private rename(overlay: Overlay): void {
    const text = h("input", { type: "text", class: "grow", "aria-label": "Name of the layer", maxlength: 60, value: overlay.name, autofocus: true });
    const element = dialog("Rename the layer", h("form", { onsubmit: (event: Event) => {
      event.preventDefault();
      if (text.value.trim() === "") return text.focus();
      this.change(overlay, { name: text.value.trim() });
      element.close();
    } }, h("div", { class: "row" }, text), h("div", { class: "row answers" }, h("button", { type: "submit", class: "primary" }, "Save"), button("Cancel", { class: "quiet", onclick: () => element.close() }))));
    openDialog(element);
  }

  private async add(files: readonly File[]): Promise<void> {
    const { twin } = this;
    if (files.length === 0) return;
    if (twin.hindrance !== null) return twin.notice(twin.hindrance, "error");
    if (this.busy) return twin.notice("Other files are still being read. Add these when they are done.", "error");
    const { groups, alone } = groupFiles(files.map((file) => file.name));
    if (alone.length > 0) twin.notice(`${alone[0]} belongs to another file with the same name; drop both together.`, "error");
    const named = (name: string): File => files.find((file) => file.name === name) as File;
    this.busy = true;
    for (const { main, parts } of groups) {
      await this.tell(async () => {
        const file = await packed(named(main), parts.map(named));
        this.say(`Uploading ${main}… 0 %`);
        return twin.api.addOverlay(file, (share) => this.say(share < 1 ? `Uploading ${main}… ${Math.round(100 * share)} %` : `Reading ${main}…`));
      });
    }
    this.busy = false;
    this.say("");
  }
  private say(sentence: string): void {
    this.progress.hidden = sentence === "";
    this.progress.textContent = sentence;
  }

  private listen(): void {
    const hasFiles = (event: DragEvent): boolean => event.dataTransfer?.types.includes("Files") ?? false;
    const mark = (on: boolean): void => void this.stage.element.classList.toggle("dropping", on);
    // A field for files takes its own, such as a private key; with a dialog open nothing else does.
    const forField = (event: DragEvent): boolean => event.target instanceof HTMLInputElement && event.target.type === "file";
    const inDialog = (): boolean => document.querySelector("dialog[open]") !== null;
    document.addEventListener("dragover", (event) => {
      if (!hasFiles(event) || forField(event)) return mark(false);
      event.preventDefault();
      if (inDialog() && event.dataTransfer) event.dataTransfer.dropEffect = "none";
      mark(!inDialog());
    });
    document.addEventListener("dragleave", (event) => event.relatedTarget === null && mark(false));
    document.addEventListener("drop", (event) => {
      mark(false);
      if (!hasFiles(event) || forField(event)) return;
      event.preventDefault();
      if (!inDialog()) void this.add([...(event.dataTransfer?.files ?? [])]);
    });
    const { canvas } = this.stage;
    let down: PointerEvent | null = null;
    // Before the tool hears of it: a click that it uses, perhaps its last one, is not for a feature.
    canvas.addEventListener("pointerdown", (event) => (down = event.button === 0 && this.twin.tool.value.kind === "none" ? event : null), { capture: true });
    canvas.addEventListener("pointerup", (event) => {
      if (!down || Math.hypot(event.clientX - down.clientX, event.clientY - down.clientY) > 5) return;
      const hit = this.stage.hit(event.clientX, event.clientY);
      this.tellOf(hit ? this.layers.at(hit.world[0], hit.world[1], nearest_px * this.stage.metresPerPixel) : null);
    });
    document.addEventListener("keydown", (event) => {
      if (event.key === "Escape" && !inDialog()) this.tellOf(null);
    });
    this.twin.overlays.watch(() => this.tellOf(null));
  }
  private tellOf(found: FoundFeature | null): void {
    this.card.hidden = found === null;
    if (found === null) return;
    const { overlay, feature } = found;
    const rows = Object.entries(feature.attributes).flatMap(([key, value]) => [h("dt", {}, key), h("dd", {}, typeof value === "number" ? String(value) : value)]);
    this.card.replaceChildren(h("div", { class: "row" }, h("b", { class: "grow" }, feature.name || overlay.name), button("Close", { icon: "close", bare: true, class: "bare quiet small", onclick: () => this.tellOf(null) })),
      feature.name ? h("small", { class: "muted" }, overlay.name) : "", h("dl", {}, ...rows));
  }
}
