// Numbers with their units, as the page writes them everywhere.
import type { FieldDescription } from "../protocol/schema";
const nothing = "–";

/** Unit as it is shown: kg/m3 becomes kg/m³. */
export function unitText(unit: string): string {
  return unit.replace(/([a-zA-Z])2\b/g, "$1²").replace(/([a-zA-Z])3\b/g, "$1³");
}

/** How many decimals so many significant digits come to. */
export const decimals = (value: number, digits = 3): number => (value === 0 ? 0 : Math.max(0, Math.min(6, digits - 1 - Math.floor(Math.log10(Math.abs(value))))));

/** `digits`: significant digits; thousands are set apart by a thin space. */
export function number(value: number | null | undefined, digits = 3): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return nothing;
  const fixed = value.toFixed(decimals(value, digits));
  const [whole = "", part] = fixed.split(".");
  const grouped = whole.replace(/\B(?=(\d{3})+(?!\d))/g, "\u202f").replace("-", "\u2212");
  return part === undefined ? grouped : `${grouped}.${part}`;
}
export function quantity(value: number | null | undefined, unit: string, digits = 3): string {
  const text = number(value, digits);
  return unit === "" || text === nothing ? text : `${text}\u202f${unitText(unit)}`;
}
/** A whole number of things. */
export function count(value: number | null | undefined): string {
  return value === null || value === undefined || !Number.isFinite(value) ? nothing : number(Math.round(value), Math.max(1, String(Math.abs(Math.round(value))).length));
}
/** At a tick of a scale: without trailing zeros. */
export function tick(value: number): string {
  return number(value, 3).replace(/(\.\d*?)0+$/, "$1").replace(/\.$/, "");
}
/** With a fixed number of digits after the point: for values that change in place. */
export function fixed(value: number | null | undefined, after: number): string {
  return value === null || value === undefined || !Number.isFinite(value) ? nothing : value.toFixed(after).replace("-", "\u2212");
}
/** Of a share. */
export function percent(share: number | null, after: number): string {
  return share === null ? nothing : `${fixed(100 * share, after)} %`;
}
/** Decimals of lengths in m or volumes in m3 beside each other of which the largest is `size`, as core/decimals.hpp has them. */
export function decimalsFor(size: number, least: number): number {
  const magnitude = Math.abs(size);
  return magnitude > 0 && magnitude < 10 ? Math.max(least, decimals(magnitude)) : least;
}
export function bytes(value: number | null): string {
  if (value === null) return nothing;
  for (const [size, unit] of [[1e9, "GB"], [1e6, "MB"], [1e3, "kB"]] as const) {
    if (value >= size) return quantity(value / size, unit, 3);
  }
  return quantity(value, "B");
}

/** Factors of ten: without rounding, 0.3 would become 0.30000000000000004. */
const tidy = (value: number): number => Number(value.toPrecision(6));
/** Between the server's unit and the form's. */
export const shownAs = (about: FieldDescription, value: number): number => tidy(value * about.factor);
export const toldAs = (about: FieldDescription, value: number): number => tidy(value / about.factor);
