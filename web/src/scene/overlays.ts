// Layers of people over the terrain: areas and pictures painted into one texture of the ground, lines and points above it.
import { CanvasTexture, LinearFilter, LinearMipmapLinearFilter, SRGBColorSpace, Vector4, type Group } from "three";
import type { ScenarioName } from "../protocol/frame";
import type { Overlay, OverlayData, OverlayFeature, Overlays } from "../protocol/messages";
import { watchAll } from "../state/cell";
import { Fetched } from "../state/fetched";
import { boundsOf, featureAt, nameAt, seenAs, styleOf } from "../state/overlays";
import type { Twin } from "../state/twin";
import type { Draped } from "./ground";
import type { Label } from "./labels";
import { disposeMarks, overlayMarks } from "./overlay_marks";
import type { Relief } from "./relief";
import type { Stage } from "./stage";
import { tileBackground } from "./tile_background";

/** What comes of one file stays as it is: it is asked for once. */
type Content = { data: OverlayData } | { picture: ImageBitmap };
/** relief: the ground that they lie on; there is another one only where it has sunk. */
interface Marks { key: string; relief: Relief; group: Group }

const areaSide_px = 2048;
const pictureSide_px = 4096;
const mostNames = 150;
/** Where the ground sinks, lines follow it so much later at most. */
const sinking_ms = 1000;

export interface FoundFeature { overlay: Overlay; feature: OverlayFeature }

export class OverlayLayers {
  private readonly contents = new Fetched<Overlay, Content>((overlay) => this.load(overlay), () => this.refresh(), (content) => "picture" in content && content.picture.close());
  /** The list that the contents are of. */
  private listed: Overlays | null = null;
  private readonly marks = new Map<ScenarioName, Map<string, Marks>>();
  private texture: CanvasTexture | null = null;
  private painted = "";
  private background: { address: string; picture: HTMLCanvasElement } | null = null;

  constructor(private readonly twin: Twin, private readonly stage: Stage) {
    watchAll([twin.overlays, twin.ownOverlays, twin.shown], () => this.refresh());
    twin.tileAddress.watch(() => void this.loadBackground());
    let timer: number | undefined;
    stage.sinkings.watch(() => {
      timer ??= window.setTimeout(() => {
        timer = undefined;
        this.refresh();
      }, sinking_ms);
    });
  }

  /** The uppermost feature that is shown at a place; near: how far points and lines may be, m. */
  at(x: number, y: number, near: number): FoundFeature | null {
    const [west, south] = this.twin.scene.extent_m;
    for (const overlay of [...this.shownOverlays].reverse()) {
      const content = this.contents.held(overlay.id);
      const feature = content && "data" in content ? featureAt(content.data, x - west, y - south, near) : null;
      if (feature) return { overlay, feature };
    }
    return null;
  }
  zoomTo(id: string): void {
    const content = this.contents.held(id);
    const bounds = content && "data" in content ? boundsOf(content.data) : null;
    if (!bounds) return this.stage.rig.fit();
    const [west, south] = this.twin.scene.extent_m;
    const relief = this.stage.reliefOf(this.twin.edited.value);
    const size = Math.max(bounds[2] - bounds[0], bounds[3] - bounds[1], 20 * relief.grid.cell);
    this.stage.rig.visit(relief.local(west + (bounds[0] + bounds[2]) / 2, south + (bounds[1] + bounds[3]) / 2), 1.3 * size);
  }

  private get shownOverlays(): Overlay[] {
    return (this.twin.overlays.value?.overlays ?? []).filter((overlay) => seenAs(overlay, this.twin.ownOverlays.value.get(overlay.id)).visible);
  }
  private async load(overlay: Overlay): Promise<Content | null> {
    const { api } = this.twin;
    let content: Content | null = null;
    await this.twin.attempt(async () => {
      content = overlay.kind === "picture" ? { picture: await createImageBitmap(await api.overlayPicture(overlay.id)) } : { data: await api.overlay(overlay.id) };
    });
    return content;
  }
  private async loadBackground(): Promise<void> {
    const { twin } = this;
    const address = twin.tileAddress.value;
    if (address === null || this.background?.address === address) return this.refresh();
    let picture: HTMLCanvasElement | null = null;
    const answered = await twin.attempt(async () => {
      const [width, height] = this.sizeOf(pictureSide_px / 2);
      picture = await tileBackground(await twin.api.tiles(), address, width, height);
    });
    if (twin.tileAddress.value !== address) return;
    if (picture !== null) {
      this.background = { address, picture };
      return this.refresh();
    }
    if (answered) twin.notice("No tiles could be loaded: the server did not answer, or it does not allow other pages to use its tiles (CORS).", "error");
    twin.tileAddress.value = null;  // so that it can be chosen again
  }
  private sizeOf(side_px: number): [number, number] {
    const [west, south, east, north] = this.twin.scene.extent_m;
    const scale = side_px / Math.max(east - west, north - south);
    return [Math.max(1, Math.round((east - west) * scale)), Math.max(1, Math.round((north - south) * scale))];
  }

  private refresh(): void {
    const { twin, stage } = this;
    if (this.listed !== twin.overlays.value) {
      this.listed = twin.overlays.value;
      this.contents.keep(this.listed?.overlays ?? []);
    }
    const draped = this.paint();
    for (const [name, view] of stage.views) {
      view.ground.cover(draped);
      this.place(name);
      view.overlayLabels = this.labels(name);
      stage.relabel(view);
    }
    for (const [name, held] of [...this.marks]) {
      if (stage.views.has(name)) continue;
      for (const { group } of held.values()) disposeMarks(group);
      this.marks.delete(name);
    }
    stage.invalidate();
  }
  /** Areas, pictures and tiles; null: there are none. */
  private paint(): Draped | null {
    const { twin } = this;
    const layers = this.shownOverlays.flatMap((overlay) => {
      const content = this.contents.of(overlay);
      return content && ("picture" in content || content.data.features.some((f) => f.kind === "area"))
        ? [{ overlay, content, ...seenAs(overlay, twin.ownOverlays.value.get(overlay.id)) }] : [];
    });
    const tiles = twin.tileAddress.value !== null && this.background?.address === twin.tileAddress.value ? this.background.picture : null;
    const key = JSON.stringify([tiles ? twin.tileAddress.value : null, layers.map(({ overlay, opacity }) => [overlay.id, overlay.colour, opacity])]);
    const [west, south, east, north] = twin.scene.extent_m;
    const placing = new Vector4(west - twin.scene.origin[0], south - twin.scene.origin[1], 1 / (east - west), 1 / (north - south));
    if (key === this.painted) return this.texture ? { texture: this.texture, placing } : null;
    this.painted = key;
    this.texture?.dispose();
    this.texture = null;
    if (layers.length === 0 && !tiles) return null;
    const [width, height] = this.sizeOf(tiles || layers.some(({ content }) => "picture" in content) ? pictureSide_px : areaSide_px);
    const canvas = document.createElement("canvas");
    canvas.width = width;
    canvas.height = height;
    const context = canvas.getContext("2d");
    if (!context) return null;
    if (tiles) context.drawImage(tiles, 0, 0, width, height);
    const scale = width / (east - west);
    for (const { overlay, content, opacity } of layers) {
      context.globalAlpha = opacity;
      if ("picture" in content) context.drawImage(content.picture, 0, 0, width, height);
      else for (const feature of content.data.features) this.fill(context, content.data, feature, overlay.colour, opacity, scale, height);
    }
    this.texture = new CanvasTexture(canvas);
    this.texture.colorSpace = SRGBColorSpace;
    this.texture.magFilter = LinearFilter;
    this.texture.minFilter = LinearMipmapLinearFilter;
    this.texture.anisotropy = 8;
    return { texture: this.texture, placing };
  }
  private fill(context: CanvasRenderingContext2D, data: OverlayData, feature: OverlayFeature, colour: string, opacity: number, scale: number, height: number): void {
    const style = styleOf(data, feature, colour);
    if (feature.kind !== "area" || !style.fill) return;
    const path = new Path2D();
    for (const ring of feature.parts) {
      for (let k = 0; k + 1 < ring.length; k += 2) path.lineTo(ring[k] * scale, height - ring[k + 1] * scale);
      path.closePath();
    }
    context.globalAlpha = style.fill_opacity * opacity;
    context.fillStyle = style.fill;
    context.fill(path, "evenodd");
  }
  private place(name: ScenarioName): void {
    const view = this.stage.views.get(name);
    if (!view) return;
    const held = this.marks.get(name) ?? new Map<string, Marks>();
    this.marks.set(name, held);
    const wanted = new Set<string>();
    for (const overlay of this.shownOverlays) {
      const content = this.contents.of(overlay);
      if (!content || !("data" in content)) continue;
      wanted.add(overlay.id);
      const { opacity } = seenAs(overlay, this.twin.ownOverlays.value.get(overlay.id));
      const key = JSON.stringify([overlay.colour, opacity]);
      const before = held.get(overlay.id);
      const { relief } = view;
      if (before?.key === key && before.relief === relief && before.group.parent === view.three) continue;
      if (before) disposeMarks(before.group);
      const group = overlayMarks(content.data, overlay.colour, opacity, relief, this.twin.scene);
      view.three.add(group);
      held.set(overlay.id, { key, relief, group });
    }
    for (const [id, { group }] of [...held]) {
      if (wanted.has(id)) continue;
      disposeMarks(group);
      held.delete(id);
    }
  }
  private labels(name: ScenarioName): Label[] {
    const labels: Label[] = [];
    const [west, south] = this.twin.scene.extent_m;
    const relief = this.stage.reliefOf(name);
    for (const overlay of this.shownOverlays) {
      const content = this.contents.held(overlay.id);
      if (!content || !("data" in content)) continue;
      for (const feature of content.data.features) {
        if (feature.name === "" || labels.length >= mostNames) continue;
        const [x, y] = nameAt(feature);
        labels.push({ at: relief.local(west + x, south + y, 1), text: feature.name.slice(0, 40), kind: "overlay", priority: feature.kind === "point" ? 3 : 0 });
      }
    }
    return labels;
  }
}
