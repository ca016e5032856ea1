/** Settings of the person: colours, language, sizes, keys. Kept in this browser, not in the pipeline file. */
import { button, fieldset, labelled, make } from "kit/elements";
import type { Page } from "kit/page";
import type { Panel } from "../panel";
import { recall, remember } from "kit/preferences";
import { letters } from "kit/shortcuts";
import { resetSizes, resize } from "../../frame/splitters";
import { THEMES, type Theme } from "kit/themes";
import { t } from "./words";
import { LANGUAGES, language, speak, type Language } from "kit/words/words";

function build(page: Page, root: HTMLElement): void {
  root.append(colours(page), languages(), sizes(), keys(), readLogSwitch(page));
}

function colours(page: Page): HTMLElement {
  const choice = choose(THEMES.map((each) => [each, t(each)]), page.themes.chosen);
  choice.onchange = () => page.themes.choose(choice.value as Theme);
  page.hub.on("theme", () => (choice.value = page.themes.chosen));
  return labelled(t("colours"), choice);
}

function languages(): HTMLElement {
  const named = LANGUAGES.map((each) => [each, new Intl.DisplayNames([each], { type: "language" }).of(each)!] as const);
  const choice = choose(named, language);
  for (const option of choice.options) option.lang = option.value;
  choice.onchange = () => speak(choice.value as Language);
  return labelled(t("language"), choice);
}

/** Return buttons for the sizes of the regions, as an alternative to dragging. */
function sizes(): HTMLElement {
  const buttons = make("div", { className: "buttons" });
  buttons.append(
    button(t("wider"), () => resize(1)),
    button(t("narrower"), () => resize(-1)),
    button(t("reset"), () => resetSizes()),
  );
  return fieldset(t("sizes"), buttons);
}

function keys(): HTMLElement {
  const input = make("input", { type: "checkbox", checked: letters.everywhere });
  input.onchange = () => (letters.everywhere = input.checked);
  const label = labelled(input, t("letters"));
  const hint = make("p", { className: "hint", id: "letters-hint", textContent: t("lettersHint") });
  input.setAttribute("aria-describedby", hint.id);
  const box = document.createElement("div");
  box.append(label, hint);
  return box;
}

function readLogSwitch(page: Page): HTMLElement {
  const input = make("input", { type: "checkbox", checked: recall("read", false) });
  const tell = (): void => page.hub.tell("read log", { on: input.checked });
  input.onchange = () => {
    remember("read", input.checked);
    tell();
  };
  queueMicrotask(tell); // after all panels are built
  return labelled(input, t("read"));
}

function choose(options: (readonly [value: string, text: string])[], value: string): HTMLSelectElement {
  const choice = document.createElement("select");
  for (const [each, text] of options) choice.add(new Option(text, each));
  choice.value = value;
  return choice;
}

export const settings: Panel = { id: "settings", title: t("title"), task: "any", open: false, build };
