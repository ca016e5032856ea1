/** A guided tour of the parts of a surface, from near to far: each is announced, and the hand is led there. */
import type { Page } from "../page";
import type { Scene } from "../surface/scene";
import { type Clock, LETTER_MS } from "./announcer";
import type { Names } from "./names";
import { type PartFacts, partsFromNearToFar } from "./part_facts";
import { t } from "./words";

/** Milliseconds at a part, after its sentence: time to feel it. */
export const STAY_MS = 3000;

export class Tour {
  private parts: PartFacts[] = [];
  private at = 0;
  /** The present run of the tour; null while there is none. */
  private run: object | null = null;
  private beacon = false;

  constructor(
    private page: Pick<Page, "hub" | "net" | "scene" | "hand" | "say">,
    private names: Names,
    private clock: Pick<Clock, "after">,
  ) {
    page.hub.on("shown", () => this.end());
    page.hub.on("loop", ({ running }) => running || this.end());
  }

  get on(): boolean {
    return this.run !== null;
  }

  /** Begin the tour, or end it. */
  toggle(): void {
    if (this.on) return this.end();
    const { scene } = this.page;
    this.parts = scene ? partsFromNearToFar(scene) : [];
    if (this.parts.length < 2) return this.page.say(t(scene ? "noParts" : "nothing"), { topic: "tour", asked: true });
    this.run = {};
    this.at = 0;
    this.notify();
    this.say(t("tourBegins", { count: this.parts.length }), 0, () => this.visit(scene!));
  }

  /** End the tour, if there is one, and let the hand go. */
  end(text = t("tourEnded")): void {
    if (!this.on) return;
    this.run = null;
    if (this.beacon) void this.page.net.ask("beacon", { part: null }).catch(() => undefined);
    this.beacon = false;
    this.notify();
    this.page.say(text, { topic: "tour" });
  }

  private visit(scene: Scene): void {
    const part = this.parts[this.at++];
    if (!part) return this.end(t("tourDone"));
    this.lead(part);
    this.say(`${this.names.ofPart(scene, part)}.`, STAY_MS, () => this.visit(scene));
  }

  /** Lead the hand to a part: a motor's by a beacon, this page's own by itself. */
  private lead({ label, at }: PartFacts): void {
    const loop = this.page.hub.last("loop");
    if (!loop?.running || loop.own_hand !== false) return this.page.hand?.leadTo(...at);
    this.beacon = true;
    void this.page.net.ask("beacon", { part: label }).catch(() => (this.beacon = false)); // a device without a motor
  }

  private say(text: string, stayMs: number, then: () => void): void {
    const run = this.run;
    this.page.say(text, { topic: "tour", asked: true });
    this.clock.after(LETTER_MS * text.length + stayMs + 500, () => this.run === run && then());
  }

  private notify(): void {
    this.page.hub.tell("tour", { on: this.on });
  }
}
