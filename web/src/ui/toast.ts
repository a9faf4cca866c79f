// Short notices, read out by screen readers. Errors stay longer and can be dismissed.
import { button, h } from "./dom";

export class Toasts {
  readonly polite = h("div", { class: "toasts", role: "status", "aria-live": "polite" });
  readonly urgent = h("div", { class: "toasts urgent", role: "alert", "aria-live": "assertive" });
  /** The control used last: an error is shown next to it. */
  private anchor: Element | null = null;

  constructor() {
    const remember = (event: Event): void => {
      const control = event.target instanceof Element ? event.target.closest("button, input, select, [role=menuitem], canvas") : null;
      if (control && !this.urgent.contains(control)) this.anchor = control;
    };
    document.addEventListener("pointerdown", remember, true);
    document.addEventListener("keydown", remember, true);
  }
  show(sentence: string, kind: "error" | "done"): void {
    const toast = h("div", { class: `toast ${kind}` }, h("span", {}, sentence));
    if (kind === "error") {
      toast.append(button("Dismiss", { icon: "close", bare: true, class: "bare quiet", onclick: () => toast.remove() }));
      this.urgent.replaceChildren(toast);
      this.beside(toast);
      setTimeout(() => toast.remove(), 9000);
    } else {
      while (this.polite.childElementCount > 2) this.polite.firstElementChild?.remove();
      this.polite.append(toast);
      setTimeout(() => toast.remove(), 3500);
    }
  }
  private beside(toast: HTMLElement): void {
    const box = this.anchor?.isConnected ? this.anchor.getBoundingClientRect() : null;
    const [width, height] = [toast.offsetWidth, toast.offsetHeight];
    const plain = box === null || box.width === 0 || box.width > 500;
    const x = plain ? (innerWidth - width) / 2 : box.left + box.width / 2 - width / 2;
    const y = plain ? innerHeight - height - 76 : box.top > height + 60 ? box.top - height - 8 : box.bottom + 8;
    toast.style.left = `${Math.round(Math.min(Math.max(8, x), innerWidth - width - 8))}px`;
    toast.style.top = `${Math.round(Math.min(Math.max(52, y), innerHeight - height - 8))}px`;
  }
}
