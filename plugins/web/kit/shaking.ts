/** Borders as clicks, and textures as a rumble: of the phone, of game pads, and in sound. */
import type { Page } from "./page";
import { recall, remember } from "./preferences";
import { isTouching, type State } from "./server/protocol";
import { stroke as soundOf } from "./sound/sonification";
import type { Sound } from "./sound/sound";
import type { Scene } from "./surface/scene";
import { Stroke } from "./speech/stroke";

/** Durations of the pulses at a touch and at a border, milliseconds. */
const TOUCH_MS = 10;
const BORDER_MS = 22;
/** Pulses of a texture: their interval, and the longest and shortest, milliseconds. */
const TEXTURE = { everyMs: 45, leastMs: 4, mostMs: 25 };
/** Level of a texture's sound from which it shakes. */
const LEAST = 0.01;
const KEPT = "shakes";

export class Shaking {
  private walk: Stroke | null = null;
  private touched = false;
  private pulsedMs = -Infinity;

  constructor(
    private page: Pick<Page, "hub" | "scene">,
    private sound: Pick<Sound, "click">,
  ) {
    page.hub.on("shown", (scene) => (this.walk = new Stroke(scene)));
    page.hub.on("state", (state) => this.follow(state));
  }

  get on(): boolean {
    return recall(KEPT, true);
  }

  set on(on: boolean) {
    remember(KEPT, on);
  }

  private follow(state: State): void {
    const { walk, touched } = this;
    const { scene } = this.page;
    if (!scene || !walk) return;
    const [x, y] = state.hand;
    this.touched = isTouching(state);
    if (!this.touched) return;
    if (!touched) {
      walk.begin([x, y]);
      return this.pulse(TOUCH_MS, 0.6);
    }
    const borders = walk.to([x, y]).filter(({ kind }) => kind === "edge" || kind === "rim");
    if (borders.length) this.click();
    else this.texture(state, scene);
  }

  private click(): void {
    this.sound.click();
    this.pulse(BORDER_MS, 1);
  }

  private texture(state: State, scene: Scene): void {
    if (performance.now() - this.pulsedMs < TEXTURE.everyMs) return;
    const { noise, tone } = soundOf(scene.material(state.hand[0], state.hand[1]), state.force, state.velocity);
    const level = Math.min(1, noise.level + tone.level);
    if (level < LEAST) return;
    this.pulse(TEXTURE.leastMs + level * (TEXTURE.mostMs - TEXTURE.leastMs), level);
  }

  private pulse(ms: number, strength: number): void {
    this.pulsedMs = performance.now();
    if (!this.on) return;
    // browsers complain of a vibration before the first tap
    if (navigator.userActivation?.hasBeenActive) navigator.vibrate?.(Math.round(ms));
    const effect = { duration: Math.max(2 * ms, 20), strongMagnitude: strength, weakMagnitude: strength };
    for (const pad of navigator.getGamepads()) void pad?.vibrationActuator?.playEffect("dual-rumble", effect);
  }
}
