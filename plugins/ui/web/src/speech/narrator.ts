/** Narration of changes under the hand: contact, material, part, limits; and, on a key, of place and surface. */
import type { Events } from "../server/messages";
import type { Page } from "../page";
import { FLAGS, isHeld, isRunning, isTouching, type State } from "../server/protocol";
import type { Scene } from "../surface/scene";
import { on } from "../shortcuts";
import { t } from "./words";
import { shownNumber } from "../words/part_words";
import { decimal, language } from "../words/words";

/** Consecutive states with a flag before it is announced: a single tick at its limit does not matter. */
const LASTING = 6;
const LIMITS = {
  STALE: FLAGS.STALE,
  NOT_FINITE: FLAGS.NOT_FINITE,
  FORCE_LIMITED: FLAGS.FORCE_LIMITED,
  STIFFNESS_LIMITED: FLAGS.STIFFNESS_LIMITED,
  DAMPED: FLAGS.DAMPED,
} as const;

/** Return "door, wood" or "wood, part 3"; the material alone if there is one part. names: of materials, in the page's
 * language. */
export function describePlace(name: string | undefined, called: string, part: number | null, parts: number, names: Record<string, string>): string {
  const text = name === undefined ? t("nameless") : (names[name] ?? name);
  if (called) return name === undefined ? called : `${called}, ${text}`;
  return part === null || parts < 2 ? text : t("part", { name: text, part: shownNumber(part) });
}

export class Narrator {
  private lasting = new Map<number, number>();
  private limits = new Set<number>();
  private described: Events["described"] | null = null;

  constructor(private page: Pick<Page, "hub" | "net" | "scene" | "canvas" | "say" | "forget">) {
    page.hub.on("state", (state) => this.follow(state));
    page.hub.on("shown", (scene) => this.show(scene));
    page.hub.on("described", (message) => {
      this.described = message;
      this.updateDescription();
    });
    on("where", () => page.say(this.where(), { topic: "where", asked: true }));
    on("describe", () => page.say(this.description(), { topic: "describe", asked: true }));
  }

  private follow(state: State): void {
    const { page } = this;
    if (!page.scene || !isRunning(state)) return;
    page.say(this.contact(state, page.scene), { topic: "contact" });
    for (const [name, flag] of Object.entries(LIMITS)) this.announceLimit(name as keyof typeof LIMITS, flag, state);
  }

  private contact(state: State, scene: Scene): string {
    if (!isHeld(state)) return t("noHand");
    if (!isTouching(state)) return t("inTheAir");
    const [x, y] = state.hand;
    return t("touching", { what: this.placeName(scene, x, y) });
  }

  private announceLimit(name: keyof typeof LIMITS, flag: number, state: State): void {
    const count = isTouching(state) && state.flags & flag ? (this.lasting.get(flag) ?? 0) + 1 : 0;
    this.lasting.set(flag, count);
    if (count === LASTING && !this.limits.has(flag)) {
      this.limits.add(flag);
      this.page.say(t(name), { topic: name });
    }
    if (!isTouching(state) && this.limits.delete(flag)) this.page.forget(name); // announce it again at the next touch
  }

  private where(): string {
    const { net, scene } = this.page;
    if (!scene) return t("nothing");
    const state = net.latest;
    if (!state || !isHeld(state)) return t("noHand");
    const [x, y] = state.hand;
    const at = { x: millimetres(Math.abs(x)), y: millimetres(Math.abs(y)) };
    return [
      t(x < 0 ? "left" : "right", at),
      t(y < 0 ? "near" : "far", at),
      t("high", { height: millimetres(scene.height(x, y)) }),
      this.placeName(scene, x, y),
      isTouching(state) ? t("force", { force: decimal(Math.hypot(...state.force), 1) }) : t("inTheAir"),
    ].join(", ");
  }

  /** Return material and part of a place. */
  private placeName(scene: Scene, x: number, y: number): string {
    const names = this.descriptionOf(scene)?.names[language] ?? {};
    return describePlace(scene.material(x, y)?.name, scene.part(x, y), scene.label(x, y), scene.meta.labels, names);
  }

  private descriptionOf(scene: Scene): Events["described"] | null {
    return this.described?.digest === scene.meta.digest ? this.described : null;
  }

  /** Return the program's description if there is one, else the page's own. */
  private description(): string {
    const scene = this.page.scene;
    if (!scene) return t("nothing");
    const says = this.descriptionOf(scene)?.says[language];
    if (says) return says;
    const { name, extent_m, height_m } = scene.meta;
    const heights = t("heights", { low: millimetres(height_m[0]), high: millimetres(height_m[1]) });
    return `${t("size", { name, width: millimetres(extent_m[0]), length: millimetres(extent_m[1]) })} ${heights}`;
  }

  private show(scene: Scene): void {
    this.page.canvas.setAttribute("aria-label", t("surface", { name: scene.meta.name }));
    this.updateDescription();
    this.page.say(t("shown", { name: scene.meta.name }), { topic: "scene" });
  }

  /** Update the description that screen readers find at the surface. */
  private updateDescription(): void {
    document.getElementById("described")!.textContent = `${this.description()} ${t("keys")}`;
  }
}

const millimetres = (metres: number): string => decimal(1000 * metres, Math.abs(metres) < 0.01 ? 1 : 0);
