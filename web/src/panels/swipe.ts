// Two scenarios in one picture, with a divider between them that is moved over it.
import type { Stage } from "../scene/stage";
import { watchAll } from "../state/cell";
import type { Twin } from "../state/twin";
import { button, h } from "../ui/dom";

/** As far as the divider goes, so that it can be reached again. */
const least = 0.02;
const step = 0.02;

export function swipeButton(twin: Twin): HTMLElement {
  const swipe = button("Swipe", { icon: "compare", bare: true, title: "Both scenarios in one picture, with a divider to move",
    onclick: () => (twin.divider.value = twin.divider.value === null ? 0.5 : null) });
  watchAll([twin.shown, twin.divider], () => {
    swipe.hidden = twin.shown.value.length < 2;
    swipe.setAttribute("aria-pressed", String(twin.divider.value !== null));
  });
  return swipe;
}

export function swipeDivider(twin: Twin, stage: Stage): HTMLElement {
  const put = (share: number): void => {
    twin.divider.value = Math.min(1 - least, Math.max(least, share));
  };
  const divider = h("div", { class: "divider", role: "slider", tabindex: "0", "aria-label": "Divider between the scenarios", "aria-valuemin": "0", "aria-valuemax": "100", hidden: true,
    onpointerdown: (event: PointerEvent) => divider.setPointerCapture(event.pointerId),
    onpointermove: (event: PointerEvent) => {
      const box = stage.element.getBoundingClientRect();
      if (divider.hasPointerCapture(event.pointerId)) put((event.clientX - box.left) / box.width);
    },
    onkeydown: (event: KeyboardEvent) => {
      const by = { ArrowLeft: -step, ArrowRight: step, Home: -1, End: 1 }[event.key];
      if (by === undefined || twin.divider.value === null) return;
      put(twin.divider.value + by);
      event.preventDefault();
    } });
  watchAll([twin.shown, twin.divider], () => {
    divider.hidden = stage.divider === null;
    divider.setAttribute("aria-valuenow", String(Math.round(100 * (twin.divider.value ?? 0.5))));
    divider.setAttribute("aria-valuetext", `${twin.shown.value[0]} on the left ${Math.round(100 * (twin.divider.value ?? 0.5))} %`);
    divider.style.setProperty("--divider", `${100 * (twin.divider.value ?? 0.5)}%`);
  });
  return divider;
}
