// Elements without a framework.

type Value = string | number | boolean | null | undefined | ((event: never) => void);
export type Child = Node | string | null | undefined | false;

/** `on...` functions become listeners; false, null and undefined omit an attribute; true sets it without a value. */
export function h<K extends keyof HTMLElementTagNameMap>(name: K, attributes: Record<string, Value> = {}, ...children: Child[]): HTMLElementTagNameMap[K] {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (typeof value === "function") element.addEventListener(key.slice(2), value as EventListener);
    else if (value !== null && value !== undefined && value !== false) element.setAttribute(key, value === true ? "" : String(value));
  }
  for (const child of children) if (child !== null && child !== undefined && child !== false) element.append(child);
  return element;
}

let lastId = 0;
export const freshId = (prefix: string): string => `${prefix}-${++lastId}`;

/** Icons are drawn on 16 x 16 with lines 1.5 wide. */
const paths = {
  run: "M4.5 2.8v10.4L13 8z",
  pause: "M5 3v10M11 3v10",
  step: "M3.5 3v10l6-5zM12 3v10",
  restart: "M13 8a5 5 0 1 1-1.6-3.7M13 2v3h-3",
  undo: "M3 6h6.5a3.5 3.5 0 0 1 0 7H6M3 6l3-3M3 6l3 3",
  redo: "M13 6H6.5a3.5 3.5 0 0 0 0 7H10M13 6l-3-3M13 6l-3 3",
  plus: "M8 3v10M3 8h10",
  minus: "M3 8h10",
  remove: "M4 4l8 8M12 4l-8 8",
  orbit: "M8 2a6 6 0 1 1 0 12A6 6 0 0 1 8 2zM2 8c0-1.6 2.7-2.6 6-2.6s6 1 6 2.6-2.7 2.6-6 2.6S2 9.600 2 8z",
  fly: "M2 8.500 14 3l-4.500 11-2.300-4.200z",
  follow: "M8 5.500a2.500 2.500 0 1 1 0 5 2.500 2.500 0 0 1 0-5zM8 1.500v2M8 12.500v2M1.500 8h2M12.500 8h2",
  top: "M2.500 2.500h11v11h-11zM8 5v6M5.500 7.500 8 5l2.500 2.500",
  fit: "M2.500 6V2.500H6M10 2.500h3.500V6M13.500 10v3.500H10M6 13.500H2.500V10",
  save: "M4 2.500h8v11l-4-3-4 3z",
  probe: "M8 14s-4.500-4.600-4.500-7.800a4.500 4.500 0 0 1 9 0C12.500 9.400 8 14 8 14zM8 4.800a1.500 1.500 0 1 1 0 3 1.500 1.500 0 0 1 0-3z",
  section: "M2 13.500 14 2.500M2 13.500h2.500M14 2.500h-2.500M6.500 11.500 4.500 9.300M9 9.300 7 7M11.500 7 9.500 4.700",
  ruler: "M1.500 10.500 10.500 1.500l4 4-9 9zM4 8l1.500 1.500M6 6l2 2M8 4l1.500 1.500",
  share: "M12 5.500a2 2 0 1 0 0-4 2 2 0 0 0 0 4zM4 10a2 2 0 1 0 0-4 2 2 0 0 0 0 4zM12 14.500a2 2 0 1 0 0-4 2 2 0 0 0 0 4zM5.800 7 10.200 4.500M5.800 9l4.400 2.500",
  help: "M5.700 5.800A2.300 2.300 0 1 1 8 8.500v1.300M8 12.500v.4",
  picture: "M2.500 4.500h2.700L6.500 3h3l1.300 1.500h2.700v8.500h-11zM8 6.200a2.300 2.300 0 1 1 0 4.600 2.300 2.300 0 0 1 0-4.600z",
  video: "M2 4.500h8v7H2zM10 7.200l4-2.200v6l-4-2.200",
  film: "M2.500 3h11v10h-11zM5 3v10M11 3v10M2.500 6.300H5M2.500 9.700H5M11 6.300h2.500M11 9.700h2.500",
  download: "M8 2.500v7.500M4.800 7 8 10.200 11.200 7M3 13.500h10",
  panel: "M2.500 3h11v10h-11zM10 3v10",
  bars: "M2.500 13.500h11M4.500 11.500V8.500M8 11.500V3M11.500 11.500V6",
  compare: "M2.500 3h11v10h-11zM8 3v10",
  close: "M4 4l8 8M12 4l-8 8",
  menu: "M2.500 4.500h11M2.500 8h11M2.500 11.500h11",
  layers: "M8 2.500 14 5.800 8 9.100 2 5.800zM2.500 9 8 12.200 13.500 9",
  trigger: "M9 1.500 3.500 9H8l-1 5.500L12.500 7H8z",
  polygon: "M3 11.500 5 4l7-1.500 1.500 7L8 13.500z",
  barrier: "M2 12.500V6.500h12v6zM2 9.500h12M6 6.500v3M10 6.500v3M8 9.500v3M4 9.500v3M12 9.500v3",
  house: "M2.500 8 8 3l5.500 5M4 7v6.500h8V7",
  edit: "M3 13l.6-2.800L11 2.800l2.200 2.200-7.400 7.400z",
  note: "M3 2.500h10v7L9 13.500H3zM9 13.500v-4h4",
  live: "M8 5.500a2.500 2.500 0 1 1 0 5 2.500 2.500 0 0 1 0-5z",
} as const;
export type IconName = keyof typeof paths;

export function icon(name: IconName): SVGSVGElement {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  for (const [key, value] of Object.entries({ viewBox: "0 0 16 16", class: "icon", "aria-hidden": "true" })) svg.setAttribute(key, value);
  const path = document.createElementNS("http://www.w3.org/2000/svg", "path");
  path.setAttribute("d", paths[name]);
  svg.append(path);
  return svg;
}

export function button(label: string, attributes: Record<string, Value> & { icon?: IconName; bare?: boolean }): HTMLButtonElement {
  const { icon: name, bare, ...rest } = attributes;
  return h("button", { type: "button", class: bare ? "bare" : "", ...(bare ? { "aria-label": label, title: label } : {}), ...rest },
    name ? icon(name) : null, bare ? null : h("span", {}, label));
}
