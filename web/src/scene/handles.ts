// Corners that can be dragged, or moved with the arrow keys: buttons over the view.
import type { ScenarioName } from "../protocol/frame";
import type { Point } from "../protocol/messages";
import { middle } from "../state/shapes";
import { h } from "../ui/dom";
import type { Stage } from "./stage";

export interface HandleEvents {
  /** The points while a corner is dragged, or an arrow key is down. */
  move(points: Point[]): void;
  /** The points when the corner or the key was released, and the displacement of the first one; null: not moved. */
  drop(points: Point[], moved_m: Point | null): void;
}

const nudge_m = 1;

export class Handles {
  private buttons: HTMLButtonElement[] = [];
  private points: Point[] = [];
  private scenario: ScenarioName = "A";
  private first = 0; // the corner that the first button moves
  /** The points at the start of the current drag or key press: until it ends, updates from the server are not shown. */
  private before: Point[] | null = null;

  constructor(private readonly stage: Stage) {
    stage.onPicture(() => this.place());
  }
  get busy(): boolean {
    return this.before !== null;
  }

  /** Shows corners, one handle in the middle that moves the whole, or both. Clicks pass through the handle of `passive`, a corner. */
  show(name: string, points: readonly Point[], scenario: ScenarioName, grips: "corners" | "whole" | "all", events: HandleEvents, passive: number | null = null): void {
    if (this.busy) return;
    const focused = this.buttons.indexOf(document.activeElement as HTMLButtonElement);
    this.clear();
    this.points = points.map(([x, y]) => [x, y]);
    this.scenario = scenario;
    const pane = this.stage.pane(scenario);
    this.first = grips === "whole" ? points.length : 0;
    const end = points.length + (grips === "corners" ? 0 : 1);
    for (let k = this.first; k < end; ++k) {
      const isWhole = k === points.length;
      const button = h("button", { type: "button", class: isWhole ? "handle whole" : k === passive ? "handle passive" : "handle",
        "aria-label": `${isWhole ? "Whole of" : `Corner ${k + 1} of`} ${name}; arrow keys move it by ${nudge_m} m`,
        title: isWhole ? "Drag to move the whole shape" : "Drag to move this corner" });
      button.addEventListener("pointerdown", (event) => this.drag(event, button, k, events));
      button.addEventListener("keydown", (event) => {
        const step: Record<string, Point> = { ArrowUp: [0, nudge_m], ArrowDown: [0, -nudge_m], ArrowLeft: [-nudge_m, 0], ArrowRight: [nudge_m, 0] };
        const by = step[event.key];
        if (!by) return;
        event.preventDefault();
        event.stopPropagation();
        this.before ??= this.points;
        this.shift(k, by);
        events.move(this.points);
        this.place();
      });
      button.addEventListener("keyup", (event) => {
        if (event.key.startsWith("Arrow")) this.end(events);
      });
      button.addEventListener("blur", () => this.end(events));
      this.buttons.push(button);
      pane?.append(button);
    }
    if (focused >= 0) this.buttons[focused]?.focus();
    this.place();
    this.stage.invalidate();
  }
  clear(): void {
    for (const button of this.buttons) button.remove();
    this.buttons = [];
  }

  private end(events: HandleEvents): void {
    const { before, points } = this;
    if (before === null) return;
    this.before = null;
    const moved = points.some((point, i) => point[0] !== before[i][0] || point[1] !== before[i][1]);
    events.drop(points, moved ? [points[0][0] - before[0][0], points[0][1] - before[0][1]] : null);
  }
  private shift(k: number, by: Point): void {
    const all = k === this.points.length;
    this.points = this.points.map(([x, y], i) => (all || i === k ? [x + by[0], y + by[1]] : [x, y]));
  }
  private drag(event: PointerEvent, button: HTMLButtonElement, k: number, events: HandleEvents): void {
    if (event.button !== 0) return;
    event.preventDefault();
    button.focus();
    button.setPointerCapture(event.pointerId);
    this.before = this.points;
    const all = k === this.points.length;
    const move = (moved: PointerEvent): void => {
      if (!this.busy) return; // ended by a key or by losing the focus
      const hit = this.stage.hit(moved.clientX, moved.clientY);
      if (!hit || hit.scenario !== this.scenario) return;
      const from = all ? middle(this.points) : this.points[k];
      this.shift(k, [hit.world[0] - from[0], hit.world[1] - from[1]]);
      events.move(this.points);
      this.place();
    };
    const end = (): void => {
      button.removeEventListener("pointermove", move);
      this.end(events);
    };
    button.addEventListener("pointermove", move);
    button.addEventListener("pointerup", end, { once: true });
    button.addEventListener("pointercancel", end, { once: true });
  }
  private place(): void {
    if (this.buttons.length === 0) return;
    const pane = this.stage.pane(this.scenario)?.getBoundingClientRect();
    if (!pane) return;
    this.buttons.forEach((button, i) => {
      const k = this.first + i;
      const [x, y] = k === this.points.length ? middle(this.points) : this.points[k];
      const at = this.stage.seenAt(this.stage.reliefOf(this.scenario).local(x, y, 0.3), this.scenario);
      // A hidden button gets no keys: the focused one stays, so that a corner moved out of the view by arrow keys can
      // be moved back.
      button.hidden = button !== document.activeElement && (at === null || at.x < pane.left || at.x > pane.right || at.y < pane.top || at.y > pane.bottom);
      if (at) button.style.transform = `translate(${at.x - pane.left}px, ${at.y - pane.top}px) translate(-50%, -50%)`;
    });
  }
}
