// Text at places of the scene, as HTML over the view. Of overlapping labels the more important one is kept.
import { Vector3 } from "three";
import { h } from "../ui/dom";
import type { Place } from "../protocol/messages";
import { inkOn } from "./colour";
import type { Relief } from "./relief";
import type { Rig } from "./rig";

export interface Label {
  /** Local place. */
  at: Place;
  text: string;
  kind: "chainage" | "observation" | "release" | "house" | "probe" | "person" | "barrier" | "zone" | "bed" | "inflow" | "gauge" | "section" | "note" | "overlay";
  colour?: string;
  priority: number;
  /** It hangs below its place instead of standing on it. */
  below?: boolean;
  /** Distance beyond which the label is hidden, m. */
  farthest?: number;
}

/** Below its place, so that a label above the same place leaves it room, px. */
const hangs_px = 4;

export type Box = readonly [number, number, number, number];
interface Shown extends Label { element: HTMLElement; width: number; height: number }

export class Labels {
  readonly layer = h("div", { class: "labels", "aria-hidden": "true" });
  private shown: Shown[] = [];
  /** Whether they are where they belong. */
  placed = false;

  constructor(public relief: Relief) {}

  set(labels: readonly Label[]): void {
    this.layer.replaceChildren();
    this.shown = [...labels].sort((a, b) => b.priority - a.priority).map((label) => {
      // Hidden until place() has been called: without a place of its own it would lie in the view's corner.
      const element = h("div", { class: `label off ${label.kind}` }, h("span", {}, label.text));
      if (label.colour) {
        element.style.setProperty("--mark", label.colour);
        element.style.setProperty("--mark-ink", inkOn(label.colour));
      }
      this.layer.append(element);
      return { ...label, element, width: 0, height: 0 };
    });
    for (const label of this.shown) {
      label.width = label.element.offsetWidth;
      label.height = label.element.offsetHeight;
    }
  }

  /** reserved: boxes (left, top, right, bottom) of the view that are covered by something else. */
  place(rig: Rig, width: number, height: number, reserved: readonly Box[]): void {
    this.placed = true;
    const taken: Box[] = [...reserved];
    const seen = new Vector3();
    const { camera } = rig;
    for (const label of this.shown) {
      seen.set(...label.at).project(camera);
      const x = ((seen.x + 1) / 2) * width;
      const y = ((1 - seen.y) / 2) * height;
      // The anchor of a label is the middle of its lower edge, unless it hangs below.
      const top = label.below ? y + hangs_px : y - label.height;
      const box: Box = [x - label.width / 2, top, x + label.width / 2, top + label.height];
      const visible =
        seen.z < 1 && box[0] > 2 && box[1] > 2 && box[2] < width - 2 && box[3] < height - 2 &&
        !taken.some((t) => box[0] < t[2] + 3 && box[2] > t[0] - 3 && box[1] < t[3] + 2 && box[3] > t[1] - 2) &&
        (label.farthest === undefined || rig.distanceTo(seen.set(...label.at)) < label.farthest) && (rig.mode === "plan" || !this.hidden(label.at, camera.position));
      label.element.classList.toggle("off", !visible);
      if (!visible) continue;
      taken.push(box);
      label.element.style.transform = `translate(${Math.round(box[0])}px, ${Math.round(box[1])}px)`;
    }
  }
  /** Whether the ground hides the place from the camera. */
  private hidden(at: Place, from: Vector3): boolean {
    const [ox, oy, oz] = this.relief.origin;
    const steps = 40;
    for (let k = 1; k < steps - 1; ++k) {
      const t = k / steps;
      const x = at[0] + (from.x - at[0]) * t;
      const y = at[1] + (from.y - at[1]) * t;
      const z = at[2] + (from.z - at[2]) * t;
      if (!this.relief.contains(x + ox, y + oy)) break;
      if (z + oz < this.relief.at(x + ox, y + oy) - 0.5) return true;
    }
    return false;
  }
}
