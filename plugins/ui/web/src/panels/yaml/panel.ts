/** The pipeline file on the screen, as text: to read, edit, copy, download and save. */
import { button, field } from "../../elements";
import { copy, download } from "../../files";
import { Editor } from "../../forms/editor";
import type { Complaint } from "../../server/messages";
import type { Page } from "../../page";
import type { Panel } from "../panel";
import { t } from "./words";
import "./yaml.css";

/** A text is checked when nothing was typed for so long. */
const PAUSE_MS = 600;

function build(page: Page, root: HTMLElement): void {
  const text = document.createElement("textarea");
  text.id = "yaml-text";
  text.spellcheck = false;
  text.rows = 18;
  text.wrap = "off";
  const state = document.createElement("div");
  state.id = "yaml-state";
  text.setAttribute("aria-describedby", state.id);
  const told = document.createElement("p");
  const say = (words: string): void => {
    told.textContent = words;
    page.say(words);
  };
  const editor = new Editor(page);
  let timer = 0;
  let of: string | null = null;

  text.oninput = () => {
    of ??= page.document?.digest ?? "";
    state.textContent = t("typing");
    clearTimeout(timer);
    timer = window.setTimeout(() => {
      const told = { text: text.value, of, apply: editor.apply };
      timer = 0;
      of = null; // who goes on typing has seen what was said
      void page.net.ask("edit", told).catch((error: Error) => say(error.message));
    }, PAUSE_MS);
  };
  page.hub.on("document", (said) => {
    if (!timer && text.value !== said.text) replace(text, said.text);
    if (!timer) state.replaceChildren(...complaints(said.complaints));
    path.value ||= said.path;
    if (document.activeElement !== path) path.value = said.path;
  });

  const path = document.createElement("input");
  path.id = "yaml-path";
  path.spellcheck = false;
  const instead = document.createElement("input");
  instead.type = "checkbox";
  instead.id = "yaml-replace";
  const save = async (): Promise<void> => {
    try {
      await page.net.ask("save", { path: path.value, replace: instead.checked });
      say(t("saved", { path: page.document?.path ?? path.value }));
    } catch (error) {
      say(t("failed", { why: (error as Error).message }));
    }
  };
  root.append(
    field(t("text"), text),
    state,
    button(t("copy"), async () => {
      await copy(text.value);
      say(t("copied"));
    }),
    button(t("download"), () => download(text.value, path.value.split(/[/\\]/).at(-1) || "pipeline.yaml", "application/yaml")),
    field(t("path"), path),
    field(t("replace"), instead),
    button(t("save"), save),
    told,
  );
}

/** Another text in place of this one, the caret where it was. */
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
    const line = document.createElement("li");
    line.textContent = text;
    list.append(line);
  }
  return [heading, list];
}

export const yaml: Panel = { id: "yaml", title: t("title"), place: "left", open: false, build };
