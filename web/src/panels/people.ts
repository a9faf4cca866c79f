// People in the session, control, links to share.
import type { Person } from "../protocol/messages";
import { linkWith } from "../protocol/token";
import { inkOn } from "../scene/colour";
import { watchAll } from "../state/cell";
import type { Twin } from "../state/twin";
import { dialog, openDialog } from "../ui/dialog";
import { button, h } from "../ui/dom";
import { shareBeyond } from "./share_beyond";

const initials = (name: string): string => name.split(/\s+/).map((w) => w[0] ?? "").join("").slice(0, 2).toUpperCase() || "?";

function chip(person: Person, twin: Twin): HTMLElement {
  const holds = twin.controller.value === person.id;
  const self = twin.you.value?.id === person.id;
  const element = h("span", { class: `person${holds ? " holds" : ""}`, title: `${person.name}${self ? " (you)" : ""}: ${holds ? "has control" : person.role === "viewer" ? "viewer" : "can ask for control"}` }, initials(person.name));
  element.style.background = person.colour;
  element.style.color = inkOn(person.colour);
  return element;
}

/** view: the present one, for a link. */
export function people(twin: Twin, view: () => string): HTMLElement {
  const chips = h("button", { type: "button", class: "chips quiet", onclick: () => share(twin, view()) });
  const control = button("Take control", { class: "control", onclick: () => void ask() });
  const connection = h("div", { class: "connection", role: "status" });
  const request = h("div", { class: "request", role: "alertdialog", "aria-label": "Request for control" });
  const ask = async (): Promise<void> => {
    const mine = twin.controller.value === twin.you.value?.id;
    const alone = twin.controller.value === null;
    if (await twin.attempt(() => twin.api.control(mine ? "release" : "request"))) {
      if (!mine && !alone) twin.notice("Asked for control; without an answer you get it in 10 s.", "done");
    }
  };
  watchAll([twin.people, twin.controller, twin.request, twin.you, twin.connection], () => {
    const you = twin.you.value;
    const list = twin.people.value;
    chips.replaceChildren(...list.slice(0, 6).map((p) => chip(p, twin)), ...(list.length > 6 ? [h("span", { class: "more" }, `+${list.length - 6}`)] : []));
    chips.setAttribute("aria-label", `${list.length} ${list.length === 1 ? "person" : "people"} here; open sharing`);
    control.hidden = you === null || you.role === "viewer";
    const mine = you !== null && twin.controller.value === you.id;
    const waiting = twin.request.value?.id === you?.id;
    control.replaceChildren(h("span", {}, mine ? "You have control" : waiting ? "Asked for control …" : twin.controller.value === null ? "Take control" : "Ask for control"));
    control.title = mine ? "Release control" : "";
    control.classList.toggle("on", mine);
    control.disabled = waiting;
    const { state, retryIn_s } = twin.connection.value;
    connection.hidden = state === "open";
    const sentence = state === "refused" ? "This link is no longer valid." : state === "lost" ? (retryIn_s > 0 ? `Connection lost. Reconnecting in ${retryIn_s} s.` : "Reconnecting …") : "Connecting …";
    if (connection.textContent !== sentence) connection.replaceChildren(h("span", {}, sentence));
    const asked = mine ? twin.request.value : null;
    if (!asked) request.replaceChildren();
    else if (request.dataset["who"] !== asked.id || request.childElementCount === 0) {
      request.replaceChildren(h("span", {}, `${asked.name} asks for control.`),
        button("Grant", { class: "primary small", onclick: () => void twin.attempt(() => twin.api.control("grant")) }),
        button("Decline", { class: "small", onclick: () => void twin.attempt(() => twin.api.control("decline")) }));
    }
    request.dataset["who"] = asked?.id ?? "";
    request.hidden = !asked;
  });
  return h("div", { class: "people" }, connection, request, control, chips,
    button("Share", { icon: "share", "aria-label": "Share", title: "Share this session", onclick: () => share(twin, view()) }));
}

function share(twin: Twin, view: string): void {
  const name = h("input", { type: "text", maxlength: 40, value: twin.you.value?.name ?? "", "aria-label": "Your name", onchange: () => {
    if (name.value.trim() !== "") twin.rename(name.value.trim());
  } });
  const list = h("ul", { class: "people-list" });
  const end = watchAll([twin.people, twin.controller, twin.you], () => {
    list.replaceChildren(...twin.people.value.map((p) => h("li", {}, chip(p, twin), h("span", { class: "grow" }, p.name, p.id === twin.you.value?.id ? " (you)" : ""),
      h("span", { class: "muted" }, twin.controller.value === p.id ? "has control" : p.role === "viewer" ? "viewer" : "may ask for control"))));
  });
  const withView = h("input", { type: "checkbox" });
  const link = (title: string, note: string, token: string | undefined): HTMLElement | null => {
    if (token === undefined) return null;
    const text = (): string => linkWith(token, withView.checked ? view : "");
    const field = h("input", { type: "text", readonly: true, value: text(), "aria-label": title, onfocus: () => field.select() });
    withView.addEventListener("change", () => (field.value = text()));
    return h("div", { class: "link" }, h("h3", {}, title), h("p", { class: "hint" }, note), h("div", { class: "row" }, field, button("Copy", { onclick: () => {
      field.select();
      navigator.clipboard.writeText(text()).then(() => twin.notice(`${title} copied`, "done"), () => twin.notice("Copy the marked link with Ctrl+C.", "done"));
    } })));
  };
  const links = twin.links.value;
  const box = dialog("Share this session", h("label", { class: "row own-name" }, "Your name", name), list,
    link("Link for viewers", "They can see everything but change nothing.", links.viewer),
    link("Link for controllers", "They can ask for control and then change the simulation.", links.controller),
    links.viewer === undefined && links.controller === undefined ? null
      : h("label", { class: "check", title: "Camera, map layer and scenarios as they are on this page now" }, withView, "Links open this view"),
    links.viewer === undefined && links.controller === undefined ? h("p", { class: "hint" }, "The program printed the links when it started.") : null,
    location.hostname === "127.0.0.1" || location.hostname === "localhost"
      ? h("p", { class: "hint" }, "These links work in browsers on this computer.") : null,
    links.controller !== undefined ? shareBeyond(twin.api, (sentence, kind) => twin.notice(sentence, kind)) : null);
  box.addEventListener("close", end);
  openDialog(box);
}
