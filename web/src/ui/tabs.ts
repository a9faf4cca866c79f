// Tabs after the ARIA pattern: arrow keys move between them.
import { freshId, h } from "./dom";

export interface Tab { name: string; title: string; content: HTMLElement; onshow?(): void }
export interface Tabs { element: HTMLElement; panel: HTMLElement; show(name: string): void; shown(): string; /** Whether a tab can be chosen now. */ offer(name: string, on: boolean): void }

export function tabs(label: string, list: readonly Tab[]): Tabs {
  const panel = h("div", { class: "tab-panels" });
  const bar = h("div", { class: "tabs", role: "tablist", "aria-label": label });
  let current = "";
  const buttons = list.map((tab, i) => {
    const id = freshId("tab");
    const control = h("button", { type: "button", role: "tab", id, "data-tab": tab.name, onclick: () => show(tab.name),
      onkeydown: (event: KeyboardEvent) => {
        const move = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
        if (move === 0) return;
        let next = i;
        do next = (next + move + list.length) % list.length;
        while (buttons[next].hidden);
        show(list[next].name);
        buttons[next].focus();
      } }, tab.title);
    tab.content.setAttribute("role", "tabpanel");
    tab.content.setAttribute("aria-labelledby", id);
    tab.content.classList.add("tab-panel");
    bar.append(control);
    panel.append(tab.content);
    return control;
  });
  const show = (name: string): void => {
    current = name;
    list.forEach((tab, i) => {
      const on = tab.name === name;
      tab.content.hidden = !on;
      buttons[i].setAttribute("aria-selected", String(on));
      buttons[i].tabIndex = on ? 0 : -1;
      if (on) tab.onshow?.();
    });
  };
  if (list[0]) show(list[0].name);
  const offer = (name: string, on: boolean): void => {
    const index = list.findIndex((tab) => tab.name === name);
    buttons[index].hidden = !on;
    if (!on && current === name) show(list[0].name);
  };
  return { element: bar, panel, show, shown: () => current, offer };
}
