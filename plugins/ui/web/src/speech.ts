/** Speech aloud: what the live regions say, in the page's language, where the browser has a voice for it. */
import type { Said } from "./announcer";
import type { Hub } from "./hub";
import { recall, remember } from "./remembered";
import { language } from "./words/words";

export const RATES = { least: 0.5, most: 3, step: 0.25 };

export class Speech {
  private on = recall<boolean>("aloud", false);

  constructor(private hub: Hub) {
    window.speechSynthesis?.addEventListener("voiceschanged", () => this.tell()); // they come late
  }

  /** The voice that speaks: of this machine before one that needs a network. None: null. */
  get voice(): SpeechSynthesisVoice | null {
    const voices = window.speechSynthesis?.getVoices().filter((each) => each.lang.toLowerCase().startsWith(language)) ?? [];
    return voices.find((each) => each.localService) ?? voices[0] ?? null;
  }

  get aloud(): boolean {
    return this.on && this.voice !== null;
  }

  set aloud(on: boolean) {
    this.on = on;
    remember("aloud", on);
    if (!on) window.speechSynthesis?.cancel();
    this.tell();
  }

  get rate(): number {
    return recall("rate", 1);
  }

  set rate(rate: number) {
    remember("rate", Math.min(RATES.most, Math.max(RATES.least, rate)));
  }

  /** What it still spoke is stale, and ends. */
  speak({ text }: Said): void {
    const voice = this.voice;
    if (!this.on || !voice) return;
    const words = new SpeechSynthesisUtterance(text);
    words.voice = voice;
    words.lang = voice.lang;
    words.rate = this.rate;
    speechSynthesis.cancel();
    speechSynthesis.speak(words);
  }

  private tell(): void {
    this.hub.tell("aloud", { on: this.aloud, voice: this.voice?.name ?? "" });
  }
}
