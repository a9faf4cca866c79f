// Drawing resolution: reduced while the picture moves and the graphics cannot keep up, full once it is still.

const slow_ms = 45;
const fast_ms = 20;
const lowest = 0.35;
/** After this time without a picture the view counts as still. */
const still_ms = 250;

export class Resolution {
  /** Resolution of moving pictures relative to the screen, along an edge. */
  share = 1;
  private drawn_ms: number | null = null;
  private last_ms = -Infinity;
  private mean_ms = 0;
  private pictures = 0;

  /** Of moving pictures: 2 all, 1 and 0 less. */
  get detail(): number {
    return this.share === 1 ? 2 : this.share > 0.5 ? 1 : 0;
  }
  /**
   * The browser is ready for a picture at `now_ms`: the time for the previous one, if any, measures the speed of the
   * graphics.
   */
  tick(now_ms: number): void {
    if (this.drawn_ms === null) return;
    const took = now_ms - this.drawn_ms;
    this.drawn_ms = null;
    this.mean_ms = this.pictures === 0 ? took : this.mean_ms + 0.2 * (took - this.mean_ms);
    ++this.pictures;
    // A lower share is tried soon; a higher one only after a longer time, so that it does not oscillate.
    if (this.mean_ms > slow_ms && this.pictures >= 6) {
      this.share = Math.max(lowest, this.share * 0.75);
      this.pictures = 0;
    } else if (this.mean_ms < fast_ms && this.pictures >= 90) {
      this.share = Math.min(1, this.share / 0.75);
      this.pictures = 0;
    }
  }
  /** A moving picture is drawn at `now_ms`. */
  drew(now_ms: number): void {
    this.drawn_ms = this.last_ms = now_ms;
  }
  standsStill(now_ms: number): boolean {
    return now_ms - this.last_ms > still_ms;
  }
}
