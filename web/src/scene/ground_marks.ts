// Display of zones, beds, inflows and cross-sections: tints with patterns, outlines, arrows, names.
import type { Line2 } from "three/examples/jsm/lines/Line2.js";
import type { Point, SectionPlace, Setup } from "../protocol/messages";
import { quantity } from "../state/format";
import { bedNote, zoneNote } from "../state/ground";
import { arrowAlong, arrowsOf, inflowNote } from "../state/inflows";
import { footprintArea, middle } from "../state/shapes";
import type { Area } from "./drawn_areas";
import type { Label } from "./labels";
import { pixelLine, type Look } from "./lines";
import type { Relief } from "./relief";

const colours = { zone: "#00694f", bed: "#7a3d8f", inflow: "#0a5fae", section: "#1d6fb8" };

/** Lines of a wide area are farther apart: seen from a distance they would merge into grey. */
const gapOf = (polygon: readonly (readonly Point[])[]): number => Math.min(25, Math.max(3, Math.sqrt(footprintArea([polygon])) / 16));

/** From bottom to top. */
export function groundAreas(setup: Setup): Area[] {
  const areas = (polygons: readonly (readonly (readonly Point[])[])[], colour: string, opacity: number, pattern: Area["pattern"]): Area[] =>
    polygons.map((rings) => ({ rings, colour, opacity, pattern, gap_m: gapOf(rings) }));
  return [
    ...setup.zones.flatMap((zone) => areas(zone.polygons, colours.zone, 0.14, "falling")),
    ...setup.beds.flatMap((bed) => areas(bed.polygons, colours.bed, 0.14, "dots")),
    ...setup.inflows.flatMap((inflow) => areas(inflow.polygons, colours.inflow, 0.16, "level")),
  ];
}

/** Dashed: not in force yet. */
export function groundLines(setup: Setup, relief: Relief): Line2[] {
  const lines: Line2[] = [];
  const outline = (polygons: readonly (readonly (readonly Point[])[])[], look: Look): void => {
    for (const rings of polygons) for (const ring of rings) lines.push(pixelLine(relief.drape(ring, 0.25, true), look));
  };
  for (const zone of setup.zones) outline(zone.polygons, { colour: colours.zone, width_px: 1.6 });
  for (const bed of setup.beds) outline(bed.polygons, { colour: colours.bed, width_px: 1.6, dashed: !bed.in_force });
  for (const inflow of setup.inflows) {
    const dashed = !inflow.in_force;
    outline(inflow.polygons, { colour: colours.inflow, width_px: 2, dashed });
    if (inflow.line) lines.push(pixelLine(relief.drape(inflow.line, 0.5), { colour: colours.inflow, width_px: 4, dashed }));
    const arrows = inflow.line ? arrowsOf(inflow.line)
      : inflow.direction_deg === null ? [] : inflow.polygons.map((rings) => arrowAlong(middle(rings[0]), inflow.direction_deg ?? 0, footprintArea([rings])));
    for (const arrow of arrows) lines.push(pixelLine(relief.drape(arrow, 0.5), { colour: colours.inflow, width_px: 2.5 }));
  }
  return lines;
}

/** selected: its handles replace its name. */
export function groundLabels(setup: Setup, relief: Relief, selected: string | null): Label[] {
  const labels: Label[] = [];
  const put = (id: string, at: readonly Point[], text: string, kind: "zone" | "bed" | "inflow", priority: number): void => {
    if (id === selected || at.length === 0) return;
    const [x, y] = middle(at);
    labels.push({ at: relief.local(x, y, 2), text, kind, priority });
  };
  for (const zone of setup.zones) put(zone.id, zone.polygons[0]?.[0] ?? [], `${zone.name}, ${zoneNote(zone)}`, "zone", 4);
  for (const bed of setup.beds) put(bed.id, bed.polygons[0]?.[0] ?? [], `${bed.name}, ${bedNote(bed)}`, "bed", 5);
  for (const inflow of setup.inflows) put(inflow.id, inflow.line ?? inflow.polygons[0]?.[0] ?? [], `${inflow.name}, ${inflow.in_force ? quantity(inflow.volume_m3, "m3") : inflowNote(inflow)}`, "inflow", 7);
  return labels;
}

/** Not of the setup: those of the scene file, in every scenario. */
export const sectionLines = (sections: readonly SectionPlace[], relief: Relief): Line2[] =>
  sections.map(({ line }) => pixelLine(relief.drape(line, 0.4), { colour: colours.section, width_px: 2.5 }));

export const sectionLabels = (sections: readonly SectionPlace[], relief: Relief): Label[] =>
  sections.map(({ name, line }) => {
    const [x, y] = middle(line);
    return { at: relief.local(x, y, 1), text: name, kind: "section", priority: 5 };
  });
