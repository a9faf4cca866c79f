// Assembles the parts of the page.
import { scenarioNames } from "./protocol/frame";
import "uplot/dist/uPlot.min.css";
import { Probes } from "./charts/probes";
import { sectionPanel } from "./charts/section";
import { frontCharts, timeCharts } from "./charts/series_charts";
import { alarmBanner, alarmsPanel, triggerBanner } from "./panels/alerts";
import { calibratePanel } from "./panels/calibrate";
import { ComparePanel } from "./panels/compare";
import { DepthAveragedPanel } from "./panels/depth_averaged";
import { exportButtons } from "./panels/exports";
import { impactColour, impactsPanel, largestPressure } from "./panels/impacts";
import { followButton } from "./panels/follow_button";
import { help, keys } from "./panels/keys";
import { legends, scaleAndCompass } from "./panels/legends";
import { measuring } from "./panels/measuring";
import { ObservedTable } from "./panels/observed";
import { controls } from "./panels/controls";
import { OverlaysPanel } from "./panels/overlays";
import { paneNames } from "./panels/pane_names";
import { people } from "./panels/people";
import { Picture } from "./panels/picture";
import { pinsPanel } from "./panels/pins";
import { balance, runCard } from "./panels/run_card";
import { changedOnTheWay } from "./panels/scenarios";
import { sessionButton } from "./panels/session";
import { swipeDivider } from "./panels/swipe";
import { tableList } from "./panels/tables";
import { transport } from "./panels/transport";
import { viewBar } from "./panels/view_bar";
import type { Api } from "./protocol/api";
import type { Grid } from "./protocol/grid";
import type { SceneInfo } from "./protocol/messages";
import type { StartPage } from "./protocol/start";
import { takeLinkedView } from "./protocol/token";
import type { Transport } from "./protocol/transport";
import { Drawing } from "./scene/drawing";
import { Follow } from "./scene/follow";
import { frontMarks } from "./scene/front_mark";
import { isDepthAveragedLayer, isEnsembleLayer } from "./scene/layers";
import { marks } from "./scene/marks";
import { OverlayLayers } from "./scene/overlays";
import { Relief } from "./scene/relief";
import { ShownLayers } from "./scene/shown_layers";
import { Sinking } from "./scene/sinking";
import { Trails } from "./scene/natural/trails";
import { Stage } from "./scene/stage";
import { watchAll } from "./state/cell";
import { takeFormer, whatIsGone, type FormerSession } from "./state/former_session";
import { Playback } from "./state/playback";
import { Refresher } from "./state/refresher";
import { Twin } from "./state/twin";
import { viewOf, viewText, type LinkedView } from "./state/view_link";
import { dialog, openDialog } from "./ui/dialog";
import { button, h } from "./ui/dom";
import { sheetHandle } from "./ui/sheet";
import { tabs } from "./ui/tabs";
import { watchTyping } from "./ui/typed";
import { Toasts } from "./ui/toast";

export function openPage(page: HTMLElement, transport: Transport, info: SceneInfo, terrain: Grid, api: Api, place: StartPage): void {
  const twin = new Twin(transport, info, new Relief(terrain, info.origin), api, place);
  buildPage(page, twin);
  for (const note of place.notes ?? []) twin.notice(note, "error");
  const former = takeFormer();
  if (former) tellFormer(former, place);
  twin.connection.watch(({ state }) => {
    if (state === "refused") openDialog(dialog("This link is no longer valid", h("p", { class: "hint" },
      "talus was restarted, and its links have changed: ask for the new one. The session on this page has ended; edits that were not saved are lost.")));
  });
  twin.live.start();
}

function tellFormer(former: FormerSession, place: StartPage): void {
  const saved = place.available && place.role === "controller"
    ? button("Saved sessions", { class: "primary", onclick: () => location.assign("#start") }) : null;
  openDialog(dialog("This is a new session", h("p", { class: "hint" }, whatIsGone(former)),
    saved ? null : h("p", { class: "hint" }, "Open a session that was saved as a file with: talus start FILE"),
    h("div", { class: "row answers" }, saved)));
}

function buildPage(page: HTMLElement, twin: Twin): void {
  watchTyping();
  const stage = new Stage(twin, twin.relief);
  const drawing = new Drawing(twin, stage);
  const layers = new ShownLayers(twin, stage);
  new Sinking(twin, stage);
  new Trails(twin, stage);
  const playback = new Playback(twin);
  const bar = viewBar(twin, stage);
  const picture = new Picture(twin, stage, layers);
  const toasts = new Toasts();
  twin.onNotice((sentence, kind) => toasts.show(sentence, kind));
  showSetups(twin, stage);
  paneNames(twin, stage, layers);
  const follow = new Follow(twin, stage);

  const probes = new Probes(twin);
  const overlays = new OverlaysPanel(twin, stage, new OverlayLayers(twin, stage), () => presentView(twin, stage));
  const observed = new ObservedTable(twin);
  const compare = new ComparePanel(twin, picture, observed);
  const secondModel = new DepthAveragedPanel(twin);
  const section = sectionPanel(twin, stage);
  const readings = tabs("Readings", [
    { name: "front", title: "Front", content: frontCharts(twin, observed.element, secondModel.element), onshow: () => void Promise.all([observed.refresh(), secondModel.refresh()]) },
    { name: "time", title: "Time", content: timeCharts(twin) },
    { name: "points", title: "Points", content: h("div", {}, pinsPanel(twin, stage), probes.element) },
    { name: "layers", title: "Layers", content: overlays.element },
    { name: "section", title: "Section", content: section.element },
    { name: "impact", title: "Impact", content: impactsPanel(twin, stage) },
    { name: "balance", title: "Balance", content: balance(twin) },
    { name: "compare", title: "Compare", content: compare.element, onshow: () => compare.open() },
    { name: "calibrate", title: "Calibrate", content: calibratePanel(twin) },
    { name: "alarms", title: "Alarms", content: h("div", {}, alarmsPanel(twin), tableList(twin, stage, "alarm"), tableList(twin, stage, "trigger")) },
  ]);
  twin.probes.watch((list) => {
    if (list.length > 0) readings.show("points");
  });
  twin.tileAddress.watch((address) => {
    if (address !== null) readings.show("layers");
  });
  watchAll([twin.shown], () => readings.offer("compare", twin.shown.value.length > 1));
  watchAll([twin.alerts, twin.you, ...twin.every("setup")], () => {
    const alerts = twin.alerts.value;
    const raised = alerts !== null && alerts.triggers.length + alerts.alarms.length + alerts.notes.length > 0;
    // Who may add one needs the tab before there is any.
    readings.offer("alarms", raised || twin.you.value?.role === "controller" || twin.shown.value.some((name) => (twin.cells[name].setup.value?.alarms.length ?? 0) > 0));
  });
  readings.offer("calibrate", twin.can.server);
  let alarms = 0;
  twin.alerts.watch((alerts) => {
    const raised = alerts?.alarms.length ?? 0;
    if (raised > alarms) readings.show("alarms");
    alarms = raised;
  });
  twin.section.watch((line) => {
    if (line) readings.show("section");
  });
  new Refresher(twin, () => {
    if (readings.shown() === "front") void observed.refresh();
    if (readings.shown() === "front") void secondModel.refresh();
    if (readings.shown() === "points") void probes.refresh();
    if (readings.shown() === "section") section.refresh();
    if (readings.shown() === "compare") void compare.refresh();
  });
  const readOut = marks(twin, stage, layers);
  keys(twin, stage, drawing, bar, playback);
  // What a viewer cannot do takes no room on a phone.
  twin.you.watch((you) => page.classList.toggle("viewer", you?.role === "viewer"));

  const setup = button("Setup", { icon: "menu", bare: true, class: "bare setup-switch", title: "Scenarios and their values", "aria-expanded": "false", onclick: () =>
    setup.setAttribute("aria-expanded", String(page.classList.toggle("setup-open"))) });
  const handle = sheetHandle("Charts and tables", (open) => page.classList.toggle("sheet-open", open));
  const drawer = button("Readings", { icon: "panel", bare: true, class: "bare drawer-switch", title: "Show or hide the readings", onclick: () => {
    // On a narrow page the readings overlay the view on demand; on a wide one hiding them enlarges the view.
    const open = page.classList.toggle(narrow.matches ? "readings-open" : "readings-closed") === narrow.matches;
    drawer.setAttribute("aria-expanded", String(open));
  } });
  const narrow = matchMedia("(max-width: 1000px)");
  const expanded = (): void => drawer.setAttribute("aria-expanded", String(page.classList.contains("readings-open") || (!narrow.matches && !page.classList.contains("readings-closed"))));
  narrow.addEventListener("change", expanded);
  expanded();
  // In the bar where there is room for it, otherwise over the view: a picture of invented ground never stands alone.
  const badge = (where: string): HTMLElement | null => (twin.scene.reconstruction ? h("span", { class: `badge ${where}`, title: twin.scene.assumptions.join(" ") }, "Reconstruction, no survey") : null);
  const wordmark = twin.place.available && twin.place.role === "controller" ? h("button", { type: "button", class: "wordmark", title: "Start page: other scenes and saved sessions", onclick: () => (location.hash = "start") }, "talus")
    : h("span", { class: "wordmark" }, "talus");
  const key = legends(twin, stage, layers);
  const scale = scaleAndCompass(twin, stage, readOut);
  const foot = h("div", { class: "view-foot" }, overlays.card, measuring(twin, stage, drawing), followButton(twin, stage, follow), badge("over"));
  stage.covers = [bar.camera, bar.show, scale, foot, ...frontMarks(twin, stage, follow)];
  // Legends stand below the picture: over it they would hide debris and houses.
  const middle = h("main", { class: "middle" }, triggerBanner(twin), h("div", { class: "view" }, stage.element, bar.camera, bar.show, swipeDivider(twin, stage), scale, foot), key);
  // Names of the two views stand below the bars, which wrap on a narrow page, and so does the ground in a plan. On a phone only the camera's is there.
  const bars = new ResizeObserver(() => {
    const below = bar.show.offsetHeight > 0 ? bar.show.offsetTop + bar.show.offsetHeight : bar.camera.offsetTop + bar.camera.offsetHeight;
    middle.style.setProperty("--bars", `${bar.show.offsetTop + bar.show.offsetHeight}px`);
    stage.rig.covered = Math.min(0.4, below / Math.max(1, stage.element.clientHeight));
    follow.refresh();
  });
  for (const element of [bar.show, stage.element]) bars.observe(element);
  page.replaceChildren(
    h("header", { class: "topbar" }, setup, wordmark, h("h1", {}, twin.scene.title), badge("aside"), h("span", { class: "spring" }),
      twin.can.server ? people(twin, () => presentView(twin, stage)) : null, twin.can.server ? sessionButton(twin) : null, ...exportButtons(twin, stage, picture), button("Help", { icon: "help", bare: true, class: "bare help", title: "Help and shortcuts (?)", onclick: help }), drawer),
    alarmBanner(twin),
    controls(twin, drawing),
    middle,
    h("aside", { class: "readings", "aria-label": "Readings" }, handle, runCard(twin), changedOnTheWay(twin), readings.element, readings.panel),
    transport(twin, playback),
    toasts.polite, toasts.urgent,
  );
  if (!twin.can.change) playOnce(twin, playback);
  const linked = viewOf(takeLinkedView() ?? "");
  if (linked) openView(twin, stage, linked);
}

/** A recording is at its end until somebody plays it: it begins by itself, unless the reader wants no motion. */
function playOnce(twin: Twin, playback: Playback): void {
  const end = watchAll(twin.every("state"), () => {
    if (twin.now.state.value === null) return;
    queueMicrotask(() => end());
    playback.seek(0);
    if (!matchMedia("(prefers-reduced-motion: reduce)").matches) playback.toggle();
  });
}

function presentView(twin: Twin, stage: Stage): string {
  const layer = twin.layer.value;
  return viewText({ camera: stage.rig.viewpoint, layer: layer === "none" || isEnsembleLayer(layer) || isDepthAveragedLayer(layer) ? "none" : layer,
    shown: twin.shown.value, divider: twin.shown.value.length > 1 ? twin.divider.value : null });
}
/** What a link asked for: the camera at once, scenarios as soon as they are known. */
function openView(twin: Twin, stage: Stage, view: LinkedView): void {
  stage.beginAt(view.camera);
  twin.layer.value = view.layer;
  let shown = false;
  watchAll([twin.you, twin.scenarios], () => {
    if (shown || twin.you.value === null || !view.shown.every((name) => twin.scenarios.value.includes(name))) return;
    shown = true;
    twin.show(view.shown, view.shown[0]);
    twin.divider.value = view.divider;
  });
}

/** Setups and impacts go to the views. */
function showSetups(twin: Twin, stage: Stage): void {
  for (const name of scenarioNames) {
    const put = (): void => {
      const setup = twin.cells[name].setup.value;
      const view = stage.views.get(name);
      if (!setup || !view) return;
      view.setSetup(setup);
      stage.relabel(view);
    };
    watchAll([twin.cells[name].setup, twin.shown], put);
    watchAll([twin.cells[name].setup, twin.cells[name].impacts, twin.selection, twin.houseColour, twin.shown], () => {
      const impacts = twin.cells[name].impacts.value;
      const most = largestPressure(impacts);
      stage.views.get(name)?.colourSolids(impacts, (id) => impactColour(impacts?.buildings.find((b) => b.id === id), twin.houseColour.value, twin.scene, most),
        twin.selection.value?.id ?? null);
      stage.invalidate();
    });
  }
  watchAll([twin.names, twin.shown, twin.selection], () => {
    for (const view of stage.views.values()) {
      view.namesShown = twin.names.value;
      view.selected = twin.hindrance === null ? (twin.selection.value?.id ?? null) : null;
      stage.relabel(view);
    }
  });
}
