/** Says what changes under the hand: contact, material, part, limits; and, asked by a key, where it is and what there is. */
import type { Events } from "../server/messages";
import type { Page } from "../page";
import { FLAGS, STATUS, type State } from "../server/protocol";
import type { Scene } from "../surface/scene";
import { on } from "../shortcuts";
import { t } from "./words";
import { decimal, language } from "../words/words";

/** A hand as high as this is none: nobody holds it. */
const GONE_M = 0.5;
/** States in a row that must have a flag, before it is said: one tick at its limit is nothing to know of. */
const LASTING = 6;
const LIMITS = {
  STALE: FLAGS.STALE,
  NOT_FINITE: FLAGS.NOT_FINITE,
  FORCE_LIMITED: FLAGS.FORCE_LIMITED,
  STIFFNESS_LIMITED: FLAGS.STIFFNESS_LIMITED,
  DAMPED: FLAGS.DAMPED,
} as const;

export const running = (state: State): boolean => (state.status & STATUS.RUNNING) !== 0;
export const held = (state: State): boolean => running(state) && state.hand[2] < GONE_M;
export const touching = (state: State): boolean => held(state) && (state.flags & FLAGS.TOUCHING) !== 0;

/** "door, wood", "wood, part 3"; the material alone where there is one part. names: of materials, in the page's language. */
export function named(name: string | undefined, called: string, part: number | null, parts: number, names: Record<string, string>): string {
  const said = name === undefined ? t("nameless") : (names[name] ?? name);
  if (called) return name === undefined ? called : `${called}, ${said}`;
  return part === null || parts < 2 ? said : t("part", { name: said, part });
}

export class Narrator {
  private lasting = new Map<number, number>();
  private limits = new Set<number>();
  private described: Events["described"] | null = null;

  constructor(private page: Page) {
    page.hub.on("state", (state) => this.follow(state));
    page.hub.on("shown", (scene) => this.show(scene));
    page.hub.on("described", (said) => {
      this.described = said;
      this.tell();
    });
    on("where", () => page.say(this.where(), { topic: "where", asked: true }));
    on("describe", () => page.say(this.description(), { topic: "describe", asked: true }));
  }

  private follow(state: State): void {
    const { page } = this;
    if (!page.scene || !running(state)) return;
    page.say(this.contact(state, page.scene), { topic: "contact" });
    for (const [name, flag] of Object.entries(LIMITS)) this.limit(name as keyof typeof LIMITS, flag, state);
  }

  private contact(state: State, scene: Scene): string {
    if (!held(state)) return t("noHand");
    if (!touching(state)) return t("inTheAir");
    const [x, y] = state.hand;
    return t("touching", { what: this.under(scene, x, y) });
  }

  private limit(name: keyof typeof LIMITS, flag: number, state: State): void {
    const count = touching(state) && state.flags & flag ? (this.lasting.get(flag) ?? 0) + 1 : 0;
    this.lasting.set(flag, count);
    if (count === LASTING && !this.limits.has(flag)) {
      this.limits.add(flag);
      this.page.say(t(name), { topic: name });
    }
    if (!touching(state) && this.limits.delete(flag)) this.page.forget(name); // said again at the next touch
  }

  private where(): string {
    const { net, scene } = this.page;
    if (!scene) return t("nothing");
    const state = net.latest;
    if (!state || !held(state)) return t("noHand");
    const [x, y] = state.hand;
    const at = { x: millimetres(Math.abs(x)), y: millimetres(Math.abs(y)) };
    return [
      t(x < 0 ? "left" : "right", at),
      t(y < 0 ? "near" : "far", at),
      t("high", { height: millimetres(scene.height(x, y)) }),
      this.under(scene, x, y),
      touching(state) ? t("force", { force: decimal(Math.hypot(...state.force), 1) }) : t("inTheAir"),
    ].join(", ");
  }

  /** The material and the part at a place. */
  private under(scene: Scene, x: number, y: number): string {
    const names = this.known(scene)?.names[language] ?? {};
    return named(scene.material(x, y)?.name, scene.part(x, y), scene.label(x, y), scene.meta.labels, names);
  }

  private known(scene: Scene): Events["described"] | null {
    return this.described?.digest === scene.meta.digest ? this.described : null;
  }

  /** The maker's, when it has told it; until then what the page knows itself. */
  private description(): string {
    const scene = this.page.scene;
    if (!scene) return t("nothing");
    const says = this.known(scene)?.says[language];
    if (says) return says;
    const { name, extent_m, height_m } = scene.meta;
    const heights = t("heights", { low: millimetres(height_m[0]), high: millimetres(height_m[1]) });
    return `${t("size", { name, width: millimetres(extent_m[0]), length: millimetres(extent_m[1]) })} ${heights}`;
  }

  private show(scene: Scene): void {
    this.page.canvas.setAttribute("aria-label", t("surface", { name: scene.meta.name }));
    this.tell();
    this.page.say(t("shown", { name: scene.meta.name }), { topic: "scene" });
  }

  /** What a screen reader finds at the surface. */
  private tell(): void {
    document.getElementById("described")!.textContent = `${this.description()} ${t("keys")}`;
  }
}

const millimetres = (metres: number): string => decimal(1000 * metres, Math.abs(metres) < 0.01 ? 1 : 0);
