/** Speech synthesis of announcements, in the page's language, if the browser has a voice for it. */
import type { Said } from "./announcer";
import type { Hub } from "../hub";
import { recall, remember } from "../preferences";
import { language } from "../words/words";

export const RATES = { least: 0.5, most: 3, step: 0.25 };

export class Speech {
  private on = recall<boolean>("aloud", false);
  /** The lines being read; null after the last one, or if something else is spoken. */
  private reads: object | null = null;

  constructor(private hub: Hub) {
    window.speechSynthesis?.addEventListener("voiceschanged", () => this.notify()); // voices load late
  }

  /** The voice: a local one before one that needs a network; null if there is none. */
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
    this.notify();
  }

  get rate(): number {
    return recall("rate", 1);
  }

  set rate(rate: number) {
    remember("rate", Math.min(RATES.most, Math.max(RATES.least, rate)));
  }

  /** Speak a text; an unfinished one is stale, and ends. */
  speak({ text }: Said): void {
    const voice = this.voice;
    if (!this.on || !voice) return;
    speechSynthesis.cancel();
    speechSynthesis.speak(this.utterance(text, voice));
  }

  /** Read lines in a language, whether or not speech is switched on; false if there is no voice. ended: called when
   * reading ends. */
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
    for (const each of all) each.onerror = end; // something else is spoken
    for (const each of all) speechSynthesis.speak(each);
    return true;
  }

  get reading(): boolean {
    return this.reads !== null;
  }

  /** Stop reading. */
  hush(): void {
    this.reads = null;
    window.speechSynthesis?.cancel();
  }

  private utterance(text: string, voice: SpeechSynthesisVoice): SpeechSynthesisUtterance {
    return Object.assign(new SpeechSynthesisUtterance(text), { voice, lang: voice.lang, rate: this.rate });
  }

  private notify(): void {
    this.hub.tell("aloud", { on: this.aloud, voice: this.voice?.name ?? "" });
  }
}
