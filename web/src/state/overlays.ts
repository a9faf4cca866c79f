// Layers that people lay over the terrain, without graphics: files that belong together, features at a place, map tiles.
import type { Overlay, OverlayData, OverlayFeature, OverlayStyle, Point } from "../protocol/messages";

/** How somebody who cannot change a layer for everybody sees it. */
export interface OwnLook { visible?: boolean; opacity?: number }
export const seenAs = (overlay: Overlay, own: OwnLook | undefined): { visible: boolean; opacity: number } =>
  ({ visible: own?.visible ?? overlay.visible, opacity: own?.opacity ?? overlay.opacity });
export type OwnLooks = ReadonlyMap<string, OwnLook>;
export const withOwn = (own: OwnLooks, id: string, wanted: OwnLook): OwnLooks => new Map([...own, [id, { ...own.get(id), ...wanted }]]);
/** One's own look of a layer ends where it is changed for everybody. */
export const withoutOwn = (own: OwnLooks, id: string): OwnLooks => (own.has(id) ? new Map([...own].filter(([of]) => of !== id)) : own);
/** What the list of layers shows: it stays as it is, with what is being used in it, until this changes. fixed: they cannot be changed for everybody. */
export const listKey = (overlays: readonly Overlay[], own: OwnLooks, fixed: boolean): string => JSON.stringify([overlays, [...own], fixed]);

const partsOf: Record<string, readonly string[]> = {
  shp: ["shx", "dbf", "prj", "cpg", "qpj", "sbn", "sbx"], tif: ["tfw", "tifw", "wld", "prj"], tiff: ["tfw", "tifw", "wld", "prj"],
  jpg: ["jgw", "jpgw", "wld", "prj"], jpeg: ["jgw", "jpgw", "wld", "prj"], png: ["pgw", "wld", "prj"],
};
const companions = new Set(Object.values(partsOf).flat());

export interface FileGroup { main: string; parts: readonly string[] }
const splitName = (name: string): [string, string] => {
  const dot = name.lastIndexOf(".");
  return dot < 0 ? [name.toLowerCase(), ""] : [name.slice(0, dot).toLowerCase(), name.slice(dot + 1).toLowerCase()];
};

/** Files dropped together, each with what belongs to it; alone: companions of none of them. */
export function groupFiles(names: readonly string[]): { groups: FileGroup[]; alone: string[] } {
  const taken = new Set<string>();
  const groups = names.filter((name) => !companions.has(splitName(name)[1])).map((main) => {
    const [stem, ending] = splitName(main);
    const parts = names.filter((name) => splitName(name)[0] === stem && (partsOf[ending] ?? []).includes(splitName(name)[1]));
    for (const part of parts) taken.add(part);
    return { main, parts };
  });
  return { groups, alone: names.filter((name) => companions.has(splitName(name)[1]) && !taken.has(name)) };
}

/** Of a feature, whose layer has a colour for what the file gives no style. */
export function styleOf(data: OverlayData, feature: OverlayFeature, colour: string): OverlayStyle {
  return data.styles[feature.style] ?? { stroke: colour, stroke_opacity: 1, fill: feature.kind === "line" ? "" : colour, fill_opacity: feature.kind === "area" ? 0.25 : 1, width_px: 2, size_px: 10 };
}

/** West, south, east and north of all features, in their coordinates; null: there are none. */
export function boundsOf(data: OverlayData): [number, number, number, number] | null {
  const box: [number, number, number, number] = [Infinity, Infinity, -Infinity, -Infinity];
  for (const { parts } of data.features) {
    for (const part of parts) {
      for (let k = 0; k + 1 < part.length; k += 2) {
        box[0] = Math.min(box[0], part[k]);
        box[1] = Math.min(box[1], part[k + 1]);
        box[2] = Math.max(box[2], part[k]);
        box[3] = Math.max(box[3], part[k + 1]);
      }
    }
  }
  return box[0] <= box[2] ? box : null;
}

function distanceToLine(part: readonly number[], x: number, y: number): number {
  let nearest = Infinity;
  for (let k = 0; k + 3 < part.length; k += 2) {
    const [ax, ay, bx, by] = [part[k], part[k + 1], part[k + 2], part[k + 3]];
    const length2 = (bx - ax) ** 2 + (by - ay) ** 2;
    const t = length2 > 0 ? Math.min(1, Math.max(0, ((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / length2)) : 0;
    nearest = Math.min(nearest, Math.hypot(ax + t * (bx - ax) - x, ay + t * (by - ay) - y));
  }
  return nearest;
}
function isInside(rings: readonly (readonly number[])[], x: number, y: number): boolean {
  let inside = false;
  for (const ring of rings) {
    for (let k = 0, last = ring.length - 2; k + 1 < ring.length; last = k, k += 2) {
      const [ax, ay, bx, by] = [ring[k], ring[k + 1], ring[last], ring[last + 1]];
      if (ay > y !== by > y && x < ((bx - ax) * (y - ay)) / (by - ay) + ax) inside = !inside;
    }
  }
  return inside;
}
const order = { point: 0, line: 1, area: 2 };
/** The feature at a place, a point before a line before an area; of those above one another the upper. near: how far a point or a line may be. */
export function featureAt(data: OverlayData, x: number, y: number, near: number): OverlayFeature | null {
  let found: OverlayFeature | null = null;
  for (const feature of data.features) {
    if (found && order[feature.kind] > order[found.kind]) continue;
    const hit = feature.kind === "area" ? isInside(feature.parts, x, y)
      : feature.kind === "line" ? feature.parts.some((part) => distanceToLine(part, x, y) <= near)
        : feature.parts.some((part) => Math.hypot(part[0] - x, part[1] - y) <= near);
    if (hit) found = feature;
  }
  return found;
}
/** Where the name of a feature stands. */
export function nameAt(feature: OverlayFeature): Point {
  const part = feature.parts[0];
  if (feature.kind !== "area") {
    const middle = (part.length / 2 - 1) / 2;
    const [a, b] = [2 * Math.floor(middle), 2 * Math.ceil(middle)];
    return [(part[a] + part[b]) / 2, (part[a + 1] + part[b + 1]) / 2];
  }
  let [x, y] = [0, 0];
  for (let k = 0; k + 1 < part.length; k += 2) {
    x += part[k];
    y += part[k + 1];
  }
  return [(2 * x) / part.length, (2 * y) / part.length];
}

/** Position in Web Mercator, 0 to 1 from the west and from the north (Snyder 1987, eq. 7-7, on a sphere). */
export function mercator(longitude_deg: number, latitude_deg: number): Point {
  const s = Math.sin((Math.min(85.0511, Math.max(-85.0511, latitude_deg)) * Math.PI) / 180);
  return [longitude_deg / 360 + 0.5, 0.5 - Math.log((1 + s) / (1 - s)) / (4 * Math.PI)];
}
/** "https://tile.example.org", which a page's policy names. */
export const originOf = (address: string): string => /^https?:\/\/[^/]*/.exec(address)?.[0] ?? address;
/** A page may load from the addresses that the server had when it sent the page, and from no other host. */
export const mayLoad = (address: string, atLoad: readonly string[]): boolean => atLoad.some((one) => originOf(one) === originOf(address));
/** As people read it. */
export const withoutScheme = (address: string): string => address.replace(/^https?:\/\//, "");

export interface TileRange { zoom: number; west: number; north: number; columns: number; rows: number }
/** The finest tiles of which at most so many cover all places. */
export function tileRange(places: readonly Point[], most: number, deepest = 19): TileRange {
  const west = Math.min(...places.map((p) => p[0]));
  const east = Math.max(...places.map((p) => p[0]));
  const north = Math.min(...places.map((p) => p[1]));
  const south = Math.max(...places.map((p) => p[1]));
  for (let zoom = deepest; ; --zoom) {
    const n = 2 ** zoom;
    const range = { zoom, west: Math.floor(west * n), north: Math.floor(north * n), columns: Math.floor(east * n) - Math.floor(west * n) + 1, rows: Math.floor(south * n) - Math.floor(north * n) + 1 };
    if (zoom === 0 || range.columns * range.rows <= most) return range;
  }
}
export function tileUrl(address: string, zoom: number, column: number, row: number): string {
  return address.replace(/\{(?:z|TileMatrix)\}/g, String(zoom)).replace(/\{(?:x|TileCol)\}/g, String(column)).replace(/\{(?:y|TileRow)\}/g, String(row));
}
