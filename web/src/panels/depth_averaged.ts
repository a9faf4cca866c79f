// The depth-averaged model beside the particles: its switch, its maps in the list of layers, and figures of both.
import type { ShownLayer } from "../protocol/layers";
import { quantityNames, type DepthAveragedComparison } from "../protocol/messages";
import { depthAveragedLayer, infoOf, isDepthAveragedLayer, isEnsembleLayer, layerInfo, quantityOf } from "../scene/layers";
import { watchAll } from "../state/cell";
import { agreementText, comparedTable, isOn, statusText } from "../state/depth_averaged";
import { unitText } from "../state/format";
import type { Twin } from "../state/twin";
import { h } from "../ui/dom";

const anyOn = (twin: Twin): boolean => twin.every("depthAveraged").some((cell) => isOn(cell.value));

/** Switches the model for everybody: a tick box for the person in control, that also shows its map of what is shown of the particles. */
export function depthAveragedSwitch(twin: Twin): HTMLElement {
  let former: ShownLayer | "none" = "none";
  // The server answers first and tells everybody later, after its present step: only then is there a map to show.
  let awaited = false;
  const box = h("input", { type: "checkbox", onchange: () => {
    const on = (awaited = box.checked);
    void twin.attempt(() => twin.api.turnDepthAveraged(on)).then((fine) => {
      if (fine) return;
      awaited = false;
      box.checked = anyOn(twin);
    });
  } });
  const showMap = (): void => {
    former = twin.layer.value;
    const shown = former === "none" || isEnsembleLayer(former) || isDepthAveragedLayer(former) ? "peak_depth" : former;
    twin.layer.value = depthAveragedLayer(shown) ?? "depth_averaged/peak_depth";
  };
  const state = h("span", { class: "muted" });
  const label = h("label", { class: "check depth-averaged-switch" }, box, "Depth-averaged model", state);
  watchAll([twin.you, twin.controller, twin.connection, twin.shown, twin.layer, ...twin.every("depthAveraged")], () => {
    const on = anyOn(twin);
    box.checked = on || awaited;
    if (on && awaited) {
      awaited = false;
      showMap();
    }
    box.disabled = twin.hindrance !== null;
    label.title = twin.hindrance ?? "A second model of the same setup, from time 0, computed again after every change: its maps, its front, and its figures beside those of the particles";
    const going = twin.shown.value.map((s) => twin.cells[s].depthAveraged.value).find((s) => s?.state === "running" || s?.state === "waiting");
    state.textContent = going ? ` ${going.state === "running" ? `${Math.round(100 * (going.share ?? 0))} %` : "waits"}` : "";
    if (!on && isDepthAveragedLayer(twin.layer.value)) twin.layer.value = isDepthAveragedLayer(former) ? "none" : former;
  });
  return label;
}

/** Its maps, for the list of layers; there while the model is on. */
export function depthAveragedOptions(twin: Twin): HTMLElement {
  const group = h("optgroup", { label: "Depth-averaged model", class: "depth-averaged" }, ...quantityNames.map((quantity) => {
    const name = depthAveragedLayer(quantity) ?? "depth_averaged/peak_depth";
    return h("option", { value: name, title: infoOf(name, []).help }, `${layerInfo[quantityOf(name)].title}, depth-averaged`);
  }));
  watchAll(twin.every("depthAveraged"), () => (group.hidden = group.disabled = !anyOn(twin)));
  return group;
}

export class DepthAveragedPanel {
  readonly element: HTMLElement;
  private readonly table = h("table", { class: "plain comparison both-models" });
  private readonly agreement = h("p", { class: "agreement" });
  private readonly notes = h("ul", { class: "hint" });
  private compared: DepthAveragedComparison | null = null;
  private hash: string | null = null;
  private busy = false;

  constructor(private readonly twin: Twin) {
    const title = h("h3", {});
    const status = h("p", { class: "hint", role: "status" });
    this.element = h("section", { class: "depth-averaged-figures", "aria-label": "Depth-averaged model" }, title, status, this.table, this.agreement, this.notes);
    watchAll([twin.edited, twin.shown, ...twin.every("depthAveraged")], () => {
      const now = twin.now.depthAveraged.value;
      this.element.hidden = !isOn(now);
      title.textContent = `Depth-averaged model${twin.shown.value.length > 1 ? `, ${twin.edited.value}` : ""}`;
      status.textContent = statusText(now);
      const hash = now?.result ? `${twin.edited.value} ${now.result.hash}` : null;
      if (hash === this.hash) return;
      this.hash = hash;
      this.compared = null;
      this.draw();
      void this.refresh();
    });
  }
  /** Fetches the figures, which go on with the particles. */
  async refresh(): Promise<void> {
    const { twin, hash } = this;
    if (this.busy || hash === null || twin.connection.value.state !== "open") return;
    this.busy = true;
    try {
      const compared = await twin.api.depthAveragedComparison(twin.edited.value);
      if (this.hash === hash) this.compared = compared;
      this.draw();
    } catch (error) {
      console.info(error);  // the setup has just changed; the next result is compared
    }
    this.busy = false;
    if (this.hash !== null && this.hash !== hash) void this.refresh();
  }
  private draw(): void {
    const { compared } = this;
    this.table.hidden = this.agreement.hidden = this.notes.hidden = compared === null;
    if (!compared) return;
    const { heads, rows } = comparedTable(compared);
    this.table.replaceChildren(h("thead", {}, h("tr", {}, h("th", {}), ...heads.map((text) => h("th", { scope: "col" }, text)))),
      h("tbody", {}, ...rows.map((row) => h("tr", {}, h("th", { scope: "row" }, row.name, h("small", {}, ` ${unitText(row.unit)}`)), ...row.values.map((text) => h("td", {}, text))))));
    this.agreement.textContent = agreementText(compared);
    this.notes.replaceChildren(...[...compared.differs, ...(this.twin.now.depthAveraged.value?.result?.notes ?? [])].map((text) => h("li", {}, text)));
  }
}
