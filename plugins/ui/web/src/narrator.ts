/** Says what changes under the hand: contact, material, part, limits; and, asked by a key, where it is and what there is. */
import type { Material } from "./messages";
import type { Page } from "./page";
import { FLAGS, STATUS, type State } from "./protocol";
import type { Scene } from "./scene";
import { on } from "./shortcuts";
import { t } from "./words/narrator";
import { decimal, language } from "./words/words";

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

/** "wood, part 3"; the name alone where there is one part. */
export function named(material: Material | null, part: number | null, parts: number): string {
  const name = material?.name ?? t("nameless");
  return part === null || parts < 2 ? name : t("part", { name, part: part + 1 });
}

export class Narrator {
  private lasting = new Map<number, number>();
  private limits = new Set<number>();

  constructor(private page: Page) {
    page.hub.on("state", (state) => this.follow(state));
    page.hub.on("shown", (scene) => this.show(scene));
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
    const what = named(scene.material(x, y), scene.label(x, y), scene.meta.materials.length);
    return t("touching", { what });
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
      named(scene.material(x, y), scene.label(x, y), scene.meta.materials.length),
      touching(state) ? t("force", { force: decimal(Math.hypot(...state.force), 1) }) : t("inTheAir"),
    ].join(", ");
  }

  /** The maker's, where it tells one; else what the page knows itself. */
  private description(): string {
    const scene = this.page.scene;
    if (!scene) return t("nothing");
    const { says, name, extent_m, height_m, materials } = scene.meta;
    if (says?.[language]) return says[language];
    const told = { name, width: millimetres(extent_m[0]), length: millimetres(extent_m[1]) };
    const heights = t("heights", { low: millimetres(height_m[0]), high: millimetres(height_m[1]) });
    const names = [...new Set(materials.map((each) => each.name))].join(", ");
    return `${t("size", told)} ${heights} ${names && t("materials", { count: materials.length, names })}`.trim();
  }

  private show(scene: Scene): void {
    this.page.canvas.setAttribute("aria-label", t("surface", { name: scene.meta.name }));
    document.getElementById("described")!.textContent = `${this.description()} ${t("keys")}`;
    this.page.say(t("shown", { name: scene.meta.name }), { topic: "scene" });
  }
}

const millimetres = (metres: number): string => decimal(1000 * metres, Math.abs(metres) < 0.01 ? 1 : 0);
