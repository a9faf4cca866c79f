// The grip of a sheet at the lower edge of a phone: a tap or a swipe opens and closes it.
import { h } from "./dom";

const swipe_px = 24;

export function sheetHandle(name: string, onset: (open: boolean) => void): HTMLElement {
  let open = false;
  let from: number | null = null;
  let swiped = false;
  const set = (to: boolean): void => {
    open = to;
    handle.setAttribute("aria-expanded", String(open));
    onset(open);
  };
  const handle = h("button", { type: "button", class: "sheet-handle", "aria-label": name, "aria-expanded": "false", onclick: () => {
    if (!swiped) set(!open);
    swiped = false;
  } });
  handle.addEventListener("pointerdown", (event) => {
    from = event.clientY;
    swiped = false;
    handle.setPointerCapture(event.pointerId);
  });
  handle.addEventListener("pointerup", (event) => {
    const by = event.clientY - (from ?? event.clientY);
    from = null;
    if (Math.abs(by) < swipe_px) return;
    swiped = true;
    set(by < 0);
  });
  return handle;
}
