// A mark that goes with the front: the eye finds the head of a flow that is a few pixels wide in the picture of a valley.
import { Vector3 } from "three";
import { scenarioNames, type ScenarioName } from "../protocol/frame";
import type { Place } from "../protocol/messages";
import { watchAll } from "../state/cell";
import { quantity } from "../state/format";
import type { Twin } from "../state/twin";
import { h } from "../ui/dom";
import type { Follow } from "./follow";
import type { Stage } from "./stage";

/** Slower, it has come to a stop for the eye, m/s. */
const slowest_mps = 0.1;
/** Labels make room for it no more often, ms, and when it has moved so far, px. */
const room = { every_ms: 300, from_px: 6 };
/** Nearer, it is there. */
const near_m = 0.05;

class FrontMark {
  readonly element: HTMLElement;
  private readonly text = h("span", {});
  private readonly at = new Vector3();
  private readonly seen = new Vector3();
  private to: Place | null = null;
  private last_ms = 0;
  private arrived = false;
  private readonly cleared = { x: NaN, y: NaN, at_ms: 0 };

  constructor(private readonly name: ScenarioName, private readonly twin: Twin, private readonly stage: Stage, private readonly follow: Follow) {
    this.element = h("div", { class: "front-mark", "aria-hidden": "true" }, this.text);
    this.element.hidden = true;
  }
  /** What the server has told. */
  tell(): void {
    const { twin, name } = this;
    const speed = twin.shownState(name)?.front_velocity_mps ?? 0;
    const before = this.to;
    this.to = twin.names.value && twin.shown.value.includes(name) && speed > slowest_mps ? this.follow.front(name) : null;
    if (this.to && !before) {
      this.at.set(...this.to);
      this.arrived = false;
    }
    if (this.to) this.text.textContent = `Front ${quantity(speed, "m/s")}`;
    if (this.element.hidden === (this.to === null)) return;
    this.element.hidden = this.to === null;
    const view = this.stage.views.get(name);
    if (view) view.labels.placed = false;
    this.stage.invalidate();
  }
  /** Where it is in this picture. It is told of five times a second, and moves on between. */
  place(now_ms: number): void {
    const { stage, to, seen } = this;
    const pane = stage.pane(this.name);
    if (!to || !pane) return;
    if (this.element.parentElement !== pane) pane.append(this.element);
    const share = 1 - Math.exp(-Math.min(1, (now_ms - this.last_ms) / 1000) * 6);
    this.last_ms = now_ms;
    const dx = to[0] - this.at.x;
    const dy = to[1] - this.at.y;
    const dz = to[2] - this.at.z;
    const there = Math.hypot(dx, dy, dz) < near_m;
    if (there) this.at.set(...to);
    else {
      this.at.set(this.at.x + share * dx, this.at.y + share * dy, this.at.z + share * dz);
      stage.invalidate();  // it goes on to where it belongs, also when nothing else moves
    }
    seen.copy(this.at).project(stage.rig.camera);
    const x = ((seen.x + 1) / 2) * pane.clientWidth;
    const y = ((1 - seen.y) / 2) * pane.clientHeight;
    this.element.classList.toggle("off", seen.z > 1);
    this.element.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
    // At its end labels stand as they do wherever it came from.
    const arrived = there && !this.arrived;
    this.arrived = there;
    if (!arrived && Math.hypot(x - this.cleared.x, y - this.cleared.y) < room.from_px) return;
    if (!arrived && now_ms < this.cleared.at_ms + room.every_ms) {
      stage.invalidate();  // names make room a little later, also when nothing else moves
      return;
    }
    this.cleared.x = x;
    this.cleared.y = y;
    this.cleared.at_ms = now_ms;
    const view = stage.views.get(this.name);
    if (!view) return;
    view.labels.placed = false;
    stage.invalidate();
  }
}

/** Marks of all scenarios; labels keep clear of them. */
export function frontMarks(twin: Twin, stage: Stage, follow: Follow): HTMLElement[] {
  const marks = scenarioNames.map((name) => new FrontMark(name, twin, stage, follow));
  watchAll([twin.names, twin.shown, twin.replay_s, ...twin.every("state"), ...twin.every("series")], () => {
    for (const mark of marks) mark.tell();
  });
  stage.onPicture(() => {
    const now = performance.now();
    for (const mark of marks) mark.place(now);
  });
  return marks.map(({ element }) => element);
}
