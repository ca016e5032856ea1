/** Speech aloud: what the live regions say, in the page's language, where the browser has a voice for it. */
import type { Said } from "./announcer";
import type { Hub } from "../hub";
import { recall, remember } from "../preferences";
import { language } from "../words/words";

export const RATES = { least: 0.5, most: 3, step: 0.25 };

export class Speech {
  private on = recall<boolean>("aloud", false);
  /** What is being read, until its last line was spoken or something else is. */
  private reads: object | null = null;

  constructor(private hub: Hub) {
    window.speechSynthesis?.addEventListener("voiceschanged", () => this.tell()); // they come late
  }

  /** The voice that speaks: of this machine before one that needs a network. None: null. */
  get voice(): SpeechSynthesisVoice | null {
    return this.voiceOf(language);
  }

  private voiceOf(tongue: string): SpeechSynthesisVoice | null {
    const voices = window.speechSynthesis?.getVoices().filter((each) => each.lang.toLowerCase().startsWith(tongue)) ?? [];
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
    speechSynthesis.cancel();
    speechSynthesis.speak(this.utterance(text, voice));
  }

  /** Read lines in a language, whether or not speech is switched on; false where there is no voice for it.
   * ended: once nothing of it is spoken any more. */
  read(lines: string[], tongue: string, ended: () => void): boolean {
    const voice = this.voiceOf(tongue);
    if (!voice || !lines.length) return false;
    speechSynthesis.cancel();
    const reads = (this.reads = {});
    const all = lines.map((line) => this.utterance(line, voice));
    const end = (): void => {
      if (this.reads === reads) this.reads = null;
      ended();
    };
    all.at(-1)!.onend = end;
    for (const each of all) each.onerror = end; // something else was spoken
    for (const each of all) speechSynthesis.speak(each);
    return true;
  }

  get reading(): boolean {
    return this.reads !== null;
  }

  /** Read no further. */
  hush(): void {
    this.reads = null;
    window.speechSynthesis?.cancel();
  }

  private utterance(text: string, voice: SpeechSynthesisVoice): SpeechSynthesisUtterance {
    return Object.assign(new SpeechSynthesisUtterance(text), { voice, lang: voice.lang, rate: this.rate });
  }

  private tell(): void {
    this.hub.tell("aloud", { on: this.aloud, voice: this.voice?.name ?? "" });
  }
}
