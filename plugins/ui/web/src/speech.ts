/** Changes in words: in a polite live region for who has a screen reader, aloud where that is asked for. */
import type { State } from "./protocol";
import type { Scene } from "./scene";

export class Speech {
  aloud = false;
  private said = "";
  private saidMs = 0;
  constructor(private region: HTMLElement) {}
  feel(s: State, scene: Scene) {
    if (performance.now() - this.saidMs < 1000) return;
    const touching = (s.flags & 1) === 1,
      on = touching ? (scene.material(s.hand[0], s.hand[1])?.name ?? "surface") : "";
    const now = touching ? `touching ${on}` : s.hand[2] > 0.5 ? "no hand" : "in the air";
    if (now !== this.said) {
      this.said = now;
      this.say(now);
    }
  }
  where(s: State, scene: Scene) {
    const [x, y] = s.hand.map((part) => Math.round(1000 * part)),
      f = Math.hypot(...s.force);
    this.say(
      `${Math.abs(x)} millimetres ${x < 0 ? "left" : "right"}, ${Math.abs(y)} ${y < 0 ? "near" : "far"}, ${scene.material(s.hand[0], s.hand[1])?.name ?? "no material"}, ${f.toFixed(1)} newtons`,
    );
  }
  say(text: string) {
    this.saidMs = performance.now();
    this.region.textContent = text;
    if (this.aloud && "speechSynthesis" in window) {
      speechSynthesis.cancel();
      speechSynthesis.speak(new SpeechSynthesisUtterance(text));
    }
  }
}
