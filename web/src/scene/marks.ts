// Marks of other people, probes, the lines of the section and of the measurement, and the user's own mark.
import type { Line2 } from "three/examples/jsm/lines/Line2.js";
import type { Place } from "../protocol/messages";
import { watchAll } from "../state/cell";
import { decimalsFor, fixed, quantity } from "../state/format";
import type { Twin } from "../state/twin";
import { h } from "../ui/dom";
import { inkOn } from "./colour";
import { infoOf } from "./layers";
import { disposeLine, pixelLine } from "./lines";
import type { ShownLayers } from "./shown_layers";
import type { Stage } from "./stage";

const markEvery_ms = 120;
const sectionColour = "#8a4a8f";
const measureColour = "#0a5fae";

export function marks(twin: Twin, stage: Stage, layers: ShownLayers): HTMLElement {
  const readOut = h("div", { class: "read-out", "aria-hidden": "true" });
  let sent_ms = 0;
  let timer: number | undefined;
  const lines: Line2[] = [];
  const people = new Map<string, HTMLElement>();

  const place = (): void => {
    // Marks of people follow the camera in every picture; there are only a few.
    for (const person of twin.people.value) {
      if (person.id === twin.you.value?.id) continue;
      const element = people.get(person.id);
      if (!element) continue;
      const at = person.mark ? stage.seenAt(person.mark, twin.shown.value[0]) : null;
      const box = stage.element.getBoundingClientRect();
      element.hidden = at === null || at.x < box.left || at.x > box.right || at.y < box.top || at.y > box.bottom;
      if (at) element.style.transform = `translate(${Math.round(at.x - box.left)}px, ${Math.round(at.y - box.top)}px)`;
    }
  };
  stage.onPicture(place);
  watchAll([twin.people, twin.you], () => {
    for (const [id, element] of people) {
      if (!twin.people.value.some((p) => p.id === id)) {
        element.remove();
        people.delete(id);
      }
    }
    for (const person of twin.people.value) {
      if (person.id === twin.you.value?.id) continue;
      let element = people.get(person.id);
      if (!element) {
        element = h("div", { class: "person-mark", hidden: true, "aria-hidden": "true" }, h("i", {}), h("span", {}));
        people.set(person.id, element);
        stage.element.append(element);
      }
      element.style.setProperty("--mark", person.colour);
      element.style.setProperty("--mark-ink", inkOn(person.colour));
      element.lastElementChild?.replaceChildren(person.name);
    }
    place();
  });

  watchAll([twin.probes, twin.section, twin.measured, twin.shown, stage.sinkings], () => {
    for (const line of lines.splice(0)) disposeLine(line);
    for (const view of stage.views.values()) {
      view.extraLabels = twin.probes.value.map((probe, i) => ({ at: view.relief.local(probe.at[0], probe.at[1], 0.2), text: String(i + 1), kind: "probe", colour: probe.colour, priority: 9 }));
      for (const [points, colour] of [[twin.section.value, sectionColour], [twin.measured.value, measureColour]] as const) {
        if (!points) continue;
        const line = pixelLine(view.relief.drape(points, 0.4), { colour, width_px: 2.5, onTop: true });
        lines.push(line);
        view.overlay.add(line);
      }
      stage.relabel(view);
    }
  });

  const { canvas } = stage;
  canvas.addEventListener("pointermove", (event) => {
    if (event.buttons !== 0) return;
    const now = performance.now();
    clearTimeout(timer);
    const tell = (): void => {
      sent_ms = performance.now();
      const hit = stage.hit(event.clientX, event.clientY);
      const local: Place | null = hit ? stage.reliefOf(hit.scenario).local(hit.world[0], hit.world[1]) : null;
      twin.mark(local);
      if (!hit) {
        readOut.textContent = "";
        return;
      }
      const name = twin.layer.value;
      const value = name === "none" ? null : layers.valueAt(hit.scenario, hit.world[0], hit.world[1]);
      const [west, south, east, north] = twin.scene.extent_m;
      const digits = decimalsFor(Math.max(east - west, north - south), 1);
      readOut.textContent = `E ${fixed(hit.world[0], digits)}  N ${fixed(hit.world[1], digits)}  ground ${fixed(hit.world[2], digits)} m` +
        (name !== "none" && value !== null ? `  ${infoOf(name, twin.ensembles.value).title.toLowerCase()}${layers.isDifference ? " B − A" : ""} ${quantity(value, infoOf(name, twin.ensembles.value).unit)}` : "");
    };
    if (now - sent_ms > markEvery_ms) tell();
    else timer = window.setTimeout(tell, markEvery_ms - (now - sent_ms));
  });
  canvas.addEventListener("pointerleave", () => {
    clearTimeout(timer);
    readOut.textContent = "";
    twin.mark(null);
  });
  return readOut;
}
