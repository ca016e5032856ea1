/** The frame loop: draws each state once, and the whole when view or overlay changed. */
import { figures, measuring } from "../instrumentation";
import type { Page } from "../page";
import { now, type State } from "../server/protocol";

export class Frames {
  private last: State | null = null;
  private echoed = 0;

  constructor(private page: Pick<Page, "hub" | "net" | "view" | "overlay" | "replayed">) {
    page.hub.on("shown", (scene) => page.overlay.show(scene));
    requestAnimationFrame(() => this.frame());
  }

  private frame(): void {
    requestAnimationFrame(() => this.frame());
    const { net, view, overlay, replayed } = this.page;
    const state = replayed ?? net.latest;
    if (replayed && net.latest) net.drawn(net.latest.seq); // the loop's state is not drawn
    const fresh = state !== this.last;
    if (!view.dirty && !overlay.changed && !fresh) return;
    const first = view.terrain !== null && !figures.firstMs;
    const moved = view.dirty;
    if (moved || overlay.wants(state)) {
      overlay.put(state);
      view.draw(first || (measuring && figures.waits && view.terrain !== null));
      overlay.changed ||= moved; // a flying camera moves in `draw`: pinned elements follow
    }
    const at = now();
    if (first) figures.firstMs = at;
    this.last = state;
    if (fresh && state) this.acknowledge(state, at);
  }

  /** Acknowledge a state; one that shows nothing new counts as drawn. */
  private acknowledge(state: State, at: number): void {
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
