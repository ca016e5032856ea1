/** The hand that this page moves: where it is, whether it presses, and that it lives. What moves it is in hands/. */
import { keys } from "./hands/keys";
import { mouse } from "./hands/mouse";
import type { Page } from "./page";
import type { Vec } from "./protocol";

/** So often the server hears that the page lives: it lets go after 100 ms of silence. */
const ALIVE_MS = 30;
const HOVER_M = 0.002;
const PRESS_M = { first: 0.0015, least: 0.0002, most: 0.006 };

export class Hand {
  /** How deep it presses into the surface. */
  pressM = PRESS_M.first;
  /** The place on the surface under the hand; null while nothing holds it. */
  at: Vec | null = null;
  down = false;

  constructor(readonly page: Page) {
    mouse(this);
    keys(this);
    setInterval(() => this.send(), ALIVE_MS);
    document.addEventListener("visibilitychange", () => document.hidden && this.release());
    window.addEventListener("pagehide", () => this.release());
    window.addEventListener("blur", () => this.release());
  }

  /** Over this place of the surface, pressing or not. */
  move(at: Vec, down: boolean): void {
    this.at = at;
    this.down = down;
    this.send();
  }

  press(byM: number): void {
    this.pressM = Math.min(PRESS_M.most, Math.max(PRESS_M.least, this.pressM + byM));
    this.send();
  }

  /** Let go: nothing is felt. */
  release(): void {
    if (!this.at) return;
    this.at = null;
    this.down = false;
    this.page.net.release();
  }

  private send(): void {
    if (!this.at) return;
    const [x, y, z] = this.at;
    this.page.net.point([x, y, z + (this.down ? -this.pressM : HOVER_M)], this.down ? 1 : 0);
  }
}
