/** Drawing: each state once, and the whole again when the view changed. */
import type { Page } from "./page";
import { now, type State } from "./protocol";

/** What `tests` and `benchmarks` read: window.figures. */
export const figures = {
  /** seq, ms from tick to drawn, ms from tick to arrived, when drawn. */
  drawn: [] as number[][],
  /** ms from a pointer that was sent until its force was drawn. */
  trips: [] as number[],
  picks: [] as number[],
  firstMs: 0,
};

export class Frames {
  private seq = -1;
  private echoed = 0;

  constructor(
    private page: Page,
    private measuring: boolean,
  ) {
    if (measuring) Object.assign(window, { figures });
    requestAnimationFrame(() => this.frame());
  }

  private frame(): void {
    requestAnimationFrame(() => this.frame());
    const { net, view } = this.page;
    const state = net.latest;
    const fresh = state !== null && state.seq !== this.seq;
    if (!view.dirty && !fresh) return;
    const first = view.terrain !== null && !figures.firstMs;
    view.draw(this.measuring || first);
    const at = now();
    if (first) figures.firstMs = at;
    if (fresh) this.drawn(state, at);
  }

  private drawn(state: State, at: number): void {
    const { net, hub } = this.page;
    this.seq = state.seq;
    net.drawn(state.seq);
    hub.tell("drawn", state);
    if (!this.measuring) return;
    figures.drawn.push([state.seq, at - state.sampleMs, state.arrivedMs - state.sampleMs, at]);
    const sentMs = net.sentMs.get(state.tag);
    if (state.tag !== this.echoed && sentMs) {
      this.echoed = state.tag;
      figures.trips.push(at - sentMs);
    }
  }
}
