/** The pipeline file as text: to read, edit and copy. */
import { button, field, make } from "kit/elements";
import { copy } from "../../files";
import { DocumentEditor } from "../../forms/editor";
import type { Complaint } from "kit/server/messages";
import type { Page } from "kit/page";
import type { Panel } from "../panel";
import { t } from "./words";
import "./yaml.css";

/** Milliseconds without typing after which the text is checked. */
const PAUSE_MS = 600;

function build(page: Page, root: HTMLElement): void {
  const text = make("textarea", { id: "yaml-text", spellcheck: false, rows: 18, wrap: "off" });
  const state = make("div", { id: "yaml-state" });
  text.setAttribute("aria-describedby", state.id);
  const status = document.createElement("p");
  const say = (words: string): void => {
    status.textContent = words;
    page.say(words);
  };
  const editor = new DocumentEditor(page);
  let timer = 0;
  let of: string | null = null;

  text.oninput = () => {
    of ??= page.document?.digest ?? "";
    state.textContent = t("typing");
    clearTimeout(timer);
    timer = window.setTimeout(() => {
      const told = { text: text.value, of, apply: editor.apply };
      timer = 0;
      of = null; // further typing is based on the answer
      void page.net.ask("edit", told).catch((error: Error) => say(error.message));
    }, PAUSE_MS);
  };
  page.hub.on("document", (message) => {
    if (!timer && text.value !== message.text) replace(text, message.text);
    if (!timer) state.replaceChildren(...complaints(message.complaints));
  });

  root.append(
    field(t("text"), text),
    state,
    button(t("copy"), async () => {
      await copy(text.value);
      say(t("copied"));
    }),
    status,
  );
}

/** Replace the text and keep the caret. */
function replace(area: HTMLTextAreaElement, text: string): void {
  const { selectionStart, selectionEnd, scrollTop } = area;
  area.value = text;
  area.setSelectionRange(selectionStart, selectionEnd);
  area.scrollTop = scrollTop;
}

function complaints(found: Complaint[]): HTMLElement[] {
  const heading = document.createElement("p");
  if (!found.length) {
    heading.textContent = t("fine");
    return [heading];
  }
  heading.textContent = found.length === 1 ? t("wrongOne") : t("wrong", { count: found.length });
  const list = document.createElement("ul");
  for (const { text } of found) {
    const line = make("li", { textContent: text });
    list.append(line);
  }
  return [heading, list];
}

export const yaml: Panel = { id: "yaml", title: t("title"), task: "advanced", open: false, build };
