// Dialogs are the browser's own: they hold the focus, close on Escape, and are announced.
import { button, freshId, h, type Child } from "./dom";

export function dialog(title: string, ...children: Child[]): HTMLDialogElement {
  const id = freshId("dialog");
  const element = h("dialog", { "aria-labelledby": id },
    h("div", { class: "dialog-head" }, h("h2", { id }, title),
      button("Close", { icon: "close", bare: true, class: "bare quiet", onclick: () => element.close() })),
    ...children);
  element.addEventListener("click", (event) => {
    if (event.target === element) element.close();
  });
  element.addEventListener("close", () => element.remove());
  return element;
}

export function openDialog(element: HTMLDialogElement): HTMLDialogElement {
  document.body.append(element);
  element.showModal();
  return element;
}
