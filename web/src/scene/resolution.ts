// How many pixels are drawn: fewer while the picture moves and the graphics cannot keep up, all of them once it stands still.

const slow_ms = 45;
const fast_ms = 20;
const lowest = 0.35;
/** After so long without a picture the view stands still. */
export const still_ms = 250;

export class Resolution {
  /** Share of the screen's pixels along an edge that moving pictures have. */
  share = 1;
  private last_ms = -Infinity;
  private mean_ms = 0;
  private pictures = 0;

  /** A picture was drawn at `now_ms`, and whatever moved still moves. True: `share` has changed. */
  drew(now_ms: number): boolean {
    const gap = now_ms - this.last_ms;
    this.last_ms = now_ms;
    if (gap > 4 * still_ms) {
      // The first picture after a pause tells nothing about speed.
      this.pictures = 0;
      return false;
    }
    this.mean_ms = this.pictures === 0 ? gap : this.mean_ms + 0.2 * (gap - this.mean_ms);
    ++this.pictures;
    const before = this.share;
    // A lower share is tried soon; a higher one only after a good while, lest it goes up and down.
    if (this.mean_ms > slow_ms && this.pictures >= 6) {
      this.share = Math.max(lowest, this.share * 0.75);
      this.pictures = 0;
    } else if (this.mean_ms < fast_ms && this.pictures >= 90) {
      this.share = Math.min(1, this.share / 0.75);
      this.pictures = 0;
    }
    return this.share !== before;
  }
  standsStill(now_ms: number): boolean {
    return now_ms - this.last_ms > still_ms;
  }
}
