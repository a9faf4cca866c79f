// Colour ramps with even steps of lightness (OKLab, Ottosson 2020), the same as those of the report. Lightness alone
// carries the order, so they are readable with colour blindness and in greyscale.

export type Rgb = [number, number, number];

export interface Ramp {
  lowHue: number;
  lowChroma: number;
  highHue: number;
  highChroma: number;
  lowLightness: number;
  highLightness: number;
}

function toLinear(l: number, a: number, b: number): Rgb {
  const p = (l + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const q = (l - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const r = (l - 0.0894841775 * a - 1.291485548 * b) ** 3;
  return [
    4.0767416621 * p - 3.3077115913 * q + 0.2309699292 * r,
    -1.2684380046 * p + 2.6097574011 * q - 0.3413193965 * r,
    -0.0041960863 * p - 0.7034186147 * q + 1.707614701 * r,
  ];
}

const encoded = (v: number): number => {
  const c = Math.min(1, Math.max(0, v));
  return Math.round(255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055));
};
const decoded = (byte: number): number => {
  const s = byte / 255;
  return s <= 0.04045 ? s / 12.92 : ((s + 0.055) / 1.055) ** 2.4;
};

/** Colour at `share` (0 to 1) as sRGB bytes. Chroma is reduced where sRGB cannot show it; lightness is kept. */
export function rampAt(ramp: Ramp, share: number): Rgb {
  const s = Math.min(1, Math.max(0, share));
  const l = ramp.lowLightness + (ramp.highLightness - ramp.lowLightness) * s;
  const hue = ((ramp.lowHue + (ramp.highHue - ramp.lowHue) * s) * Math.PI) / 180;
  let chroma = ramp.lowChroma + (ramp.highChroma - ramp.lowChroma) * s + 0.05 * Math.sin(Math.PI * s);
  let colour = toLinear(l, chroma * Math.cos(hue), chroma * Math.sin(hue));
  while (chroma > 0 && colour.some((v) => v < -1e-4 || v > 1 + 1e-4)) {
    chroma -= 0.002;
    colour = toLinear(l, chroma * Math.cos(hue), chroma * Math.sin(hue));
  }
  return colour.map(encoded) as Rgb;
}

/** Lightness in OKLab, 0 (black) to 1 (white). */
export function lightness([r, g, b]: Rgb): number {
  const [x, y, z] = [decoded(r), decoded(g), decoded(b)];
  return (
    0.2104542553 * Math.cbrt(0.4122214708 * x + 0.5363325363 * y + 0.0514459929 * z) +
    0.793617785 * Math.cbrt(0.2119034982 * x + 0.6806995451 * y + 0.1073969566 * z) -
    0.0040720468 * Math.cbrt(0.0883024619 * x + 0.2817188376 * y + 0.6299787005 * z)
  );
}

export const hex = (colour: Rgb): string => `#${colour.map((v) => v.toString(16).padStart(2, "0")).join("")}`;
export const fromHex = (text: string): Rgb => [1, 3, 5].map((k) => parseInt(text.slice(k, k + 2), 16)) as Rgb;
export const css = (colour: Rgb): string => `rgb(${colour.join(" ")})`;

const ramp = (lowHue: number, lowChroma: number, highHue: number, highChroma: number, lowLightness: number, highLightness: number): Ramp =>
  ({ lowHue, lowChroma, highHue, highChroma, lowLightness, highLightness });

export const ramps = {
  /** Debris by speed: dark plum at rest to pale yellow when fast, so that it stands out from pale ground. */
  speed: ramp(330, 0.05, 458, 0.12, 0.38, 0.93),
  depth: ramp(205, 0.05, 268, 0.15, 0.9, 0.28),
  /** Of the debris as a surface, which can lie on a map of depth with another scale. */
  surface_depth: ramp(160, 0.05, 195, 0.1, 0.94, 0.26),
  /** On houses, which can stand on a map of the pressure of the free flow. */
  impact_pressure: ramp(100, 0.1, 20, 0.15, 0.94, 0.34),
  /** For a calibration, reversed: the best fit is dark. */
  misfit: ramp(262, 0.12, 95, 0.05, 0.34, 0.96),
  /** Share of an ensemble's runs: as in its GeoTIFF styles. */
  probability: ramp(300, 0.05, 262, 0.13, 0.94, 0.26),
  pore_pressure_ratio: ramp(92, 0.06, 262, 0.14, 0.95, 0.3),
  erosion_depth: ramp(25, 0.07, 52, 0.13, 0.92, 0.3),
} as const;

/** B - A: blue where B is less, orange where B is more, near white at none. */
export function divergingAt(share: number): Rgb {
  const s = Math.min(1, Math.max(-1, share));
  return s < 0
    ? rampAt(ramp(240, 0.005, 252, 0.14, 0.95, 0.36), -s)
    : rampAt(ramp(70, 0.005, 45, 0.15, 0.95, 0.42), s);
}

/** 256 colours as RGBA bytes. */
export function table(at: (share: number) => Rgb): Uint8Array<ArrayBuffer> {
  const bytes = new Uint8Array(4 * 256);
  for (let i = 0; i < 256; ++i) bytes.set([...at(i / 255), 255], 4 * i);
  return bytes;
}

/** The round number (1, 2, 2.5 or 5 times a power of ten) at or above `value`. */
export function roundStep(value: number): number {
  if (!(value > 0) || !Number.isFinite(value)) return 1;
  const power = 10 ** Math.floor(Math.log10(value));
  for (const m of [1, 2, 2.5, 5]) if (value <= m * power * (1 + 1e-9)) return m * power;
  return 10 * power;
}

const leastSpeedScale_mps = 10;
/** Upper end of the colours of speed: the same for everybody who looks at these runs, whenever they came, from what the server says of the whole run. */
export const speedScale_mps = (states: readonly ({ peak_speed_mps: number | null } | null)[]): number =>
  Math.max(leastSpeedScale_mps, ...states.map((state) => (state?.peak_speed_mps ? roundStep(state.peak_speed_mps) : 0)));

/** Luminance of a colour of the page, #rrggbb, as WCAG 2.2 defines it. */
function luminance(hex: string): number {
  const [r, g, b] = [1, 3, 5].map((at) => Number.parseInt(hex.slice(at, at + 2), 16) / 255).map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4));
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}
export function contrast(a: string, b: string): number {
  const [low, high] = [luminance(a), luminance(b)].sort((u, v) => u - v);
  return (high + 0.05) / (low + 0.05);
}
/** Black or white, whichever can be read better on a colour: at least 4.5 to 1 on any. */
export const inkOn = (hex: string): string => (contrast(hex, "#ffffff") >= contrast(hex, "#000000") ? "#ffffff" : "#000000");
