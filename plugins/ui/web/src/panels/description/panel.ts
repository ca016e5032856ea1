/** The long description in a language of one's choice: to read, hear, copy and download. */
import { button, field, hint, paragraph } from "../../elements";
import { copy, download } from "../../files";
import type { Page } from "../../page";
import { t } from "./words";
import { language as ours } from "../../words/words";

const LANGUAGES = ["en", "de", "fr"] as const;
type Language = (typeof LANGUAGES)[number];

/** What the program says of the surface with this digest; text and html say all of it. */
interface Description {
  digest: string;
  title: string;
  overview: string;
  heading: string;
  parts: { label: string; says: string }[];
  left_out: string;
  text: string;
  html: string;
}

export function build(page: Page, root: HTMLElement): void {
  const text = region();
  text.append(paragraph(t("waiting")));
  const told = document.createElement("p");
  told.setAttribute("role", "status");
  const language = choice();
  let said: Description | null = null;
  let chosen = false;

  const load = async (): Promise<void> => {
    if (!root.closest("details")!.open) return;
    if (!chosen) language.value = languageOf(page);
    const asked = language.value;
    try {
      const found = await page.net.ask<Description | null>("description", { language: asked });
      if (found && asked === language.value) show(found, asked);
    } catch (error) {
      told.textContent = t("failed", { why: (error as Error).message });
    }
  };
  const show = (found: Description, lang: string): void => {
    told.textContent = "";
    if (said && said.digest !== found.digest) page.say(t("fresh"), { topic: "description" });
    said = found;
    text.lang = lang;
    text.replaceChildren(...inElements(found));
    buttons.hidden = false;
  };
  const read = button(t("read"), () => {
    if (page.speech.reading) page.speech.hush();
    else if (!page.speech.read(said!.text.split("\n").filter(Boolean), language.value, spoken)) told.textContent = t("noVoice");
    spoken();
  });
  const spoken = (): void => void (read.textContent = t(page.speech.reading ? "quiet" : "read"));
  const buttons = document.createElement("div");
  buttons.className = "buttons";
  buttons.hidden = true;
  buttons.append(
    read,
    button(t("copy"), async () => {
      await copy(said!.text);
      page.say(t("copied"), { asked: true });
    }),
    button(t("asText"), () => download(`${said!.text}\n`, `${said!.title}.txt`, "text/plain")),
    button(t("asHtml"), () => download(said!.html, `${said!.title}.html`, "text/html")),
  );
  language.onchange = () => {
    chosen = true;
    void load();
  };
  root.append(hint(t("about")), field(t("language"), language), text, buttons, told);
  root.closest("details")!.addEventListener("toggle", () => void load());
  page.hub.on("described", () => void load());
  page.hub.on("document", () => !chosen && language.value !== languageOf(page) && void load());
  void load();
}

/** That of the document, where it says one that the program speaks; else the page's. */
function languageOf({ document }: Page): Language {
  const said = String(document?.said?.language ?? "").slice(0, 2);
  return LANGUAGES.find((each) => each === said) ?? ours;
}

function choice(): HTMLSelectElement {
  const made = document.createElement("select");
  made.id = "description-language";
  for (const each of LANGUAGES) made.add(new Option(t(each), each));
  return made;
}

function inElements({ title, overview, heading, parts, left_out }: Description): HTMLElement[] {
  const head = document.createElement("h3");
  head.textContent = title;
  const made = [head, paragraph(overview)];
  if (!parts.length) return made;
  const second = document.createElement("h4");
  second.textContent = heading;
  const list = document.createElement("ol");
  for (const { label, says } of parts) {
    const item = document.createElement("li");
    const name = document.createElement("strong");
    name.textContent = label;
    item.append(name, `. ${says}`);
    list.append(item);
  }
  return [...made, second, list, ...(left_out ? [paragraph(left_out)] : [])];
}

/** It scrolls, so that it takes the focus; it is no live region: a new text is announced, not read out. */
function region(): HTMLElement {
  const made = document.createElement("div");
  made.className = "description";
  made.tabIndex = 0;
  made.setAttribute("role", "region");
  made.setAttribute("aria-label", t("text"));
  return made;
}
