// A QR code as a picture: dark modules on white, whatever the theme, with the margin that readers need.
import qrcode from "qrcode-generator";
import { h } from "./dom";

const margin = 4;

/** The dark modules as an SVG path, and the edge of the whole with its margin. */
export function qrPath(text: string): { path: string; size: number } {
  const code = qrcode(0, "M");
  code.addData(text);
  code.make();
  const modules = code.getModuleCount();
  let path = "";
  for (let row = 0; row < modules; ++row) {
    for (let column = 0; column < modules; ++column) if (code.isDark(row, column)) path += `M${column + margin} ${row + margin}h1v1h-1z`;
  }
  return { path, size: modules + 2 * margin };
}

export function qrCode(text: string, label: string): HTMLElement {
  const { path, size } = qrPath(text);
  const name = "http://www.w3.org/2000/svg";
  const svg = document.createElementNS(name, "svg");
  for (const [key, value] of Object.entries({ viewBox: `0 0 ${size} ${size}`, role: "img", "aria-label": label, "shape-rendering": "crispEdges" })) svg.setAttribute(key, value);
  const paper = document.createElementNS(name, "rect");
  for (const [key, value] of Object.entries({ width: size, height: size, fill: "#fff" })) paper.setAttribute(key, String(value));
  const dark = document.createElementNS(name, "path");
  dark.setAttribute("d", path);
  dark.setAttribute("fill", "#000");
  svg.append(paper, dark);
  return h("div", { class: "qr" }, svg);
}
