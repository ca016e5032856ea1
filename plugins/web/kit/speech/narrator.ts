/** Narration of what happens under the hand: contact, edges, rim, rises, limits; and, on a key, of place and surface. */
import type { Narration, Page } from "../page";
import { recall, remember } from "../preferences";
import { FLAGS, isHeld, isRunning, isTouching, type State } from "../server/protocol";
import type { Scene } from "../surface/scene";
import { on } from "../shortcuts";
import { shownNumber } from "../words/part_words";
import { decimal } from "../words/words";
import { BROWSERS, type Clock } from "./announcer";
import type { CameraAct } from "../view/camera_input";
import { Names } from "./names";
import { partsFromNearToFar } from "./part_facts";
import { type Met, Stroke } from "./stroke";
import { type Contact, millimetres, Telling } from "./telling";
import { Tour } from "./tour";
import { t } from "./words";

/** Milliseconds for which another contact lasts before it counts: a hand that bounces is neither here nor there. */
const SETTLED_MS: Record<Contact, number> = { touching: 100, inTheAir: 300, noHand: 1000 };
/** Consecutive states with a flag before it is announced: a single tick at its limit does not matter. */
const LASTING = 6;
const LIMITS = {
  STALE: FLAGS.STALE,
  NOT_FINITE: FLAGS.NOT_FINITE,
  FORCE_LIMITED: FLAGS.FORCE_LIMITED,
  STIFFNESS_LIMITED: FLAGS.STIFFNESS_LIMITED,
  DAMPED: FLAGS.DAMPED,
} as const;
/** Distance from the middle that counts as none, metres. */
const MIDDLE_M = 0.0005;
const KEPT = "describe moves";

type Heard = Pick<Page, "hub" | "net" | "scene" | "hand" | "view" | "canvas" | "say">;

export class Narrator implements Narration {
  private names: Names;
  private tour: Tour;
  private telling: Telling;
  private stroke: Stroke | null = null;
  private contact: Contact | null = null;
  /** Since when the contact has been another one; null while it is not. */
  private otherMs: number | null = null;
  private lasting = new Map<number, number>();
  private limits = new Set<number>();
  private describing = recall<boolean>(KEPT, false);

  constructor(
    private page: Heard,
    clock: Clock = BROWSERS,
  ) {
    const { hub } = page;
    this.telling = new Telling(clock);
    this.names = new Names(hub, () => this.updateDescription());
    this.tour = new Tour(page, this.names, clock);
    hub.on("state", (state) => this.follow(state));
    hub.on("shown", (scene) => this.show(scene));
    hub.on("led", ({ label }) => this.announceLed(label));
    page.view.acted = (act) => page.say(() => this.viewInWords(act), { topic: "view" });
    on("where", () => page.say(this.where(), { topic: "where", asked: true }));
    on("describe", () => page.say(this.description(), { topic: "describe", asked: true }));
    on("describe moves", () => (this.moves = !this.moves));
    on("tour", () => this.tour.toggle());
    page.canvas.ownerDocument.addEventListener("keydown", ({ key }) => key === "Escape" && this.tour.end(), { capture: true });
  }

  get moves(): boolean {
    return this.describing;
  }

  set moves(on: boolean) {
    this.describing = on;
    this.contact = null; // begins again where the hand is
    remember(KEPT, on);
    this.page.hub.tell("describing", { on });
    this.page.say(t(on ? "movesOn" : "movesOff"), { topic: "moves", asked: true });
  }

  get touring(): boolean {
    return this.tour.on;
  }

  toggleTour(): void {
    this.tour.toggle();
  }

  private follow(state: State): void {
    const { page } = this;
    if (!page.scene || !isRunning(state)) return;
    this.followContact(state, page.scene);
    if (this.tour.on) this.telling.clear();
    if (!this.telling.isEmpty) page.say(() => this.telling.take(), { topic: "contact" });
    for (const [name, flag] of Object.entries(LIMITS)) this.announceLimit(name as keyof typeof LIMITS, flag, state);
  }

  private followContact(state: State, scene: Scene): void {
    const [x, y] = state.hand;
    const contact = !isHeld(state) ? "noHand" : isTouching(state) ? "touching" : "inTheAir";
    if (contact === this.contact) this.otherMs = null;
    else {
      this.otherMs ??= state.sampleMs;
      const lasts = state.sampleMs - this.otherMs;
      if (this.contact === null || lasts >= SETTLED_MS[contact]) return this.changeContact(contact, scene, x, y);
    }
    if (this.contact === "touching" || (this.contact === "inTheAir" && this.describing))
      for (const met of this.stroke!.to([x, y])) this.tell(met, scene);
  }

  private changeContact(contact: Contact, scene: Scene, x: number, y: number): void {
    [this.contact, this.otherMs] = [contact, null];
    this.telling.add({ kind: "contact", contact, what: this.names.ofPlace(scene, x, y) });
    this.stroke ??= new Stroke(scene);
    this.stroke.begin([x, y]);
  }

  private tell(met: Met, scene: Scene): void {
    if (met.kind === "slope" && !this.describing && scene.meta.labels > 1) return;
    if (met.kind === "edge") this.telling.add({ ...met, what: this.names.ofPlace(scene, ...met.at) });
    else this.telling.add(met);
  }

  private announceLimit(name: keyof typeof LIMITS, flag: number, state: State): void {
    const count = isTouching(state) && state.flags & flag ? (this.lasting.get(flag) ?? 0) + 1 : 0;
    this.lasting.set(flag, count);
    if (!isTouching(state)) this.limits.delete(flag); // announce it again at the next touch
    if (count >= LASTING && !this.limits.has(flag)) this.page.say(() => this.limitInWords(name, flag), { topic: name });
  }

  /** Return a limit in words; nothing if it has ended meanwhile. */
  private limitInWords(name: keyof typeof LIMITS, flag: number): string {
    const state = this.page.net.latest;
    if (!this.lasting.get(flag) || this.limits.has(flag) || !state) return "";
    this.limits.add(flag);
    return t(name, { force: decimal(Math.hypot(...state.force), 1) });
  }

  private viewInWords(act: CameraAct): string {
    const { view, canvas } = this.page;
    return t(act, { width: millimetres(view.pixel_m() * canvas.clientWidth) });
  }

  private announceLed(label: number | null): void {
    const { scene } = this.page;
    if (!scene) return;
    const options = { topic: "led", asked: true };
    if (label === null) return this.page.say(this.placeInWords(scene, 0, 0), options);
    const part = partsFromNearToFar(scene).find((each) => each.label === label);
    if (part) this.page.say(t("partOf", { number: shownNumber(label), of: scene.meta.labels, what: this.names.ofPart(scene, part) }), options);
  }

  private where(): string {
    const { net, scene } = this.page;
    if (!scene) return t("nothing");
    const state = net.latest;
    if (!state || !isHeld(state)) return t("noHand");
    const [x, y] = state.hand;
    const force = isTouching(state) ? t("force", { force: decimal(Math.hypot(...state.force), 1) }) : t("airNow");
    return `${this.placeInWords(scene, x, y)}; ${force}`;
  }

  /** Return "In the middle; 1.1 mm high; brick". */
  private placeInWords(scene: Scene, x: number, y: number): string {
    const [across, along] = [Math.abs(x), Math.abs(y)];
    const inMiddle = t(along < MIDDLE_M ? "middle" : "middleLine");
    return [
      across < MIDDLE_M ? inMiddle : t(x < 0 ? "left" : "right", { x: millimetres(across) }),
      ...(along < MIDDLE_M ? [] : [t(y < 0 ? "near" : "far", { y: millimetres(along) })]),
      t("high", { height: millimetres(scene.height(x, y)) }),
      this.names.ofPlace(scene, x, y),
    ].join("; ");
  }

  /** Return the program's description if there is one, else the page's own. */
  private description(): string {
    const scene = this.page.scene;
    if (!scene) return t("nothing");
    const says = this.names.description(scene);
    if (says) return says;
    const { name, extent_m, height_m } = scene.meta;
    const heights = t("heights", { low: millimetres(height_m[0]), high: millimetres(height_m[1]) });
    return `${t("size", { name, width: millimetres(extent_m[0]), length: millimetres(extent_m[1]) })} ${heights}`;
  }

  private show(scene: Scene): void {
    [this.stroke, this.contact] = [null, null];
    this.telling.clear();
    this.page.canvas.setAttribute("aria-label", t("surface", { name: scene.meta.name }));
    this.updateDescription();
    this.page.say(t("shown", { name: scene.meta.name }), { topic: "scene" });
  }

  /** Update the description that screen readers find at the surface. */
  private updateDescription(): void {
    document.getElementById("described")!.textContent = `${this.description()} ${t("keys")}`;
  }
}
