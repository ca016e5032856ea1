/** The long description in a chosen language: to read, hear, copy and download. */
import { button, field, hint, make, paragraph } from "kit/elements";
import { copy, download } from "../../files";
import type { Page } from "kit/page";
import { t } from "./words";
import { language as ours } from "kit/words/words";

const LANGUAGES = ["en", "de", "fr"] as const;
type Language = (typeof LANGUAGES)[number];

/** The program's description of the surface with this digest; text and html contain all of it. */
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
  const status = document.createElement("p");
  status.setAttribute("role", "status");
  const language = choice();
  let answer: Description | null = null;
  let chosen = false;

  const load = async (): Promise<void> => {
    if (!root.closest("details")!.open) return;
    if (!chosen) language.value = languageOf(page);
    const asked = language.value;
    try {
      const description = await page.net.ask<Description | null>("description", { language: asked });
      if (description && asked === language.value) show(description, asked);
    } catch (error) {
      status.textContent = t("failed", { why: (error as Error).message });
    }
  };
  const show = (newest: Description, lang: string): void => {
    status.textContent = "";
    if (answer && answer.digest !== newest.digest) page.say(t("fresh"), { topic: "description" });
    answer = newest;
    text.lang = lang;
    text.replaceChildren(...inElements(newest));
    buttons.hidden = false;
  };
  const read = button(t("read"), () => {
    if (page.speech.reading) page.speech.hush();
    else if (!page.speech.read(answer!.text.split("\n").filter(Boolean), language.value, spoken)) status.textContent = t("noVoice");
    spoken();
  });
  const spoken = (): void => void (read.textContent = t(page.speech.reading ? "quiet" : "read"));
  const buttons = make("div", { className: "buttons", hidden: true });
  buttons.append(
    read,
    button(t("copy"), async () => {
      await copy(answer!.text);
      page.say(t("copied"), { asked: true });
    }),
    button(t("asText"), () => download(`${answer!.text}\n`, `${answer!.title}.txt`, "text/plain")),
    button(t("asHtml"), () => download(answer!.html, `${answer!.title}.html`, "text/html")),
  );
  language.onchange = () => {
    chosen = true;
    void load();
  };
  root.append(hint(t("about")), field(t("language"), language), text, buttons, status);
  root.closest("details")!.addEventListener("toggle", () => void load());
  page.hub.on("described", () => void load());
  page.hub.on("document", () => !chosen && language.value !== languageOf(page) && void load());
  void load();
}

/** Return the document's language if descriptions exist in it, else the page's. */
function languageOf({ document }: Page): Language {
  const text = String(document?.said?.language ?? "").slice(0, 2);
  return LANGUAGES.find((each) => each === text) ?? ours;
}

function choice(): HTMLSelectElement {
  const select = make("select", { id: "description-language" });
  for (const each of LANGUAGES) select.add(new Option(t(each), each));
  return select;
}

function inElements({ title, overview, heading, parts, left_out }: Description): HTMLElement[] {
  const head = make("h3", { textContent: title });
  const elements = [head, paragraph(overview)];
  if (!parts.length) return elements;
  const second = make("h4", { textContent: heading });
  const list = document.createElement("ul");
  for (const { label, says } of parts) {
    const item = document.createElement("li");
    const name = make("strong", { textContent: label });
    item.append(name, `. ${says}`);
    list.append(item);
  }
  return [...elements, second, list, ...(left_out ? [paragraph(left_out)] : [])];
}

/** Return a scrolling region, focusable; not a live region: a new text is announced, not read out. */
function region(): HTMLElement {
  const results = make("div", { className: "description", tabIndex: 0 });
  results.setAttribute("role", "region");
  results.setAttribute("aria-label", t("text"));
  return results;
}
