// Light or dark, as the system has it. Styles follow by themselves; what is drawn on a canvas asks here.
import { fromHex, hex, type Rgb } from "../scene/colour";

const dark = (): MediaQueryList => matchMedia("(prefers-color-scheme: dark)");

/** Calls `redraw` when the system changes; returns how to stop that. */
export function onTheme(redraw: () => void): () => void {
  const query = dark();
  query.addEventListener("change", redraw);
  return () => query.removeEventListener("change", redraw);
}

/** A colour chosen for a light ground, lightened where the ground is dark. */
export const inkOf = (colour: string): string => (dark().matches && /^#[0-9a-f]{6}$/.test(colour) ? lightened(colour) : colour);

const share = 0.42;
export const lightened = (colour: string): string => hex(fromHex(colour).map((v) => Math.round(v + (255 - v) * share)) as Rgb);
/** Of the same quantity in the second of two scenarios: no two curves of a chart have one colour. */
export const besideColour = (colour: string): string => hex(fromHex(colour).map((v) => Math.round(v * 0.5)) as Rgb);

export const chartInk = (): { text: string; grid: string; ticks: string; ground: string; paper: string } =>
  dark().matches ? { text: "#a3afb9", grid: "#2a3239", ticks: "#4c5760", ground: "#3a3529", paper: "#171c21" }
    : { text: "#48525b", grid: "#e4e8eb", ticks: "#c3cad1", ground: "#e9e4da", paper: "#ffffff" };
