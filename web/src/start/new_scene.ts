// A new scene from the user's own files: what is missing or odd is said here, and what can be done about it.
import type { Api } from "../protocol/api";
import type { Checked, Draft, DraftRole, MendingOfTerrain, UploadLimits } from "../protocol/start";
import { bytes, fixed } from "../state/format";
import { heightsText, heightUnit, heightUnits } from "../state/heights";
import { choice } from "../ui/choice";
import { button, h } from "../ui/dom";
import { ScarMap } from "./scar_map";

const check_ms = 500;

const slots: readonly (readonly [DraftRole, string, string])[] = [
  ["terrain", "Terrain", "An elevation model: GeoTIFF, ASCII grid or another raster. Required."],
  ["release", "Release", "Polygons, or a raster of thickness in metres. Or draw it on the map."],
  ["buildings", "Buildings", "Footprints (GeoPackage, GeoJSON, zipped Shapefile) or CityJSON, OBJ, glTF."],
  ["orthophoto", "Orthophoto", "A picture of the ground from above, with its position."],
  ["bundle", "A whole scene", "Instead of the files above: a ZIP archive saved by talus."],
];

export class NewScene {
  private readonly said = h("div", { class: "new-said", "aria-live": "polite" });
  private readonly title = h("input", { type: "text", maxlength: 100, "aria-label": "Title of the scene", placeholder: "Title", oninput: () => this.later() });
  private readonly amount = h("input", { type: "number", step: "any", min: 0, "aria-label": "Thickness or volume", placeholder: "Not given", onchange: () => this.later() });
  private readonly unit = h("span", { class: "muted" }, "m, normal to the slope");
  private readonly amounts = h("div", { class: "row wrap" }, choice("How much is released", [["thickness", "Thickness"], ["volume", "Volume"]], "thickness", (value) => {
    this.byVolume = value === "volume";
    this.unit.textContent = this.byVolume ? "m³" : "m, normal to the slope";
    this.later();
  }), this.amount, this.unit);
  private readonly cards = new Map<DraftRole, { holder: HTMLElement; card: HTMLElement }>();
  private readonly mendings = h("div", { class: "new-mend" });
  private readonly map = new ScarMap(() => this.later());
  private readonly create = button("Create and open", { icon: "run", class: "primary", disabled: true, onclick: () => void this.finish() });
  readonly element: HTMLElement;
  private draft: Draft | null = null;
  private byVolume = false;
  /** Its user has said what the unit of the heights is, so that the file's own is no longer proposed. */
  private heightsChosen = false;
  private mending: MendingOfTerrain = { epsg: null, local: false, metric: false, metres_per_unit: null, nodata: null };
  /** Counts what was asked, so that an answer to an earlier state is not shown. */
  private asked = 0;
  private timer = 0;
  private busy = 0;

  constructor(private readonly api: Api, private readonly id: string, limits: UploadLimits,
    private readonly ondone: (scene: string, title: string) => void, private readonly onclose: () => void) {
    const left = h("div", { class: "new-files" }, ...slots.map(([role, name, hint]) => this.slot(role, name, hint)));
    this.element = h("section", { class: "new-scene", "aria-labelledby": "new-scene" },
      h("div", { class: "start-title" }, h("h2", { id: "new-scene" }, "New scene"), button("Discard", { class: "quiet", onclick: () => void this.discard() })),
      h("p", { class: "muted" }, `Drop files here. They stay on the computer that runs talus. Limits: ${bytes(limits.bytes)} together, ${Math.round(limits.cells / 1e6)} million cells.`),
      h("div", { class: "new-columns" }, left, h("div", { class: "new-map" }, this.map.element, this.amounts)),
      this.said, h("div", { class: "row new-last" }, this.title, this.create));
    this.map.show(null, null);
    this.amounts.hidden = true;
    this.say();
  }

  private slot(role: DraftRole, name: string, hint: string): HTMLElement {
    const input = h("input", { type: "file", class: "unseen", tabindex: -1, "aria-label": `File of: ${name}`, onchange: () => {
      const file = input.files?.[0];
      input.value = "";
      if (file) void this.upload(role, file);
    } });
    const holder = h("div", { class: "grow" });
    const card = h("div", { class: "new-slot", "data-role": role,
      ondragover: (event: DragEvent) => {
        event.preventDefault();
        card.classList.add("over");
      },
      ondragleave: () => card.classList.remove("over"),
      ondrop: (event: DragEvent) => {
        event.preventDefault();
        card.classList.remove("over");
        const files = [...(event.dataTransfer?.files ?? [])];
        if (files.length > 1) return this.complain("Several files were dropped. Pack files that belong together, such as the parts of a Shapefile, into one ZIP archive.");
        if (files[0]) void this.upload(role, files[0]);
      } },
      h("div", { class: "row" }, holder, input, button("Choose", { class: "small", "aria-label": `Choose a file: ${name}`, onclick: () => input.click() })));
    if (role === "terrain") card.append(this.mendings);
    this.cards.set(role, { holder, card });
    holder.replaceChildren(h("b", {}, name), h("span", { class: "muted" }, hint));
    return card;
  }

  private async upload(role: DraftRole, file: File): Promise<void> {
    if (this.draft && file.size > this.draft.bytes_left) return this.complain(`${file.name} has ${bytes(file.size)}; ${bytes(this.draft.bytes_left)} are left of the limit. Crop it to the area of interest.`);
    if (file.size === 0) return this.complain(`${file.name} is empty.`);
    if (role === "terrain") this.heightsChosen = false;
    if (role === "terrain") this.mending = { epsg: null, local: false, metric: false, metres_per_unit: null, nodata: null };
    await this.change("Uploading… 0 %", () => this.api.uploadToDraft(this.id, role, file, (share) => this.tell(share < 1 ? `Uploading… ${Math.floor(100 * share)} %` : `Reading ${file.name}…`)));
  }
  private tell(what: string): void {
    this.said.replaceChildren(h("p", { class: "card", role: "status" }, what));
  }
  /** Asks for another state of the draft and shows it. */
  private async change(what: string, ask: () => Promise<Draft>): Promise<void> {
    const before = this.draft?.terrain ?? null;
    ++this.asked;
    ++this.busy;
    this.create.disabled = true;
    this.tell(what);
    try {
      const draft = await ask();
      this.draft = draft;
      --this.busy;
      if (this.title.value === "" && draft.files.terrain) this.title.value = draft.files.terrain.name.replace(/\.gz$/i, "").replace(/\.[^.]*$/, "").replace(/[_-]+/g, " ");
      this.showFiles(draft);
      if (JSON.stringify(before) !== JSON.stringify(draft.terrain)) await this.showMap(draft);
      this.later(0);
    } catch (error) {
      this.busy = Math.max(0, this.busy - 1);
      this.complain(error instanceof Error ? error.message : String(error));
    }
  }
  private async showMap({ terrain }: Draft): Promise<void> {
    this.map.show(terrain && terrain.problem === null ? await this.api.reliefOfDraft(this.id) : null, terrain?.cell_m ?? null);
  }
  private showFiles(draft: Draft): void {
    for (const [role, name, hint] of slots) {
      const place = this.cards.get(role);
      const file = draft.files[role];
      place?.card.classList.toggle("has", file !== undefined);
      place?.holder.replaceChildren(h("b", {}, name), file === undefined ? h("span", { class: "muted" }, hint)
        : h("span", { class: "new-file" }, `${file.name} · ${bytes(file.bytes)}`, button(`Remove ${file.name}`, { icon: "close", bare: true, class: "bare quiet small", onclick: () => void this.change("…", () => this.api.removeFromDraft(this.id, role)) })));
    }
    this.showMendings(draft);
    this.showAmounts(draft);
  }
  private showAmounts(draft: Draft): void {
    const raster = draft.files.release?.kind === "raster" && this.map.scar === null;
    this.amounts.hidden = draft.terrain === null || draft.terrain.problem !== null || raster;
  }
  /** What is wrong with the terrain, and what can be done about it. */
  private showMendings(draft: Draft): void {
    const terrain = draft.terrain;
    if (terrain === null) return this.mendings.replaceChildren();
    const mend = (part: Partial<MendingOfTerrain>): void => {
      const wanted = { ...this.mending, ...part };
      void this.change("Converting the terrain…", async () => {
        const changed = await this.api.mendDraft(this.id, wanted);
        this.mending = wanted;
        return changed;
      });
    };
    const numberOf = (input: HTMLInputElement): number | null => (input.value === "" ? null : Number(input.value));
    const epsg = h("input", { type: "number", min: 1024, max: 999999, value: this.mending.epsg ?? "", placeholder: "2326", "aria-label": "EPSG code of the terrain" });
    const nodata = h("input", { type: "number", step: "any", value: this.mending.nodata ?? "", placeholder: "none", "aria-label": "Value that means no data", onchange: () => mend({ nodata: numberOf(nodata) }) });
    const factor = this.mending.metres_per_unit;
    // Heights of a file in feet are in feet, unless its user says otherwise: a conversion of the cells alone would leave them.
    const proposed = heightUnit(factor, this.heightsChosen ? null : terrain.height_unit_m);
    const units = heightUnits(proposed);
    const unit = h("select", { "aria-label": "Unit of the heights", onchange: () => {
      this.heightsChosen = true;
      mend({ metres_per_unit: unit.value === "" ? null : Number(unit.value) });
    } }, ...units.map(([value, text]) => h("option", { value: value === null ? "" : String(value), selected: value === proposed }, text)));
    const unitName = units.find(([value]) => value === proposed)?.[1] ?? "";
    const rows = [
      terrain.crs === "" || this.mending.epsg !== null || this.mending.local ? h("div", { class: "row wrap" }, h("span", {}, "Reference system, EPSG:"), epsg, button("Apply", { class: "small", onclick: () => mend({ epsg: numberOf(epsg), local: false }) }),
        this.mending.local ? null : button("None: local coordinates in metres", { class: "small", title: "For a laboratory model, such as a flume, whose location on Earth does not matter", onclick: () => mend({ epsg: null, local: true }) })) : null,
      this.mending.metric ? button("Undo conversion", { class: "small", onclick: () => mend({ metric: false }) })
        : terrain.problem !== null && terrain.metric_crs !== "" ? button(`Convert to square cells in metres (${terrain.metric_crs})`, { class: "small", onclick: () => mend({ metric: true, metres_per_unit: proposed }) }) : null,
      proposed !== factor ? h("div", { class: "row wrap" }, h("span", {}, `The file suggests heights in ${unitName}.`), button(`Convert heights from ${unitName}`, { class: "small", onclick: () => mend({ metres_per_unit: proposed }) })) : null,
      h("div", { class: "row wrap" }, h("label", {}, "Heights are in ", unit), h("label", {}, "no data is ", nodata)),
    ];
    this.mendings.replaceChildren(terrain.problem === null
      ? h("p", { class: "muted" }, [`${terrain.columns} × ${terrain.rows} cells of ${fixed(terrain.cell_m ?? NaN, 2)} m`, heightsText(terrain.elevation_m), terrain.crs, (terrain.nodata_share ?? 0) > 0 ? `${fixed(100 * (terrain.nodata_share ?? 0), 1)} % without data` : ""].filter((part) => part !== "").join(" · "))
      : h("p", { class: "new-problem", role: "alert" }, terrain.problem), ...rows.filter((row) => row !== null));
  }

  private complain(sentence: string): void {
    this.create.disabled = true;
    const outside = /lies outside|reaches beyond/.test(sentence) ? " Draw it on the map, or use a terrain that covers it. Check the reference system of the file as well." : "";
    this.said.replaceChildren(h("div", { class: "card bad", role: "alert" }, h("b", {}, "Not ready to run"), h("p", {}, sentence + outside)));
  }
  private say(): void {
    const { terrain, files } = this.draft ?? { terrain: null, files: {} as Draft["files"] };
    const next = terrain === null ? "Start by choosing a terrain." : terrain.problem !== null ? "The terrain cannot be used as it is; the reason is given below its name." : "Next, the release: choose a file, or draw its outline on the map.";
    if (files.bundle === undefined) this.tell(next);
  }
  private get wanted(): { title: string; thickness_m: number | null; volume_m3: number | null; scar: [number, number][] | null } {
    const amount = this.amount.value === "" || this.amounts.hidden ? null : Number(this.amount.value);
    return { title: this.title.value.trim(), thickness_m: this.byVolume ? null : amount, volume_m3: this.byVolume ? amount : null, scar: this.map.scar };
  }
  /** Checks it as soon as nothing is changed for a moment. */
  private later(wait = check_ms): void {
    const draft = this.draft;
    this.create.disabled = true;
    window.clearTimeout(this.timer);
    ++this.asked;
    if (!draft) return;
    this.showAmounts(draft);
    const ready = draft.files.bundle !== undefined || (draft.terrain !== null && draft.terrain.problem === null && (draft.files.release !== undefined || this.map.scar !== null));
    if (!ready) return this.say();
    this.timer = window.setTimeout(() => void this.check(), wait);
  }
  private async check(): Promise<void> {
    if (this.busy > 0) return;
    const asked = ++this.asked;
    this.tell("Checking the scene…");
    try {
      const found = await this.api.makeOfDraft(this.id, { ...this.wanted, check: true });
      if (asked === this.asked) this.showChecked(found);
    } catch (error) {
      if (asked === this.asked) this.complain(error instanceof Error ? error.message : String(error));
    }
  }
  private showChecked(found: Checked): void {
    this.create.disabled = false;
    this.said.replaceChildren(h("div", { class: "card new-good" }, h("b", {}, "Ready to run"), h("pre", {}, found.summary),
      found.notes.length === 0 ? null : h("ul", {}, ...found.notes.map((note) => h("li", {}, note.startsWith("WARNING: ") ? h("b", {}, note) : note)))));
  }
  private async finish(): Promise<void> {
    this.create.disabled = true;
    try {
      const made = await this.api.makeOfDraft(this.id, this.wanted);
      if (made.created !== null) this.ondone(made.created, this.title.value.trim() || "the new scene");
    } catch (error) {
      this.complain(error instanceof Error ? error.message : String(error));
    }
  }
  private async discard(): Promise<void> {
    await this.api.discardDraft(this.id).catch(() => undefined);  // another one may have taken its place
    this.onclose();
  }
}
