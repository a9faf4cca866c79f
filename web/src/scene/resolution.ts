// How many pixels are drawn: fewer while the picture moves and the graphics cannot keep up, all of them once it stands still.

const slow_ms = 45;
const fast_ms = 20;
const lowest = 0.35;
/** After so long without a picture the view stands still. */
const still_ms = 250;

export class Resolution {
  /** Share of the screen's pixels along an edge that moving pictures have. */
  share = 1;
  private drawn_ms: number | null = null;
  private last_ms = -Infinity;
  private mean_ms = 0;
  private pictures = 0;

  /** The browser is ready for a picture at `now_ms`: what it took for the one before, if there was one, tells how fast graphics are. */
  tick(now_ms: number): void {
    if (this.drawn_ms === null) return;
    const took = now_ms - this.drawn_ms;
    this.drawn_ms = null;
    this.mean_ms = this.pictures === 0 ? took : this.mean_ms + 0.2 * (took - this.mean_ms);
    ++this.pictures;
    // A lower share is tried soon; a higher one only after a good while, lest it goes up and down.
    if (this.mean_ms > slow_ms && this.pictures >= 6) {
      this.share = Math.max(lowest, this.share * 0.75);
      this.pictures = 0;
    } else if (this.mean_ms < fast_ms && this.pictures >= 90) {
      this.share = Math.min(1, this.share / 0.75);
      this.pictures = 0;
    }
  }
  /** A picture of what moves is drawn at `now_ms`. */
  drew(now_ms: number): void {
    this.drawn_ms = this.last_ms = now_ms;
  }
  standsStill(now_ms: number): boolean {
    return now_ms - this.last_ms > still_ms;
  }
}
