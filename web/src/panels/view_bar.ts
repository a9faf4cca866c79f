// Display options: camera, debris, layers.
import type { ShownLayer } from "../protocol/layers";
import { layerNames, type LayerName, type State } from "../protocol/messages";
import { ensembleLayer, ensembleTitle, infoOf, isEnsembleLayer, layerInfo } from "../scene/layers";
import type { CameraMode, Viewpoint } from "../scene/rig";
import type { Stage } from "../scene/stage";
import { watchAll } from "../state/cell";
import type { SurfaceColour, Twin } from "../state/twin";
import { button, h, type IconName } from "../ui/dom";
import { depthAveragedOptions, depthAveragedSwitch } from "./depth_averaged";
import { measureButton } from "./measuring";
import { momentOf, textOf } from "../scene/natural/sun";
import { swipeButton } from "./swipe";

const savedKey = "talus-views";

export interface ViewBar { camera: HTMLElement; show: HTMLElement; setMode(mode: CameraMode): void; recall(number: number): void }

export function viewBar(twin: Twin, stage: Stage): ViewBar {
  const modes: [CameraMode, string, IconName, string][] = [
    ["orbit", "Orbit", "orbit", "Orbit: drag to turn, right drag to move, wheel to zoom (1)"],
    ["fly", "Fly", "fly", "Fly: W A S D, Q and E to sink and rise, drag to look (2)"],
    ["follow", "Follow the front", "follow", "Follow the front of the debris (3)"],
    ["plan", "Top view", "top", "Top view: a plan of one scale, north up (T)"],
  ];
  const buttons = modes.map(([mode, label, icon, title]) =>
    button(label, { icon, bare: true, title, "data-mode": mode, onclick: () => setMode(mode) }));
  const setMode = (mode: CameraMode): void => {
    if (mode === "plan") stage.rig.top();
    else stage.rig.setMode(mode);
    if (mode === "fly") stage.canvas.focus();
  };

  const press = (mode: CameraMode): void => modes.forEach(([name], i) => buttons[i].setAttribute("aria-pressed", String(name === mode)));
  stage.rig.watchMode(press);

  const views = (): Viewpoint[] => JSON.parse(localStorage.getItem(savedKey + twin.scene.title) ?? "[]") as Viewpoint[];
  const saved = h("select", { "aria-label": "Saved views", class: "saved", onchange: () => {
    recall(Number(saved.value));
    saved.value = "";
  } });
  const listViews = (): void => {
    const count = views().length;
    saved.replaceChildren(h("option", { value: "" }, count === 0 ? "No views" : "Views"),
      ...views().map((_, i) => h("option", { value: i + 1 }, `View ${i + 1}`)));
    saved.disabled = count === 0;
    saved.title = count === 0 ? "Save a view first" : "Go to a saved view";
  };
  const recall = (number: number): void => {
    const view = views()[number - 1];
    if (view) {
      if (stage.rig.mode !== "plan") setMode("orbit");
      stage.rig.go(view, true);
    }
  };
  const save = button("Save this view", { icon: "save", bare: true, onclick: () => {
    localStorage.setItem(savedKey + twin.scene.title, JSON.stringify([...views(), stage.rig.viewpoint].slice(-9)));
    listViews();
    twin.notice(`Saved as view ${views().length}`, "done");
  } });
  listViews();

  const natural = h("input", { type: "checkbox", onchange: () => twin.setLook(natural.checked ? "natural" : "scientific") });
  const sun = h("input", { type: "datetime-local", class: "sun", "aria-label": "Date and solar time of the light", title: "Date and solar time of the light: the sun is highest at 12:00",
    onchange: () => {
      const moment = momentOf(sun.value);
      if (moment) twin.moment.value = moment;
    } });
  twin.moment.watch((moment) => (sun.value = textOf(moment)));
  const particles = h("input", { type: "checkbox", onchange: () => (twin.particles.value = particles.checked) });
  const surface = h("select", { "aria-label": "Debris as a surface", onchange: () => (twin.surface.value = surface.value as SurfaceColour) },
    h("option", { value: "off" }, "no surface"), h("option", { value: "depth" }, "surface by depth"), h("option", { value: "speed" }, "surface by speed"));
  const layer = h("select", { "aria-label": "Map layer on the ground", onchange: () => (twin.layer.value = layer.value as ShownLayer | "none") },
    h("option", { value: "none" }, "no layer"), ...layerNames.map((name) => h("option", { value: name, title: layerInfo[name].help }, layerInfo[name].title)), depthAveragedOptions(twin));
  // A selected layer remains in the list, also while there is nothing of it again.
  const offerWhere = (name: LayerName, has: (state: State) => boolean): void => {
    const option = layer.querySelector<HTMLOptionElement>(`option[value=${name}]`);
    const some = twin.shown.value.some((s) => { const state = twin.cells[s].state.value; return state !== null && has(state); });
    if (option) option.hidden = option.disabled = !some && twin.layer.value !== name;
  };
  watchAll([...twin.every("state"), twin.layer], () => {
    offerWhere("erosion_depth", (state) => state.volume_entrained_m3 > 0);
    offerWhere("pore_pressure_ratio", (state) => state.pore_pressure);
  });
  twin.ensembles.watch((list) => {
    layer.querySelectorAll("optgroup:not(.depth-averaged)").forEach((group) => group.remove());
    layer.append(...list.map((ensemble) => h("optgroup", { label: `Ensemble ${ensembleTitle(ensemble)}` }, ...ensemble.maps.map((map) => {
      const key = ensembleLayer(ensemble, map);
      return h("option", { value: key, title: infoOf(key, list).help }, map.title + (map.greatest === null ? " (nowhere)" : ""));
    }))));
  });
  const opacity = h("input", { type: "range", min: "0.1", max: "1", step: "0.05", "aria-label": "Opacity of the layer", title: "Opacity of the layer",
    oninput: () => (twin.layerOpacity.value = Number(opacity.value)) });
  const differenceName = h("span", {}, "");
  const difference = h("input", { type: "checkbox", onchange: () => (twin.difference.value = difference.checked) });
  const differenceLabel = h("label", { class: "check", title: "Difference of the layer between the two scenarios" }, difference, differenceName);
  const contours = h("input", { type: "checkbox", onchange: () => (twin.contours.value = contours.checked) });
  const photo = h("input", { type: "checkbox", onchange: () => (twin.photo.value = photo.checked) });
  const photoLabel = h("label", { class: "check", title: "The scene's orthophoto, draped over the terrain" }, photo, "Photo");
  photoLabel.hidden = !twin.scene.orthophoto;
  const particlesLabel = h("label", { class: "check" }, particles, "Particles");
  const contoursLabel = h("label", { class: "check" }, contours, "Contours");
  const names = h("input", { type: "checkbox", onchange: () => (twin.names.value = names.checked) });
  watchAll([twin.look, twin.particles, twin.surface, twin.layer, twin.layerOpacity, twin.difference, twin.shown, twin.contours, twin.names, twin.photo], () => {
    natural.checked = twin.natural;
    for (const label of [particlesLabel, contoursLabel]) label.hidden = twin.natural;
    sun.hidden = !twin.natural;
    photo.checked = twin.photo.value;
    particles.checked = twin.particles.value;
    surface.value = twin.surface.value;
    layer.value = twin.layer.value;
    layer.title = twin.layer.value === "none" ? "" : infoOf(twin.layer.value, twin.ensembles.value).help;
    opacity.value = String(twin.layerOpacity.value);
    opacity.hidden = twin.layer.value === "none";
    difference.checked = twin.difference.value;
    differenceName.textContent = twin.differenceName;
    differenceLabel.hidden = twin.shown.value.length < 2;
    difference.disabled = twin.layer.value === "none" || isEnsembleLayer(twin.layer.value);
    contours.checked = twin.contours.value;
    names.checked = twin.names.value;
  });

  const open = button("Display options", { icon: "layers", bare: true, class: "bare options-switch", title: "Particles, layers, names", "aria-expanded": "false", onclick: () =>
    open.setAttribute("aria-expanded", String(show.classList.toggle("open"))) });
  const camera = h("div", { class: "bar camera", role: "toolbar", "aria-label": "Camera" }, ...buttons,
    button("Fit", { icon: "fit", bare: true, title: "Whole scene (F)", onclick: () => stage.rig.fit() }), measureButton(twin), swipeButton(twin), save, saved, open);
  const show = h("div", { class: "bar show", role: "toolbar", "aria-label": "Display options" },
    h("label", { class: "check", title: "Debris and ground as they would look, or by colours of a legend (N)" }, natural, "Natural"), sun, particlesLabel, surface, layer, opacity, depthAveragedSwitch(twin), differenceLabel,
    photoLabel, contoursLabel, h("label", { class: "check" }, names, "Names"));
  return { camera, show, setMode, recall };
}
