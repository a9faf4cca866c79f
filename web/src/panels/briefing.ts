// A briefing: a film along the flow path with captions of time, front velocity and what is hit, made picture by picture from the
// recording, so that it plays at its speed however slow the computer is that makes it.
import type { Frame } from "../protocol/frame";
import type { Impacts, Place, Series } from "../protocol/messages";
import { placeOnPath } from "../scene/scenario_view";
import type { Stage } from "../scene/stage";
import { course, endOfFlow, frontAt, hitUntil, pictures_hz, type Moment } from "../state/briefing";
import { decimalsFor, fixed } from "../state/format";
import type { Twin } from "../state/twin";
import { webm, type Encoded } from "../state/webm";
import { button, h } from "../ui/dom";
import { dialog, openDialog } from "../ui/dialog";
import { font } from "./legend_strip";
import { save } from "../ui/save";
import type { Picture } from "./picture";

const speeds: [string, string][] = [["0.5", "half speed"], ["1", "real time"], ["2", "2 × real time"], ["4", "4 × real time"], ["10", "10 × real time"]];
const bitrate = 8_000_000;
/** Longest edge of the film. */
const widest_px = 1920;

export function briefingButton(twin: Twin, stage: Stage, picture: Picture): HTMLElement {
  return button("Fly-through video", { icon: "film", bare: true, title: "Fly-through video along the flow path, with captions (WebM)", onclick: () => open(twin, stage, picture) });
}

function open(twin: Twin, stage: Stage, picture: Picture): void {
  const speed = h("select", { "aria-label": "Speed of the video" }, ...speeds.map(([value, name]) => h("option", { value }, name)));
  speed.value = "1";
  const overviews = h("input", { type: "checkbox", checked: true });
  const progress = h("progress", { max: "1", value: "0", "aria-label": "Progress of the video" });
  progress.hidden = true;
  const said = h("p", { class: "hint", role: "status" });
  let stopped = false;
  const last_s = twin.now.state.value?.recording.last_s ?? 0;
  const make = button("Make the video", { class: "primary", icon: "film", onclick: () => {
    make.disabled = speed.disabled = overviews.disabled = true;
    progress.hidden = false;
    void twin.attempt(async () => {
      const film = await new Briefing(twin, stage).make(Number(speed.value), overviews.checked, (share) => {
        progress.value = share;
        said.textContent = `${Math.round(100 * share)} % made`;
        return !stopped;
      });
      if (film) {
        save(`${picture.fileName}-fly-through.webm`, film);
        twin.notice("Video saved", "done");
      }
    }).then(() => element.close());
  } });
  const why = last_s < 0.2 ? "Nothing is recorded yet: run the simulation first."
    : twin.running ? "Pause the run first."
    : !("VideoEncoder" in window) ? "This browser makes videos only at https:// and localhost addresses." : "";
  make.disabled = why !== "";
  const element = dialog("Fly-through video", h("p", { class: "hint" }, "The camera follows the front along the flow path, in the present look, with captions of time, front velocity and what is hit."),
    why === "" ? null : h("p", { class: "hint" }, why), h("label", { class: "check" }, overviews, "Start and end with the whole scene"), h("div", { class: "row" }, speed, make), progress, said);
  element.addEventListener("close", () => (stopped = true));
  openDialog(element);
}

class Briefing {
  private readonly canvas = document.createElement("canvas");
  private readonly seen: Place = [0, 0, 0];
  private turn = 0;

  constructor(private readonly twin: Twin, private readonly stage: Stage) {}

  /** told: share that is made; false ends it. null: ended. */
  async make(speed: number, overviews: boolean, told: (share: number) => boolean): Promise<Blob | null> {
    const { twin, stage } = this;
    const name = twin.edited.value;
    const [series, impacts, { times_s }] = await Promise.all([twin.api.series(name), twin.api.impacts(name), twin.api.recording(name)]);
    const first = times_s[0] ?? 0;
    const last = times_s[times_s.length - 1] ?? 0;
    const moments = course(first, endOfFlow(series, last), speed, overviews);
    const before = { view: stage.rig.viewpoint, following: stage.rig.mode === "follow", replay: twin.replay_s.value };
    const pictures: Encoded[] = [];
    let failure: Error | null = null;
    const encoder = new VideoEncoder({
      output: (chunk) => {
        const bytes = new Uint8Array(chunk.byteLength);
        chunk.copyTo(bytes);
        pictures.push({ time_ms: chunk.timestamp / 1000, key: chunk.type === "key", bytes });
      },
      error: (error) => (failure = error),
    });
    let going = true;
    stage.filming = true;
    try {
      twin.replay_s.value = first;
      let shown = -1;
      for (const [k, moment] of moments.entries()) {
        shown = await this.show(times_s, moment.run_s, shown);
        this.aim(series, moment, speed);
        const source = stage.drawNow();
        if (k === 0) {
          const scale = Math.min(1, widest_px / Math.max(source.width, source.height));
          // Encoders want even sizes.
          this.canvas.width = 2 * Math.floor((scale * source.width) / 2);
          this.canvas.height = 2 * Math.floor((scale * source.height) / 2);
          encoder.configure({ codec: "vp8", width: this.canvas.width, height: this.canvas.height, bitrate, framerate: pictures_hz });
        }
        this.compose(source, moment, series, impacts);
        const picture = new VideoFrame(this.canvas, { timestamp: Math.round(1e6 * moment.film_s), duration: Math.round(1e6 / pictures_hz) });
        encoder.encode(picture, { keyFrame: k % 50 === 0 });
        picture.close();
        while (encoder.encodeQueueSize > 2) await new Promise((resolve) => setTimeout(resolve, 5));
        if (failure) throw failure as Error;
        going = told((k + 1) / moments.length);
        if (!going) break;
      }
      await encoder.flush();
    } finally {
      encoder.close();
      stage.filming = false;
      for (const view of stage.views.values()) view.clock.hold = null;
      stage.rig.go(before.view, false);
      if (before.following) stage.rig.setMode("follow");
      twin.replay_s.value = before.replay;
      if (before.replay === null) twin.askForFrames();
      else await this.show(times_s, before.replay, -1);
      for (const view of stage.views.values()) view.clock.hold = null;
    }
    if (!going) return null;
    const { width, height } = this.canvas;
    return webm(pictures, { width, height, codec: "V_VP8", lasts_ms: (1000 * moments.length) / pictures_hz });
  }

  /** Debris at a time, between the two recorded frames around it. */
  private async show(times: readonly number[], time_s: number, shown: number): Promise<number> {
    const { twin, stage } = this;
    let next = times.findIndex((t) => t >= time_s - 1e-6);
    if (next < 0) next = times.length - 1;
    if (next !== shown) {
      // Both frames around the time; one after the other where the film goes on.
      for (let k = next === shown + 1 ? next : Math.max(0, next - 1); k <= next; ++k) {
        const frames: Frame[] = await Promise.all(twin.shown.value.map((name) => twin.api.frame(name, times[k])));
        for (const frame of frames) twin.showFrame(frame);
      }
    }
    const earlier = times[Math.max(0, next - 1)];
    const gap = times[next] - earlier;
    for (const view of stage.views.values()) view.clock.hold = gap > 0 ? Math.min(1, Math.max(0, (time_s - earlier) / gap)) : 1;
    twin.replay_s.value = time_s;
    return next;
  }

  /** The camera looks at the front from below, turning slowly; at the whole scene before and after. */
  private aim(series: Series | null, moment: Moment, speed: number): void {
    const { twin, stage } = this;
    const { relief } = stage;
    const front = moment.part === "flow" ? frontAt(series, moment.run_s) : null;
    const place = front ? placeOnPath(twin.scene, front.chainage_m) : null;
    const wanted = place ? relief.local(place.at[0], place.at[1]) : relief.local(...relief.middle);
    // Ahead of the front is where the path goes next.
    const ahead = place ? Math.atan2(-place.across[0], place.across[1]) : stage.rig.downhill;
    const distance = place ? Math.min(110, 0.3 * (relief.width + relief.height)) : 0.62 * Math.hypot(relief.width, relief.height);
    const film_s = 1 / pictures_hz;
    const first = moment.film_s === 0;
    const ease = first ? 1 : 1 - Math.exp(-film_s * Math.min(4, 1.1 * Math.max(1, speed)));
    if (first) {
      this.distance = distance;
      this.turn = ahead + 0.35;
    }
    for (const k of [0, 1, 2] as const) this.seen[k] += (wanted[k] - this.seen[k]) * ease;
    this.distance += (distance - this.distance) * ease;
    const bend = Math.atan2(Math.sin(ahead + 0.35 - this.turn), Math.cos(ahead + 0.35 - this.turn));
    this.turn += bend * (1 - Math.exp(-0.5 * film_s * Math.max(1, speed))) + (moment.part === "flow" ? 0 : 0.06 * film_s);
    const tilt = 0.6;
    const [x, y, z] = this.seen;
    const position: Place = [x + this.distance * Math.cos(this.turn) * Math.cos(tilt), y + this.distance * Math.sin(this.turn) * Math.cos(tilt), z + this.distance * Math.sin(tilt)];
    const [ox, oy, oz] = relief.origin;
    position[2] = Math.max(position[2], relief.at(position[0] + ox, position[1] + oy) - oz + 0.25 * this.distance);
    stage.rig.go({ position, target: [x, y, z] }, false);
  }
  private distance = 0;

  private compose(source: HTMLCanvasElement, moment: Moment, series: Series | null, impacts: Impacts | null): void {
    const { canvas, twin } = this;
    const c = canvas.getContext("2d");
    if (!c) return;
    const [width, height] = [canvas.width, canvas.height];
    c.drawImage(source, 0, 0, width, height);
    const unit = Math.max(9, Math.min(width / 46, height / 26));
    const shade = c.createLinearGradient(0, height - 6.5 * unit, 0, height);
    shade.addColorStop(0, "rgb(12 16 20 / 0)");
    shade.addColorStop(1, "rgb(12 16 20 / 0.78)");
    c.fillStyle = shade;
    c.fillRect(0, height - 6.5 * unit, width, 6.5 * unit);
    const line = (words: string, x: number, y: number, size: number, weight = 400, align: CanvasTextAlign = "left"): void => {
      c.font = `${weight} ${size}px ${font}`;
      c.textAlign = align;
      c.fillStyle = "#fff";
      c.fillText(words, x, y, 0.6 * width);
    };
    c.textBaseline = "alphabetic";
    const front = moment.part === "before" ? null : frontAt(series, moment.run_s);
    line(`t = ${fixed(moment.run_s, 1)} s`, unit, height - 2.6 * unit, 1.7 * unit, 600);
    const velocity = front?.velocity_mps;
    line(front === null ? twin.scene.title : `Front at chainage ${`${fixed(front.chainage_m, decimalsFor(twin.scene.flow_path?.chainage_m.at(-1) ?? 0, 0))}\u202fm`}` + (typeof velocity === "number" ? `, ${fixed(velocity, 1)} m/s` : ""),
      unit, height - unit, unit);
    const hit = hitUntil(impacts, moment.run_s);
    hit.slice(0, 4).forEach(({ name, at_s }, k) => line(`${name} hit at ${fixed(at_s, 1)} s`, width - unit, height - (1 + 1.25 * k) * unit, (k === 0 ? 1 : 0.85) * unit, k === 0 ? 600 : 400, "right"));
    if (hit.length > 4) line(`and ${hit.length - 4} more`, width - unit, height - 6 * unit, 0.85 * unit, 400, "right");
    if (twin.scene.reconstruction) line("Reconstruction, no survey", unit, 1.6 * unit, 0.8 * unit);
  }
}
