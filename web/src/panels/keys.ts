// Keyboard shortcuts, and the page that lists them.
import type { Drawing } from "../scene/drawing";
import type { Stage } from "../scene/stage";
import { remove } from "../state/edits";
import { itemOf } from "../state/shapes";
import type { Twin } from "../state/twin";
import { dialog, openDialog } from "../ui/dialog";
import { h } from "../ui/dom";
import { toggleMeasuring } from "./measuring";
import { togglePinning } from "./pins";
import { toggle } from "./transport";
import { isTyped } from "../ui/typed";
import type { ViewBar } from "./view_bar";

const shortcuts: [string, [string, string][]][] = [
  ["Time", [["Space", "Run or pause (when no control has the focus)"], [".", "One step"], ["R", "Play or pause the recording"], ["L", "Return to live"]]],
  ["View (focus it with V)", [["Arrow keys", "Turn and tilt"], ["Shift + arrow keys", "Move"], ["+ and −", "Zoom"], ["1, 2, 3", "Orbit, fly, follow the front"],
    ["W A S D, Q E", "Fly"], ["T", "Top view"], ["F", "Whole scene"], ["N", "Natural look, or colours of a legend"], ["M", "Measure on the ground"], ["P", "Pin a note"], ["G", "Add a gauge"], ["O", "Add an observation"], ["Alt + 1 … 9", "Saved view"]]],
  ["Drawing", [["Space", "Point in the middle of the view"], ["Enter", "Finish"], ["Backspace", "Remove the last point"], ["Escape", "Cancel, or clear the selection"],
    ["X", "Barrier: across the flow path, nearest to the pointer"], ["Delete", "Remove the selection"], ["Arrow keys on a corner", "Move it by 1 m"]]],
  ["Everywhere", [["Ctrl + Z", "Undo; in a field with text that is not sent yet, undo typing"], ["Ctrl + Shift + Z", "Redo"], ["?", "This help"]]],
];

export function help(): void {
  openDialog(dialog("Help", h("p", { class: "hint" },
    "Run the simulation below. Controls on the left change it: draw a barrier across the path, raise the friction, trigger a release. A change to a run that has begun starts a new scenario from time 0, beside the first, or takes effect from the next step: the page asks the first time, and “Edits” below the list of scenarios holds the choice. Changes to beds, inflows and gauges take effect at the next restart. Readings are on the right. The bar at the bottom scrubs through the recording."),
  ...shortcuts.map(([title, keys]) => h("section", { class: "shortcuts" }, h("h3", {}, title),
    h("dl", {}, ...keys.flatMap(([key, what]) => [h("dt", {}, key), h("dd", {}, what)]))))));
}

export interface Timeline { live(): void; toggle(): void }

export function keys(twin: Twin, stage: Stage, drawing: Drawing, bar: ViewBar, timeline: Timeline): void {
  document.addEventListener("keydown", (event) => {
    if (document.querySelector("dialog[open]")) return;
    const target = event.target instanceof HTMLElement ? event.target : document.body;
    const typing = target.matches("input:not([type=checkbox]):not([type=range]), textarea, select");
    if ((event.ctrlKey || event.metaKey) && !event.altKey && event.key.toLowerCase() === "z" && !isTyped(target)) {
      event.preventDefault();
      if (twin.hindrance === null) void twin.act({ action: event.shiftKey ? "redo" : "undo" });
      return;
    }
    if (event.key === "Escape" && !typing) return drawing.cancel();
    if (typing || event.ctrlKey || event.metaKey) return;
    if (event.altKey) {
      if (/^Digit[1-9]$/.test(event.code)) bar.recall(Number(event.code.slice(5)));
      return;
    }
    const onControl = target.matches("button, summary, a, input");
    const flying = stage.rig.mode === "fly" && target === stage.canvas && /^Key[WASDQE]$/.test(event.code);
    if (flying || (onControl && (event.key === " " || event.key === "Enter"))) return;
    switch (event.key) {
      case " ":
        if (twin.hindrance === null) void toggle(twin);
        break;
      case ".":
        if (twin.hindrance === null) void twin.drive("step");
        break;
      case "r": timeline.toggle(); break;
      case "l": timeline.live(); break;
      case "v": stage.canvas.focus(); break;
      case "1": bar.setMode("orbit"); break;
      case "2": bar.setMode("fly"); break;
      case "3": bar.setMode("follow"); break;
      case "t": stage.rig.top(); break;
      case "f": stage.rig.fit(); break;
      case "n": twin.setLook(twin.natural ? "scientific" : "natural"); break;
      case "m": toggleMeasuring(twin); break;
      case "p": togglePinning(twin, "note"); break;
      case "g": togglePinning(twin, "gauge"); break;
      case "o": togglePinning(twin, "observation"); break;
      case "x": drawing.snap(); break;
      case "Enter":
        if (drawing.shape === null) return;
        drawing.finish();
        break;
      case "Backspace":
        if (drawing.shape === null) return;
        drawing.removeLast();
        break;
      case "?": help(); break;
      case "Delete": {
        const item = itemOf(twin.now.setup.value, twin.selection.value);
        if (item && twin.hindrance === null) void remove(twin, item);
        break;
      }
      default: return;
    }
    event.preventDefault();
  });
}
