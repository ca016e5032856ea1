/** What stands around the picture: switches, the parts, the keys, the description in the person's language. */
import { button, field, paragraph, tableWithHeads } from "kit/elements";
import type { Page } from "kit/page";
import { caps } from "kit/key_caps";
import { on } from "kit/shortcuts";
import { partsFromNearToFar } from "kit/speech/part_facts";
import { shownNumber } from "kit/words/part_words";
import { language, LANGUAGES, speak, type Language } from "kit/words/words";
import type { Packed } from "./data";
import type { Shaking } from "kit/shaking";
import { t } from "./words";

const TONGUES: Record<Language, string> = { en: "English", de: "Deutsch", fr: "Français" };
const KEYS = [
  [["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown"], "arrows"],
  [[" "], "space"],
  [["PageUp", "PageDown"], "pages"],
  [["Home"], "home"],
  [["n"], "next"],
  [["w"], "where"],
  [["d"], "describe"],
  [["g"], "guide"],
  [["Escape"], "escape"],
] as const;

type Controlled = Pick<Page, "hub" | "hand" | "narration" | "sound" | "speech" | "say">;

/** Fill the toolbar. show: colour the surface by this look. */
export function switches(page: Controlled, root: HTMLElement, shaking: Shaking, looks: string[], show: (look: string) => void): void {
  const { hub, sound, speech, narration } = page;
  root.setAttribute("aria-label", t("controls"));
  const toggleSound = async (): Promise<void> => {
    await sound.toggle();
    page.say(t(sound.on ? "soundOn" : "soundOff"), { topic: "sound", asked: true });
  };
  const hears = toggle(t("sound"), () => sound.on, toggleSound);
  const tones = toggle(t("tones"), () => sound.has("height"), () => sound.let("height", !sound.has("height")));
  const aloud = toggle(t("aloud"), () => speech.aloud, () => {
    if (!speech.voice) return page.say(t("noVoice"), { asked: true });
    speech.aloud = !speech.aloud;
  });
  const rises = toggle(t("rises"), () => narration!.moves, () => (narration!.moves = !narration!.moves));
  const shakes = toggle(t("shakes"), () => shaking.on, () => (shaking.on = !shaking.on));
  const tour = toggle(t("tour"), () => narration!.touring, () => narration!.toggleTour());
  shakes.root.hidden = !("vibrate" in navigator) && !("getGamepads" in navigator);
  for (const [name, { update }] of [["sound", hears], ["aloud", aloud], ["describing", rises], ["tour", tour]] as const)
    hub.on(name, update);
  on("sound", () => void toggleSound());
  on("aloud", () => aloud.root.click());
  const look = select("look", looks.map((each) => [each, t(each as Parameters<typeof t>[0])]), looks[0]!, show);
  const tongue = select("language", LANGUAGES.map((each) => [each, TONGUES[each]]), language, (each) => speak(each as Language));
  for (const each of tongue.options) each.lang = each.value;
  root.append(
    ...[hears, tones, aloud, rises, shakes, tour].map((each) => each.root),
    field(t("look"), look),
    field(t("language"), tongue),
  );
}

/** List the parts as buttons that lead the hand; nothing without parts. */
export function partList(page: Pick<Page, "hub" | "hand" | "scene">, root: HTMLElement): void {
  const scene = page.scene!;
  const parts = partsFromNearToFar(scene);
  root.hidden = parts.length < 2;
  const list = document.createElement("ul");
  list.className = "part-list";
  for (const { label, at } of parts) {
    const lead = button(scene.meta.parts?.[label] || t("part", { number: shownNumber(label) }), () => {
      page.hand?.leadTo(...at);
      page.hub.tell("led", { label });
    });
    lead.dir = "auto";
    const item = document.createElement("li");
    item.append(lead);
    list.append(item);
  }
  root.append(heading(t("parts")), list);
}

/** Show all keys, as in the page of the program. */
export function keyTable(root: HTMLDetailsElement): void {
  const title = document.createElement("summary");
  title.textContent = t("keys");
  const table = tableWithHeads(t("keys"), [], "keys");
  table.deleteTHead();
  const body = table.createTBody();
  for (const [keys, does] of KEYS) {
    const row = body.insertRow();
    const head = document.createElement("th");
    head.scope = "row";
    head.append(...keys.flatMap((each) => [caps(each), " "]));
    row.append(head);
    row.insertCell().textContent = t(does);
  }
  root.append(title, table);
  on("help", () => {
    root.open = true;
    title.focus();
  });
}

/** Describe the picture in the language of the page, in place of that of the file. */
export function describe({ describes }: Packed, root: HTMLElement): void {
  const text = describes[language];
  if (!text || root.lang === language) return;
  root.lang = language;
  const list = document.createElement("ul");
  for (const [label, says] of text.parts) {
    const item = document.createElement("li");
    const name = Object.assign(document.createElement("bdi"), { textContent: label });
    item.append(name, ". ", says);
    list.append(item);
  }
  const parts = text.parts.length ? [heading(text.heading), list] : [];
  root.replaceChildren(paragraph(text.overview), ...parts, ...(text.left_out ? [paragraph(text.left_out)] : []));
}

function heading(text: string): HTMLElement {
  return Object.assign(document.createElement("h2"), { textContent: text });
}

/** A button that is pressed or not. */
function toggle(text: string, state: () => boolean, press: () => unknown): { root: HTMLButtonElement; update: () => void } {
  const update = (): void => void (root.ariaPressed = String(state()));
  const root = button(text, async () => {
    await press();
    update();
  });
  update();
  return { root, update };
}

function select(id: string, choices: string[][], chosen: string, choose: (value: string) => void): HTMLSelectElement {
  const box = document.createElement("select");
  box.id = id;
  for (const [value, text] of choices) box.append(new Option(text, value, false, value === chosen));
  box.addEventListener("change", () => choose(box.value));
  return box;
}
