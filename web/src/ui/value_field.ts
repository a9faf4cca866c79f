// A field for a key of the scene, as the field table describes it.
import type { FieldDescription } from "../protocol/schema";
import { shownAs, toldAs } from "../state/format";
import type { Limits } from "../state/rules";
import { numberField } from "./field";
import { optionalField } from "./optional_field";

export interface ValueField {
  element: HTMLElement;
  show(value: number | null | undefined): void;
  enable(hindrance: string | null): void;
  limit(limits: Limits): void;
}

/**
 * `onset` receives values in the unit of the key; `none`: the value of an unticked optional one. Fields of `more` are
 * shown and hidden with it.
 */
export function valueField(about: FieldDescription, value: number | null, onset: (value: number | null) => void, none: number | null = null,
  more: readonly HTMLElement[] = []): ValueField {
  const options = { label: about.label, unit: about.unit, low: about.low, high: about.high, sliderLow: about.sliderLow, sliderHigh: about.sliderHigh, help: about.help, value: null };
  const tell = (v: number | null): void => onset(v === null ? none : toldAs(about, v));
  const field = about.tick === null ? numberField({ ...options, onset: tell }) : optionalField(about.tick, about.tickHelp, about.first, options, tell, more);
  const show = (v: number | null | undefined): void => field.show(v === null || v === undefined || (about.tick !== null && v === none) ? null : shownAs(about, v));
  show(value);
  return { element: field.element, show, enable: field.enable, limit: field.limit };
}
