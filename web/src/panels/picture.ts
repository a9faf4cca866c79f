// Pictures and video of the view, with title, time, legends and scale drawn in, so that they can be used in a report.
import type { ShownLayers } from "../scene/shown_layers";
import type { Stage } from "../scene/stage";
import { roundStep } from "../scene/colour";
import { changesText } from "../state/differences";
import { fixed, tick } from "../state/format";
import type { Twin } from "../state/twin";
import { save } from "../ui/save";
import { font, LegendStrip } from "./legend_strip";
import { presentLegends } from "./legends";

export class Picture {
  private readonly canvas = document.createElement("canvas");
  private recorder: MediaRecorder | null = null;
  private stopPictures = false;

  constructor(private readonly twin: Twin, private readonly stage: Stage, private readonly layers: ShownLayers) {
    stage.onPicture(() => {
      if (this.recorder?.state === "recording") this.compose(this.stage.canvas);
    });
  }
  get fileName(): string {
    return this.twin.scene.title.toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-|-$/g, "");
  }

  /** Draws the view with its title and legends. */
  private compose(source: HTMLCanvasElement): HTMLCanvasElement {
    const { canvas, twin, stage } = this;
    const scale = source.width / Math.max(1, stage.element.clientWidth);
    const strip = new LegendStrip(presentLegends(twin, stage, this.layers), source.width / scale);
    // A video keeps its size while legends come and go.
    const tall = this.recorder ? canvas.height : Math.round(source.height + strip.height * scale);
    if (canvas.width !== source.width || canvas.height !== tall) {
      canvas.width = source.width;
      canvas.height = tall;
    }
    const c = canvas.getContext("2d");
    if (!c) return canvas;
    c.setTransform(1, 0, 0, 1, 0, 0);
    c.fillStyle = "#fff";
    c.fillRect(0, 0, canvas.width, canvas.height);
    c.drawImage(source, 0, 0);
    c.setTransform(scale, 0, 0, scale, 0, 0);
    const [width, height] = [source.width / scale, source.height / scale];
    c.textBaseline = "middle";
    const plate = (x: number, y: number, w: number, hh: number): void => {
      c.fillStyle = "rgb(255 255 255 / 0.9)";
      c.fillRect(x, y, w, hh);
      c.fillStyle = "#1c2126";
    };
    const title = twin.scene.title;
    const [first, second] = stage.stacked ? ["above", "below"] : ["left", "right"];
    const two = stage.views.size > 1;
    if (stage.divider !== null) {
      c.fillStyle = "#fff";
      c.fillRect(stage.divider * width - 1, 0, 2, height - strip.height);
    }
    const times = two ? twin.shown.value.map((name, i) => `${name} ${i === 0 ? first : second}: t = ${fixed(stage.timeOf(name), 1)} s`) : [`t = ${fixed(stage.stats.shownTime_s, 1)} s`];
    const time = [...times, ...(this.layers.isDifference ? [`map in both: ${twin.differenceName}`] : [])].join("   ");
    const changed = twin.shown.value.filter((name) => changesText(twin.cells[name].setup.value))
      .map((name) => `${twin.shown.value.length > 1 ? `${name} c` : "C"}hanged on the way: ${changesText(twin.cells[name].setup.value)}`);
    const lines = [time, ...changed];
    c.font = `12px ${font}`;
    const widest = Math.max(...lines.map((line) => c.measureText(line).width));
    c.font = `600 14px ${font}`;
    plate(10, 10, Math.min(width - 40, Math.max(c.measureText(title).width, widest, 90) + 20), 29 + 15 * lines.length);
    c.fillText(title, 20, 25);
    c.font = `12px ${font}`;
    lines.forEach((line, i) => c.fillText(line, 20, 43 + 15 * i, width - 60));
    strip.draw(c, height);
    const perPixel = stage.metresPerPixel;
    const length = roundStep(perPixel * 60);
    plate(width - 30 - length / perPixel, height - 40, length / perPixel + 20, 30);
    c.font = `11px ${font}`;
    c.fillText(`${tick(length)}\u202fm`, width - 20 - length / perPixel, height - 31);
    c.fillRect(width - 20 - length / perPixel, height - 19, length / perPixel, 2);
    this.drawNorth(c, width - 28, height - 66);
    c.fillStyle = "#5a646e";
    c.font = `10px ${font}`;
    c.fillText("talus", width - 36, 16);
    return canvas;
  }

  private drawNorth(c: CanvasRenderingContext2D, x: number, y: number): void {
    c.save();
    c.fillStyle = "rgb(255 255 255 / 0.9)";
    c.beginPath();
    c.arc(x, y, 20, 0, 2 * Math.PI);
    c.fill();
    c.fillStyle = "#0e4a5f";
    c.translate(x, y);
    c.rotate(this.stage.rig.turn);
    c.beginPath();
    c.moveTo(0, -8);
    c.lineTo(5, 14);
    c.lineTo(-5, 14);
    c.fill();
    c.font = `600 10px ${font}`;
    c.textAlign = "center";
    c.fillText("N", 0, -13);
    c.restore();
  }

  /** The view with its title, legends and scale. */
  async file(): Promise<{ name: string; content: Blob }> {
    const canvas = this.compose(this.stage.drawNow());
    const content = await new Promise<Blob | null>((resolve) => canvas.toBlob(resolve, "image/png"));
    if (!content) throw new Error("The browser could not make the picture.");
    const { twin, stage } = this;
    const times = twin.shown.value.map((name) => `-${twin.shown.value.length > 1 ? name : ""}${fixed(stage.timeOf(name), 1)}s`);
    return { name: `${this.fileName}${times.join("")}.png`, content };
  }
  png(): void {
    void this.twin.attempt(async () => {
      const { name, content } = await this.file();
      save(name, content);
    });
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
