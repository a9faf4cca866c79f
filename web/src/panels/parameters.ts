// Material parameters: fields generated from the scene's own declaration.
import type { Parameter } from "../protocol/messages";
import { watchAll } from "../state/cell";
import { quantity, unitText } from "../state/format";
import { hindranceOf } from "../state/rules";
import type { Twin } from "../state/twin";
import { button, h } from "../ui/dom";
import { numberField } from "../ui/field";

/** Part of the range that a slider can usefully cover: around the default where the range itself is wide or open. */
export function sliderEnds(parameter: Parameter): [number, number] {
  const around = Math.abs(parameter.default ?? parameter.value ?? 1) || 1;
  const low = parameter.range.low ?? 0;
  const high = parameter.range.high ?? Infinity;
  const reach = around > 50 ? 2 * around : Math.max(1, 10 ** Math.ceil(Math.log10(around * 2)));
  return [Math.max(low, around > 50 ? 0.25 * around : low), Math.min(high, reach)];
}

export function parameterFields(twin: Twin): HTMLElement {
  const group = h("section", { class: "group", "aria-label": "Material" }, h("div", { class: "group-head" }, h("h2", {}, "Material")));
  for (const parameter of twin.scene.parameters) {
    const [sliderLow, sliderHigh] = sliderEnds(parameter);
    const field = numberField({
      label: parameter.label, unit: parameter.unit, help: parameter.help, usual: parameter.default, value: parameter.value,
      low: parameter.range.low ?? -1e12, high: parameter.range.high ?? 1e12, sliderLow, sliderHigh,
      onset: (value) => void twin.act({ action: "set_parameter", key: parameter.key, value }).then((done) => {
        if (!done) field.show(twin.now.setup.value?.parameters[parameter.key] ?? parameter.value);
      }),
    });
    const usual = parameter.default;
    const reset = button(`Reset ${parameter.label}`, { icon: "restart", bare: true, class: "bare quiet small",
      title: usual === null ? "No default" : `Back to the default, ${quantity(usual, parameter.unit, 4)}`,
      onclick: () => {
        if (usual !== null) void twin.act({ action: "set_parameter", key: parameter.key, value: usual });
      } });
    const help = h("p", { class: "help" }, `${parameter.help} Allowed: ${rangeText(parameter)}.`);
    help.hidden = true;
    const more = button(`What is ${parameter.label}?`, { icon: "help", bare: true, class: "bare quiet small", "aria-expanded": "false", onclick: () => {
      help.hidden = !help.hidden;
      more.setAttribute("aria-expanded", String(!help.hidden));
    } });
    more.title = parameter.help;
    field.element.firstElementChild?.after(h("span", { class: "field-tools" }, more, reset));
    field.element.append(help);
    group.append(field.element);
    const key = parameter.key.slice("material.".length);
    const needed = hindranceOf("material", key, twin.scene);
    field.limit({ low: parameter.range.low ?? -1e12, high: parameter.range.high ?? 1e12, hindrance: needed, hint: needed });
    watchAll([twin.edited, ...twin.every("setup"), twin.you, twin.controller, twin.connection], () => {
      const value = twin.now.setup.value?.parameters[parameter.key];
      field.show(value === undefined ? parameter.value : value);
      field.enable(twin.hindrance);
      const now = value === undefined ? parameter.value : value;
      reset.hidden = usual === null || now === usual;
      reset.disabled = (twin.hindrance ?? needed) !== null;
      field.element.classList.toggle("changed", usual !== null && now !== usual);
    });
  }
  return group;
}

function rangeText({ range, unit }: Parameter): string {
  const u = unitText(unit);
  if (range.low !== null && range.high !== null && !range.low_included) return `greater than ${range.low} and ${range.high_included ? "at most" : "below"} ${range.high} ${u}`.trim();
  if (range.low !== null && range.high !== null) return `${range.low} to ${range.high_included ? "" : "below "}${range.high} ${u}`.trim();
  if (range.low !== null) return `${range.low_included ? "at least" : "greater than"} ${range.low} ${u}`.trim();
  if (range.high !== null) return `${range.high_included ? "at most" : "below"} ${range.high} ${u}`.trim();
  return "any number";
}
