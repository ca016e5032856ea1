/** Player of a recording: its ticks replace the loop's in drawing and announcements. */
import type { Page } from "kit/page";
import type { Ticks } from "./ticks";

export class Player {
  playing = false;
  speed = 1;
  seconds = 0;
  private ticks: Ticks | null = null;
  private beforeMs = 0;

  /** moved: called when the position changes, or it stops. */
  constructor(
    private page: Pick<Page, "replayed">,
    private moved: () => void,
  ) {}

  get length(): number {
    return this.ticks?.seconds ?? 0;
  }

  load(ticks: Ticks): void {
    this.ticks = ticks;
    this.playing = false;
    this.seek(0);
  }

  /** Return to the live state. */
  close(): void {
    this.ticks = null;
    this.playing = false;
    this.page.replayed = null;
    this.moved();
  }

  seek(seconds: number): void {
    if (!this.ticks?.count) return;
    this.seconds = Math.max(0, Math.min(this.length, seconds));
    this.page.replayed = this.ticks.state(this.ticks.at(this.ticks.time(0) + this.seconds));
    this.moved();
  }

  toggle(): void {
    if (!this.ticks?.count) return;
    this.playing = !this.playing;
    if (this.playing && this.seconds >= this.length) this.seconds = 0;
    this.beforeMs = performance.now();
    if (this.playing) requestAnimationFrame(() => this.step());
    this.moved();
  }

  private step(): void {
    if (!this.playing) return;
    const now = performance.now();
    const to = this.seconds + (this.speed * (now - this.beforeMs)) / 1000;
    this.beforeMs = now;
    if (to >= this.length) this.playing = false;
    this.seek(to);
    if (this.playing) requestAnimationFrame(() => this.step());
  }
}
