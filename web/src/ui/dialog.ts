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

/** Asks for one of a few answers, the first of which is the usual one; null: none of them. */
export function askFor<T extends string>(title: string, sentences: readonly string[], answers: readonly (readonly [T, string])[]): Promise<T | null> {
  return new Promise((resolve) => {
    let chosen: T | null = null;
    const choices = answers.map(([value, text], i) => button(text, { class: i === 0 ? "primary" : "", autofocus: i === 0, onclick: () => {
      chosen = value;
      element.close();
    } }));
    const element = dialog(title, ...sentences.map((sentence) => h("p", { class: "hint" }, sentence)),
      h("div", { class: "row answers" }, ...choices, button("Cancel", { class: "quiet", onclick: () => element.close() })));
    element.addEventListener("close", () => resolve(chosen));
    openDialog(element);
  });
}

export function openDialog(element: HTMLDialogElement): HTMLDialogElement {
  document.body.append(element);
  element.showModal();
  return element;
}
