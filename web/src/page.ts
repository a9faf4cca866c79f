// Puts the parts of the page together.
import { Stage } from "./scene/stage";
import { transport } from "./panels/transport";
import type { Twin } from "./state/twin";
import { h } from "./ui/dom";

export function buildPage(page: HTMLElement, twin: Twin): void {
  const stage = new Stage(twin, twin.relief);
  for (const name of ["A", "B"] as const) {
    twin.cells[name].setup.watch((setup) => {
      const view = stage.views.get(name);
      if (setup && view) {
        view.setSetup(setup);
        stage.relabel(view);
      }
    });
  }
  page.replaceChildren(
    h("header", { class: "topbar" }, h("span", { class: "wordmark" }, "talus"), h("h1", {}, twin.scene.title)),
    h("aside", { class: "levers" }),
    h("main", { class: "middle" }, stage.element),
    h("aside", { class: "readings" }),
    transport(twin),
  );
}
