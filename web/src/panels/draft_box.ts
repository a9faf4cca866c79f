// Display options while a new shape is drawn: instructions, sizes, live measures, and input without a mouse.
import { CrestProfile } from "../charts/crest";
import type { Drawing } from "../scene/drawing";
import { bytes, count, number, quantity } from "../state/format";
import { groundMeasures } from "../state/measures";
import { limitsOf } from "../state/rules";
import { area, drawnAsLine, fewestPoints, length, releaseVolume } from "../state/shapes";
import type { Shape, Twin } from "../state/twin";
import { fields as described, type FieldDescription } from "../protocol/schema";
import { choice } from "../ui/choice";
import { button, h } from "../ui/dom";
import { valueField } from "../ui/value_field";
import { newZoneFields } from "./zone_fields";

function howTo(shape: Shape, byLine: boolean): string {
  if (shape === "barrier") return "Click points along the line; double-click or Enter ends it.";
  if (shape === "inflow" && byLine) return "Click the two ends of a line across the flow. Debris enters towards the right, looking from the first to the second.";
  return `Click ${shape === "building" ? "the corners of the footprint" : "corners on the ground"}; double-click or Enter closes ${shape === "building" ? "it" : "the outline"}.`;
}

/** Fields for the initial values of a new shape; its other keys follow once it exists. */
function newFields(twin: Twin, shape: Shape, changed: () => void): HTMLElement[] {
  const sizes = twin.newShape;
  /** A field for one of the sizes. */
  const field = <Values extends object>(section: keyof typeof described, values: Values, key: keyof Values & string): HTMLElement => {
    const made = valueField((described[section] as Record<string, FieldDescription>)[key], values[key] as number, (v) => {
      Object.assign(values, { [key]: v });
      changed();
    });
    made.limit(limitsOf(section, key, twin.scene, values));
    return made.element;
  };
  switch (shape) {
    case "release":
      return [field("release", sizes.release, "thickness_m")];
    case "barrier":
      return [field("barrier", sizes.barrier, "height_m"), field("barrier", sizes.barrier, "thickness_m"),
        h("label", { class: "check", title: "At first half of the debris passes its meshes; change the share in its editor" },
          h("input", { type: "checkbox", onchange: (event: Event) => {
            sizes.barrier.passing_share = (event.currentTarget as HTMLInputElement).checked ? 0.5 : null;
          } }), "Net")];
    case "building":
      return [field("buildings", sizes.building, "height_m")];
    case "zone":
      return [newZoneFields((zone) => (sizes.zone = zone))];
    case "bed":
      return [field("bed", sizes.bed, "depth_m"), field("bed", sizes.bed, "growth_rate_per_m")];
    case "inflow":
      return [choice("Where debris enters", [["line", "Across a line"], ["area", "Over an area"]], "line", (where) => {
        twin.inflowByLine.value = where === "line";
        // Points of an outline are not a line: drawing starts again.
        twin.tool.value = { kind: "draw", shape };
      })];
  }
}

/** As the server reckons. */
const bytesPerParticle = 1500;

export function draftBox(twin: Twin, drawing: Drawing, shape: Shape): HTMLElement {
  const measure = h("output", { class: "measure", "aria-live": "polite" });
  const lie = h("output", { class: "hint lie" });
  const profile = shape === "barrier" ? new CrestProfile() : null;
  const path = twin.scene.flow_path;
  const across = shape === "barrier" && path ? button("Across the flow path", { class: "small", title: "At the place nearest to the pointer, or to the middle of the view (X)", onclick: () => drawing.snap() }) : null;
  const done = button("Finish", { class: "primary small", onclick: () => drawing.finish() });
  const how = h("p", { class: "hint" });
  const east = h("input", { type: "number", step: "any", "aria-label": "East of the next point, m", placeholder: "E, m" });
  const north = h("input", { type: "number", step: "any", "aria-label": "North of the next point, m", placeholder: "N, m" });
  const add = button("Add point", { class: "small", onclick: () => {
    if (Number.isFinite(east.valueAsNumber) && Number.isFinite(north.valueAsNumber)) drawing.addPoint([east.valueAsNumber, north.valueAsNumber]);
    else twin.notice("A point needs an east and a north coordinate in metres.", "error");
  } });
  /** What a release of so many m3 is made of. */
  const sizeOf = (volume_m3: number): string => {
    const particles = volume_m3 / twin.scene.particle_spacing_m ** 3;
    return `, ${count(particles)} particles, ${bytes(particles * bytesPerParticle)}`;
  };
  const show = (): void => {
    const points = [...drawing.draft.value];
    const byLine = twin.inflowByLine.value;
    const fewest = fewestPoints(shape, byLine);
    how.textContent = `${howTo(shape, byLine)}${across ? " X lays it across the flow path." : ""} Backspace takes the last one back, Escape cancels.`;
    done.disabled = points.length < fewest;
    if (drawing.shape !== shape) return;
    const { release, bed } = twin.newShape;
    measure.value = points.length < fewest ? `${points.length} of ${shape === "inflow" && byLine ? "" : "at least "}${fewest} points`
      : drawnAsLine(shape, byLine) ? `${quantity(length(points), "m")} long`
        : shape === "release" ? `${number(area(points))} m² × ${number(release.thickness_m)} m = ${quantity(releaseVolume(points, release.thickness_m, twin.relief), "m3")}${sizeOf(releaseVolume(points, release.thickness_m, twin.relief))}`
          : shape === "bed" ? `${number(area(points))} m² × ${number(bed.depth_m)} m = ${quantity(area(points) * bed.depth_m, "m3")}` : `${quantity(area(points), "m2")}`;
  };
  /** Of what is drawn, with the place of the pointer as the next corner. */
  const showLie = (): void => {
    if (drawing.shape !== shape) return;
    const outline = drawing.outline;
    const { value: pointer } = drawing.pointer;
    const relief = twin.relief;
    lie.value = outline.length > 1 ? groundMeasures(outline, !drawnAsLine(shape, twin.inflowByLine.value), relief, path)
      : pointer ? groundMeasures([pointer], false, relief, path) : "";
    profile?.show({ ...twin.newShape.barrier, height_m: twin.newShape.barrier.height_m ?? 0 }, outline, relief);
  };
  const fields = newFields(twin, shape, () => {
    show();
    showLie();
  });
  drawing.draft.watch(show);
  drawing.draft.watch(showLie);
  drawing.pointer.watch(showLie);
  twin.inflowByLine.watch(show);
  return h("div", { class: "draft" }, how, ...fields, measure, lie, profile?.element,
    h("details", {}, h("summary", {}, "By coordinates"), h("div", { class: "row coordinates" }, east, north, add)),
    h("div", { class: "row buttons" }, done, across, button("Cancel", { class: "small", onclick: () => drawing.cancel() })));
}
