// Fields that hold typed text which is not sent yet: only that text is kept when the value changes elsewhere.

const isField = (target: EventTarget | null): target is HTMLInputElement =>
  target instanceof HTMLInputElement && (target.type === "number" || target.type === "text");

/** Keeps `isTyped` up to date, before any other listener is called. */
export function watchTyping(): void {
  const settle = (event: Event): void => {
    if (isField(event.target)) delete event.target.dataset["typed"];
  };
  document.addEventListener("input", (event) => {
    if (isField(event.target)) event.target.dataset["typed"] = "";
  }, true);
  document.addEventListener("change", settle, true);
  document.addEventListener("focusout", settle, true);
}
export const isTyped = (field: Element | null): boolean => field instanceof HTMLElement && field.dataset["typed"] !== undefined;

/** Replaces the text, whether or not the field has the focus. What is typed next then replaces all of it, as in a field just entered. */
export function put(field: HTMLInputElement, text: string): void {
  delete field.dataset["typed"];
  if (field.value === text) return;
  field.value = text;
  if (document.activeElement === field) field.select();
}
