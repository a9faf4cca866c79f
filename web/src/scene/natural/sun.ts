// Where the sun stands, and how bright it and the sky are there.
import { Color, Vector3 } from "three";

/** Day of the year, 1 to 365; hours of local solar time, 12: the sun is in the meridian. */
export interface Moment { day: number; hour: number }

/** An afternoon in autumn: low enough for shadows that show relief, high enough for light in gullies. */
export const usualMoment: Moment = { day: 265, hour: 15 };

/** A moment as a field for date and time has it, in a year without a leap day; null: none. */
export function momentOf(text: string): Moment | null {
  const [, month, date, hour, minute] = /^\d+-(\d+)-(\d+)T(\d+):(\d+)/.exec(text)?.map(Number) ?? [];
  if (month === undefined) return null;
  return { day: Math.min(365, Math.round((Date.UTC(2027, month - 1, date) - Date.UTC(2027, 0, 0)) / 86_400_000)), hour: hour + minute / 60 };
}
export function textOf({ day, hour }: Moment): string {
  return new Date(Date.UTC(2027, 0, day, 0, Math.round(60 * hour))).toISOString().slice(0, 16);
}

const radians = Math.PI / 180;

/** Unit vector towards the sun: x east, y north, z up. Declination after Cooper (1969), The absorption of radiation in solar stills. */
export function sunAt({ day, hour }: Moment, latitude_deg: number, into = new Vector3()): Vector3 {
  const declination = 23.45 * radians * Math.sin((2 * Math.PI * (284 + day)) / 365);
  const angle = 15 * radians * (hour - 12);
  const latitude = latitude_deg * radians;
  return into.set(
    -Math.cos(declination) * Math.sin(angle),
    Math.cos(latitude) * Math.sin(declination) - Math.sin(latitude) * Math.cos(declination) * Math.cos(angle),
    Math.sin(latitude) * Math.sin(declination) + Math.cos(latitude) * Math.cos(declination) * Math.cos(angle),
  );
}

/** Light on a surface that faces the sun and on one that faces the sky; brightness of the sky near the horizon and overhead. */
export interface Light { sun: Color; sky: Color; horizon: Color; zenith: Color }

const share = (from: number, to: number, x: number): number => {
  const t = Math.min(1, Math.max(0, (x - from) / (to - from)));
  return t * t * (3 - 2 * t);
};

export function lightAt(sine: number): Light {
  const elevation_deg = Math.asin(Math.min(1, Math.max(-1, sine))) / radians;
  const above = Math.max(0, elevation_deg);
  // Relative air mass after Kasten (1965), A new table and approximation formula for the relative optical air mass.
  const mass = 1 / (Math.sin(above * radians) + 0.15 * (above + 3.885) ** -1.253);
  const up = share(-0.8, 1.5, elevation_deg);
  const sun = new Color(...([0.10, 0.155, 0.27].map((depth) => 5.4 * up * Math.exp(-depth * mass)) as [number, number, number]));
  const day = 0.015 + 0.985 * share(-9, 18, elevation_deg);
  const dusk = 1 - share(2, 20, elevation_deg);
  return {
    sun,
    sky: new Color(1.15, 1.38, 1.72).lerp(new Color(0.75, 1.15, 2.1), 1 - share(-8, 0, elevation_deg)).multiplyScalar(day),
    horizon: new Color(0.60, 0.68, 0.76).lerp(new Color(0.80, 0.62, 0.50), 0.7 * dusk * share(-10, -3, elevation_deg)).multiplyScalar(day),
    zenith: new Color(0.115, 0.20, 0.37).lerp(new Color(0.13, 0.18, 0.32), dusk).multiplyScalar(day),
  };
}
