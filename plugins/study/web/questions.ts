/** What the program says and asks: lines of a log, read aloud if wanted, and answers as buttons and keys. */
import { button, paragraph } from "kit/elements";
import type { PageEvents } from "kit/events";
import type { Server } from "kit/page";
import { recall, remember } from "kit/preferences";
import { language } from "kit/words/words";
import { t } from "./words";

/** Lines that stay readable above the answers. */
const LINES = 4;
/** The key that leaves the study. */
const LEAVE = "q";
const ALOUD = "study aloud";

/** An event of the program. */
export interface Told {
  /** Number of the event in this session, from 1. */
  line: number;
  text: string;
  /** Keys that answer, each with its meaning; null for a sentence that asks nothing. */
  choices: [key: string, meaning: string][] | null;
  /** Number of the surface that can be felt from now on; 0 for none. Missing in sentences. */
  surface?: number;
  /** Sounds by which it is felt. */
  sounds?: string[];
  /** Label of the part to which the hand is led; null for none. */
  lead?: number | null;
}

/** Events of a participant's page. */
export interface StudyEvents extends PageEvents {
  said: Told;
  /** The study is over, and the program ends. */
  ended: object;
}

interface Places {
  log: HTMLElement;
  answers: HTMLElement;
  aloud: HTMLInputElement;
}

export class Questions {
  private question: Told | null = null;
  private leaving = false;
  private newest = 0;
  private isLost = false;

  /** feel: called with each event about a surface. */
  constructor(
    private at: Places,
    private net: Pick<Server, "ask">,
    private feel: (told: Told) => void,
  ) {
    at.aloud.checked = recall(ALOUD, true);
    at.aloud.addEventListener("change", () => {
      remember(ALOUD, at.aloud.checked);
      if (!at.aloud.checked) globalThis.speechSynthesis?.cancel();
    });
    document.addEventListener("keydown", (event) => this.press(event));
  }

  /** Say once that the program does not answer. */
  lose(): void {
    if (!this.isLost) this.show(t("lost"));
    this.isLost = true;
  }

  /** Leave the study: at once if a question waits, else at the next one. */
  leave(): void {
    this.leaving = true;
    this.answer(LEAVE);
  }

  /** Take the events that are new; a page that is loaded again goes on with the last lines and the present surface. */
  takeAll(all: Told[]): void {
    const events = all.filter(({ line }) => line > this.newest);
    const again = this.newest === 0;
    this.newest = all.at(-1)?.line ?? this.newest;
    this.isLost = false;
    const surfaces = events.filter(({ surface }) => surface !== undefined);
    const lines = events.filter(({ surface }) => surface === undefined);
    for (const each of again ? surfaces.slice(-1) : surfaces) this.feel(each);
    for (const each of again ? lines.slice(-LINES) : lines) this.take(each);
  }

  private take(told: Told): void {
    const { at } = this;
    this.show(told.text);
    this.question = told.choices && told;
    const choices = told.choices ?? [];
    at.answers.replaceChildren(
      ...choices.map(([key, meaning]) => button(key === "" ? t("enter") : meaning ? `${key}: ${meaning}` : key, () => this.answer(key))),
    );
    // the group and not a button: Space, with which a hand presses, must not answer
    if (choices.length) at.answers.focus();
    this.speak([told.text, ...choices.filter(([, meaning]) => meaning).map((each) => each.join(": "))].join(". "));
    if (this.leaving) this.answer(LEAVE);
  }

  private show(text: string): void {
    const { log } = this.at;
    log.append(paragraph(text));
    while (log.childElementCount > LINES) log.firstElementChild!.remove();
  }

  /** Read a text after those that wait. */
  private speak(text: string): void {
    if (!this.at.aloud.checked || !("speechSynthesis" in window)) return;
    speechSynthesis.speak(Object.assign(new SpeechSynthesisUtterance(text), { lang: language }));
  }

  private answer(key: string): void {
    if (!this.question) return;
    const { line } = this.question;
    this.question = null;
    this.at.answers.replaceChildren();
    globalThis.speechSynthesis?.cancel();
    this.net.ask("answer", { question: line, key }).catch(() => this.lose());
  }

  private press(event: KeyboardEvent): void {
    if (event.ctrlKey || event.altKey || event.metaKey || event.repeat || !this.question) return;
    const key = event.key === "Enter" ? "" : event.key.toLowerCase();
    if (event.key === "Enter" && event.target instanceof HTMLButtonElement) return; // the button answers itself
    if (!this.question.choices!.some(([each]) => each === key)) return;
    event.preventDefault();
    this.answer(key);
  }
}
