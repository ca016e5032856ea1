/** Drawing: each state once, and the whole again when the view or what lies over it changed. */
import { figures, measuring } from "../instrumentation";
import type { Page } from "../page";
import { now, type State } from "../server/protocol";

export class Frames {
  private last: State | null = null;
  private echoed = 0;

  constructor(private page: Page) {
    page.hub.on("shown", (scene) => page.overlay.show(scene));
    requestAnimationFrame(() => this.frame());
  }

  private frame(): void {
    requestAnimationFrame(() => this.frame());
    const { net, view, overlay, replayed } = this.page;
    const state = replayed ?? net.latest;
    if (replayed && net.latest) net.drawn(net.latest.seq); // it will not be drawn
    const fresh = state !== this.last;
    if (!view.dirty && !overlay.changed && !fresh) return;
    const first = view.terrain !== null && !figures.firstMs;
    const moved = view.dirty;
    if (moved || overlay.wants(state)) {
      overlay.put(state);
      view.draw(first || (measuring && figures.waits && view.terrain !== null));
      overlay.changed ||= moved; // a camera that flies moves in `draw`: what stays at a place follows it
    }
    const at = now();
    if (first) figures.firstMs = at;
    this.last = state;
    if (fresh && state) this.drawn(state, at);
  }

  /** A state that shows nothing new, as nobody holds the device, counts as drawn. */
  private drawn(state: State, at: number): void {
    const { net, hub } = this.page;
    if (state === net.latest) net.drawn(state.seq);
    hub.tell("drawn", state);
    if (!measuring || state !== net.latest) return;
    figures.drawn.push([state.seq, at - state.sampleMs, state.arrivedMs - state.sampleMs, at]);
    const sentMs = net.sentMs.get(state.tag);
    if (state.tag !== this.echoed && sentMs) {
      this.echoed = state.tag;
      figures.trips.push(at - sentMs);
    }
  }
}
