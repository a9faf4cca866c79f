// Pictures and video of the view, with title, time, legends and scale drawn in, so that they can be used in a report.
import type { ShownLayers } from "../scene/shown_layers";
import type { Stage } from "../scene/stage";
import { css, roundStep } from "../scene/colour";
import { changesText } from "../state/differences";
import { fixed, tick, unitText } from "../state/format";
import type { Twin } from "../state/twin";
import { presentLegends } from "./legends";

const font = "system-ui, 'Segoe UI', 'DejaVu Sans', sans-serif";

export function save(name: string, content: Blob): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

export class Picture {
  private readonly canvas = document.createElement("canvas");
  private recorder: MediaRecorder | null = null;
  private stopPictures = false;

  constructor(private readonly twin: Twin, private readonly stage: Stage, private readonly layers: ShownLayers) {
    stage.onPicture(() => {
      if (this.recorder?.state === "recording") this.compose(this.stage.canvas);
    });
  }
  private get fileName(): string {
    return this.twin.scene.title.toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-|-$/g, "");
  }

  /** Draws the view with its title and legends. */
  private compose(source: HTMLCanvasElement): HTMLCanvasElement {
    const { canvas, twin, stage } = this;
    const scale = source.width / Math.max(1, stage.element.clientWidth);
    if (canvas.width !== source.width || canvas.height !== source.height) {
      canvas.width = source.width;
      canvas.height = source.height;
    }
    const c = canvas.getContext("2d");
    if (!c) return canvas;
    c.setTransform(1, 0, 0, 1, 0, 0);
    c.drawImage(source, 0, 0);
    c.setTransform(scale, 0, 0, scale, 0, 0);
    const [width, height] = [canvas.width / scale, canvas.height / scale];
    c.textBaseline = "middle";
    const plate = (x: number, y: number, w: number, hh: number): void => {
      c.fillStyle = "rgb(255 255 255 / 0.9)";
      c.fillRect(x, y, w, hh);
      c.fillStyle = "#1c2126";
    };
    const title = twin.scene.title;
    const time = `t = ${fixed(stage.stats.shownTime_s, 1)} s`;
    c.font = `600 14px ${font}`;
    const changed = twin.shown.value.filter((name) => changesText(twin.cells[name].setup.value))
      .map((name) => `${twin.shown.value.length > 1 ? `${name} c` : "C"}hanged on the way: ${changesText(twin.cells[name].setup.value)}`);
    plate(10, 10, Math.max(c.measureText(title).width, 90) + 20, 44 + 15 * changed.length);
    c.fillText(title, 20, 25);
    c.font = `12px ${font}`;
    changed.forEach((line, i) => c.fillText(line, 20, 58 + 15 * i, width - 60));
    c.fillText(time + (stage.views.size > 1 ? `   ${twin.shown.value[0]} left, ${twin.shown.value[1]} right` : ""), 20, 43);
    let bottom = height - 10;
    for (const legend of presentLegends(twin, stage, this.layers)) {
      if (legend.from) bottom -= 15;
      if (legend.categories) {
        const rows = legend.categories.length;
        plate(10, bottom - 16 - 16 * rows, 208, 16 + 16 * rows + (legend.from ? 15 : 0));
        c.font = `600 12px ${font}`;
        c.fillText(legend.title, 20, bottom - 5 - 16 * rows, 188);
        c.font = `11px ${font}`;
        legend.categories.forEach((category, k) => {
          c.fillStyle = category.colour;
          c.fillRect(20, bottom - 14 - 16 * k, 11, 11);
          c.fillStyle = "#48525b";
          c.fillText(category.name, 38, bottom - 8 - 16 * k, 170);
        });
        if (legend.from) c.fillText(legend.from, 20, bottom + 6, 188);
        bottom -= 22 + 16 * rows;
        continue;
      }
      plate(10, bottom - 48, 208, legend.from ? 63 : 48);
      c.font = `600 12px ${font}`;
      c.fillText(`${legend.title}, ${unitText(legend.unit)}`, 20, bottom - 37, 188);
      for (let i = 0; i < 188; ++i) {
        c.fillStyle = css(legend.at(i / 187));
        c.fillRect(20 + i, bottom - 28, 1.5, 9);
      }
      c.fillStyle = "#48525b";
      c.font = `11px ${font}`;
      const step = roundStep((legend.high - legend.low) / 4.5);
      c.textAlign = "center";
      for (let v = Math.ceil(legend.low / step) * step; v <= legend.high + 1e-9; v += step) {
        c.fillText(tick(v), 20 + (188 * (v - legend.low)) / (legend.high - legend.low), bottom - 9);
      }
      c.textAlign = "left";
      if (legend.from) c.fillText(legend.from, 20, bottom + 6, 188);
      bottom -= 54;
    }
    const perPixel = stage.metresPerPixel;
    const length = roundStep(perPixel * 60);
    plate(width - 30 - length / perPixel, height - 40, length / perPixel + 20, 30);
    c.font = `11px ${font}`;
    c.fillText(`${tick(length)}\u202fm`, width - 20 - length / perPixel, height - 31);
    c.fillRect(width - 20 - length / perPixel, height - 19, length / perPixel, 2);
    c.fillStyle = "#5a646e";
    c.font = `10px ${font}`;
    c.fillText("talus", width - 36, 16);
    return canvas;
  }

  async png(): Promise<void> {
    const canvas = this.compose(this.stage.drawNow());
    const blob = await new Promise<Blob | null>((resolve) => canvas.toBlob(resolve, "image/png"));
    if (blob) save(`${this.fileName}-${fixed(this.stage.stats.shownTime_s, 1)}s.png`, blob);
  }
  /** The view as it is, for another document. */
  still(): string {
    return this.compose(this.stage.drawNow()).toDataURL("image/jpeg", 0.9);
  }
  get recording(): boolean {
    return this.recorder !== null;
  }
  /** Starts a video of the view, or ends it and saves it. Calls `changed` when it has started and when it is saved. */
  video(changed: () => void): void {
    if (this.recorder) {
      this.recorder.stop();
      return;
    }
    const type = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm"].find((t) => MediaRecorder.isTypeSupported(t));
    if (!type) {
      this.twin.notice("This browser cannot record WebM video.", "error");
      return;
    }
    this.compose(this.stage.drawNow());
    const recorder = new MediaRecorder(this.canvas.captureStream(30), { mimeType: type, videoBitsPerSecond: 8_000_000 });
    const parts: Blob[] = [];
    recorder.ondataavailable = (event) => parts.push(event.data);
    recorder.onstop = () => {
      this.recorder = null;
      this.stopPictures = true;
      save(`${this.fileName}.webm`, new Blob(parts, { type: "video/webm" }));
      changed();
    };
    recorder.start(500);
    this.recorder = recorder;
    this.stopPictures = false;
    // The encoder ends a video with the last picture: a still view must also be drawn.
    const still = (): void => {
      if (this.stopPictures) return;
      this.stage.invalidate();
      setTimeout(still, 100);
    };
    still();
    changed();
  }
}
