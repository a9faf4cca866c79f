// The recording: shows its frames by time, plays them, and returns to live. Two scenarios are shown at the same time.
import type { ScenarioName } from "../protocol/frame";
import type { Twin } from "./twin";

const playbackRate_hz = 12;
/** Flag of a frame. */
const tooCompressed = 2;

export class Playback {
  private wanted: number | null = null;
  private busy = false;
  private timer: number | undefined;
  private begun_ms = 0;
  private from_s = 0;

  constructor(private readonly twin: Twin) {
    twin.replay_s.watch((time) => {
      if (time === null) this.stop();
    });
  }

  seek(time_s: number): void {
    this.stop();
    this.show(time_s);
  }
  toggle(): void {
    if (this.twin.playing.value) this.stop();
    else this.play();
  }
  live(): void {
    this.stop();
    if (this.twin.replay_s.value === null) return;
    this.twin.replay_s.value = null;
    // The server answers a new request for frames with the current ones.
    this.twin.askForFrames();
  }

  private get last_s(): number {
    return this.twin.now.state.value?.recording.last_s ?? 0;
  }
  private play(): void {
    const at = this.twin.replay_s.value;
    this.from_s = at === null || at >= this.last_s - 0.05 ? 0 : at;
    this.begun_ms = performance.now();
    this.twin.playing.value = true;
    this.timer = window.setInterval(() => {
      const time = this.from_s + (performance.now() - this.begun_ms) / 1000;
      this.show(Math.min(time, this.last_s));
      if (time >= this.last_s) this.stop();
    }, 1000 / playbackRate_hz);
  }
  private stop(): void {
    clearInterval(this.timer);
    this.twin.playing.value = false;
  }
  private show(time_s: number): void {
    const within = Math.min(Math.max(0, time_s), this.last_s);
    this.twin.replay_s.value = within;
    this.wanted = within;
    if (!this.busy) void this.fetch();
  }
  /** Of the times requested while a frame is being fetched, only the last one is fetched. */
  private async fetch(): Promise<void> {
    this.busy = true;
    while (this.wanted !== null) {
      const time = this.wanted;
      this.wanted = null;
      const fine = await this.twin.attempt(async () => {
        const { api } = this.twin;
        await Promise.all(this.twin.shown.value.map(async (name: ScenarioName) => {
          const [frame, readings] = await Promise.all([api.frame(name, time), this.twin.readings(name, time)]);
          if (this.twin.replay_s.value === null) return;
          this.twin.showFrame(frame);
          this.twin.showReadings(name, readings);
          if (name === this.twin.edited.value) this.twin.replayOvercompressed.value = (frame.flags & tooCompressed) !== 0;
        }));
      });
      if (!fine) this.stop();
    }
    this.busy = false;
  }
}
