// Constraints on a value, shown next to its field before anything is sent: the ties of the field table.
import type { SceneInfo } from "../protocol/messages";
import { fields, ties, type FieldDescription } from "../protocol/schema";
import { quantity, tick } from "./format";

/** In the unit of the form. hindrance: why the value cannot be given here; hint: what narrows its range. */
export interface Limits { low: number; high: number; hindrance: string | null; hint: string | null }

export type Given = Pick<SceneInfo, "particle_spacing_m" | "settings">;

/** Why the scene refuses any value of this key; null: it does not. */
export function hindranceOf(section: string, key: string, scene: Given): string | null {
  const needs = ties[section]?.[key]?.needs;
  return needs && scene.settings[needs.key] !== needs.value ? `Needs ${needs.key} = "${needs.value}": ${needs.why}.` : null;
}

/** The least value that the particle spacing allows, in the unit of the key; rounded up, as by the server. */
export const leastOf = (section: string, key: string, scene: Given): number =>
  Math.ceil(1000 * (ties[section]?.[key]?.spacings ?? 0) * scene.particle_spacing_m) / 1000;

/** values: of the same shape, in the units of their keys. */
export function limitsOf(section: keyof typeof fields, key: string, scene: Given, values: object): Limits {
  const about = (fields[section] as Record<string, FieldDescription>)[key];
  const tie = ties[section]?.[key] ?? {};
  const said: string[] = [];
  let { low, high } = about;
  const least = leastOf(section, key, scene) * about.factor;
  if (least > low) {
    low = least;
    said.push(`Minimum ${tick(least)} ${about.unit}; ${tie.why}.`);
  }
  const above = tie.below === undefined ? null : (values as Record<string, unknown>)[tie.below];
  if (tie.below !== undefined && typeof above === "number" && above * about.factor <= high) {
    high = above * about.factor - 0.001;
    const other = (fields[section] as Record<string, FieldDescription>)[tie.below];
    said.push(`Below ${other.label.toLowerCase()}, ${quantity(above * about.factor, about.unit)}.`);
  }
  const hindrance = hindranceOf(section, key, scene);
  return { low, high, hindrance, hint: hindrance ?? (said.join(" ") || null) };
}
