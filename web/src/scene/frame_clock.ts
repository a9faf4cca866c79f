// Selects the two displayed frames and the fraction between them: one frame interval behind the newest.
import type { Frame } from "../protocol/frame";

/** Frames farther apart in simulated time are not interpolated: particles would cut corners. */
const longestGap_s = 1.5;

export class FrameClock {
  previous: Frame | null = null;
  next: Frame | null = null;
  /** Share of the way from the previous frame to the next that is shown, whatever the time; null: by time. */
  hold: number | null = null;
  private arrived_ms = 0;
  private interval_ms = 33;

  /** gone: is told which frames are displayed no more; what follows in the same task may still read them. */
  constructor(private readonly gone: (frame: Frame) => void = () => {}) {}

  /** True when the two frames follow each other and may be interpolated. */
  push(frame: Frame, now_ms: number): boolean {
    const { previous: oldest, next: before } = this;
    const gap = before === null ? -1 : frame.time_s - before.time_s;
    const joins = before !== null && gap > 0 && gap <= longestGap_s && frame.stride === before.stride;
    if (joins) {
      const waited = Math.min(400, Math.max(8, now_ms - this.arrived_ms));
      this.interval_ms += 0.2 * (waited - this.interval_ms);
    }
    this.previous = joins ? before : frame;
    this.next = frame;
    this.arrived_ms = now_ms;
    if (oldest && oldest !== before && oldest !== frame) this.gone(oldest);
    if (before && !joins && before !== frame) this.gone(before);
    return joins;
  }
  /** 0: the previous frame, 1: the next one. */
  fraction(now_ms: number): number {
    if (this.previous === this.next) return 1;
    if (this.hold !== null) return this.hold;
    return Math.min(1, Math.max(0, (now_ms - this.arrived_ms) / this.interval_ms));
  }
  /** Displayed simulated time. */
  time_s(now_ms: number): number | null {
    if (this.previous === null || this.next === null) return null;
    return this.previous.time_s + (this.next.time_s - this.previous.time_s) * this.fraction(now_ms);
  }
  moving(now_ms: number): boolean {
    return this.hold === null && this.fraction(now_ms) < 1;
  }
}
