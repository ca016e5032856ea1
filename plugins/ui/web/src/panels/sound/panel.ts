/** Settings of sound and speech. */
import { button, fieldset, labelled, make } from "kit/elements";
import type { Page } from "kit/page";
import type { Panel } from "../panel";
import { on } from "kit/shortcuts";
import { VOICES, type VoiceName } from "kit/sound/sound";
import { RATES } from "kit/speech/speech";
import { t } from "./words";
import "./sound.css";

function build(page: Page, root: HTMLElement): void {
  const heading = (text: string): HTMLElement => make("h3", { textContent: text });
  root.append(soundButton(page), meter(page), volume(page), voices(page), heights(page));
  root.append(heading(t("speech")), ...speechControls(page));
}

function soundButton(page: Page): HTMLElement {
  const toggle = (): void => void page.sound.toggle().catch((error: Error) => page.say(error.message, { urgent: true }));
  const element = button(t("sound"), toggle, { id: "sound-on" });
  element.setAttribute("aria-pressed", "false");
  element.setAttribute("aria-keyshortcuts", "S");
  page.hub.on("sound", (told) => {
    element.setAttribute("aria-pressed", String(told.on));
    page.say(t(told.on ? "soundOn" : "soundOff"), { topic: "sound", asked: true });
  });
  on("sound", toggle);
  return element;
}

/** Return a meter of the loudness. */
function meter(page: Page): HTMLElement {
  const bar = make("meter", { min: 0, max: 0.3, value: 0, id: "sound-level" });
  bar.setAttribute("aria-label", t("level"));
  setInterval(() => {
    if (bar.checkVisibility() && !document.hidden) bar.value = page.sound.level;
  }, 100);
  return bar;
}

function volume(page: Page): HTMLElement {
  const input = range({ least: 0, most: 100, step: 5 }, 100 * page.sound.volume);
  input.oninput = () => (page.sound.volume = input.valueAsNumber / 100);
  return labelled(t("volume"), input);
}

function voices(page: Page): HTMLElement {
  return fieldset(t("heard"), ...(Object.keys(VOICES) as VoiceName[]).map(voice));

  function voice(name: VoiceName): HTMLElement {
    const input = make("input", { type: "checkbox", checked: page.sound.has(name) });
    input.onchange = () => page.sound.let(name, input.checked);
    return labelled(input, t(name));
  }
}

function heights(page: Page): HTMLElement {
  const sweep = (): void => {
    const { scene, net } = page;
    if (!scene) return page.say(t("noSurface"), { asked: true });
    const y = net.latest && net.latest.hand[2] < 0.5 ? net.latest.hand[1] : 0;
    void page.sound.sweep(scene, y);
  };
  const toggle = button(t("sweep"), sweep);
  toggle.setAttribute("aria-keyshortcuts", "H");
  on("hear heights", sweep);
  return toggle;
}

function speechControls(page: Page): HTMLElement[] {
  const { speech } = page;
  const toggle = (): void => {
    if (!speech.voice) return page.say(t("noVoice"), { asked: true });
    speech.aloud = !speech.aloud;
    page.say(t(speech.aloud ? "speechOn" : "speechOff"), { topic: "speech", asked: true });
  };
  const element = button(t("aloud"), toggle, { id: "speech-on" });
  element.setAttribute("aria-keyshortcuts", "A");
  on("aloud", toggle);
  const rate = range(RATES, speech.rate);
  rate.onchange = () => (speech.rate = rate.valueAsNumber);
  const rated = labelled(t("rate"), rate);
  const hint = make("p", { className: "hint" });
  const show = (): void => {
    element.hidden = rated.hidden = !speech.voice;
    element.setAttribute("aria-pressed", String(speech.aloud));
    hint.textContent = speech.voice ? t("voice", { name: speech.voice.name }) : t("noVoice");
  };
  page.hub.on("aloud", show);
  show();
  return [element, rated, hint, ...narrationControls(page)];
}

/** Return the buttons of what the announcements tell beyond contact: for a screen reader too. */
function narrationControls(page: Page): HTMLElement[] {
  const moves = button(t("moves"), () => page.narration && (page.narration.moves = !page.narration.moves));
  moves.setAttribute("aria-keyshortcuts", "Shift+D");
  const tour = button(t("tour"), () => page.narration?.toggleTour());
  tour.setAttribute("aria-keyshortcuts", "G");
  const show = (): void => {
    moves.setAttribute("aria-pressed", String(page.narration?.moves ?? false));
    tour.setAttribute("aria-pressed", String(page.narration?.touring ?? false));
  };
  page.hub.on("describing", show);
  page.hub.on("tour", show);
  show();
  const about = make("p", { className: "hint", textContent: t("narration") });
  return [moves, tour, about];
}

function range({ least, most, step }: { least: number; most: number; step: number }, value: number): HTMLInputElement {
  const input = make("input", { type: "range" });
  Object.assign(input, { min: String(least), max: String(most), step: String(step), value: String(value) });
  return input;
}

export const sound: Panel = { id: "sound", title: t("title"), task: "feel", open: false, build };
