/** What the palette reaches: keys, tasks, panels, views, and every control of the panels, by their names on the page. */
import { TASKS } from "kit/server/messages";
import { showTask } from "../frame/tasks";
import type { Page } from "kit/page";
import { reveal } from "../panels/panel";
import { t as does } from "../panels/help/shortcut_words";
import { SHORTCUTS, run, type Name } from "kit/shortcuts";
import { language, LANGUAGES, speak, tables } from "kit/words/words";
import { t } from "./words";

export interface Command {
  /** Name in the page's language. */
  name: string;
  /** Name and place in the other languages. */
  others: string;
  /** Where it stands: the title of its panel, or what it is. */
  where: string;
  /** Keys, as in shortcuts.ts. */
  keys: readonly string[];
  run(): void;
}

const CONTROLS = "button, select, textarea, input:not([type=hidden]), .inside summary";

/** Return all commands; those inside of a panel are among them once it is built. */
export function commands(page: Pick<Page, "hub" | "canvas">): Command[] {
  const other = otherNames();
  const named = (name: string, where: string, run: () => void, keys: readonly string[] = []): Command => ({
    name, where, keys, run, others: [other.get(name), other.get(where)].filter(Boolean).join(" "),
  });
  const element = (id: string): HTMLElement => document.getElementById(id)!;
  const all = [
    ...TASKS.map((task) => named(nameOf(element(`tab-${task}`)), t("task"), () => (showTask(task), element(`tab-${task}`).focus()))),
    ...(Object.keys(SHORTCUTS) as Name[]).map((name) => named(does(name), t("key"), () => run(name, page.canvas), SHORTCUTS[name].keys)),
    ...panels().map((panel) => named(titleOf(panel), t("panel"), () => reveal(panel.id))),
    ...options("look").map(({ text, value }) => named(text, t("show"), () => page.hub.tell("look at", { look: value }))),
    ...options("theme").map(({ text, value }) => named(text, element("theme").ariaLabel ?? "", () => choose("theme", value))),
    ...LANGUAGES.map((each) => ({ name: `${t("language")}: ${inLanguage(each, each)}`, where: t("head"), keys: [], others: namesOf(each), run: () => speak(each) })),
    ...controls("#controls").map((control) => named(nameOf(control), t("head"), () => control.click())),
    ...panels().flatMap((panel) => controls(`#${panel.id} .inside`).map((each) => named(nameOf(each), titleOf(panel), () => use(panel, each)))),
  ];
  const seen = new Set<string>();
  return all.filter(({ name, where }) => name && !seen.has(`${name}\n${where}`) && seen.add(`${name}\n${where}`));
}

const inLanguage = (language: string, own: string): string => new Intl.DisplayNames([own], { type: "language" }).of(language)!;

/** Return the words by which somebody looks for a language: its name, and "language", in every language. */
function namesOf(language: string): string {
  return LANGUAGES.map((own) => inLanguage(language, own)).join(" ") + " language Sprache langue";
}

/** Return the names in other languages by the name in the page's. */
function otherNames(): Map<string, string> {
  const own = LANGUAGES.indexOf(language);
  const rows = tables.flatMap((table) => Object.values(table) as (readonly string[])[]);
  return new Map(rows.map((row) => [row[own]!, row.filter((_, at) => at !== own).join(" ")]));
}

const panels = (): HTMLElement[] => [...document.querySelectorAll<HTMLElement>("details.panel")];
const titleOf = (panel: HTMLElement): string => panel.querySelector("summary")!.textContent!.trim();
const options = (id: string): HTMLOptionElement[] => [...(document.getElementById(id) as HTMLSelectElement).options];

/** Return the controls inside of what is selected that are not hidden there, in a panel that may be closed. */
function controls(inside: string): HTMLElement[] {
  const within = CONTROLS.split(", ").map((each) => `${inside} ${each.replace(".inside ", "")}`).join(", ");
  return [...document.querySelectorAll<HTMLElement>(within)].filter((each) => {
    const hidden = each.closest<HTMLElement>("[hidden]");
    return (!hidden || hidden.getAttribute("role") === "tabpanel") && !each.matches(":disabled, [aria-disabled=true]");
  });
}

/** Return the name of a control, without what stands in it for the eyes or as a key. */
export function nameOf(control: HTMLElement): string {
  const around = (control as HTMLInputElement).labels?.[0] ?? control;
  if (control.ariaLabel) return control.ariaLabel;
  const copy = around.cloneNode(true) as HTMLElement;
  for (const each of copy.querySelectorAll("kbd, .badge, input, select, textarea, output, [aria-hidden=true]")) each.remove();
  return copy.textContent!.replace(/\s+/g, " ").trim();
}

function choose(id: string, value: string): void {
  const select = document.getElementById(id) as HTMLSelectElement;
  select.value = value;
  select.dispatchEvent(new Event("change"));
}

/** Bring a control to the screen with the focus; a button is pressed too. */
function use(panel: HTMLElement, control: HTMLElement): void {
  reveal(panel.id);
  for (let box = control.closest("details"); box; box = box.parentElement!.closest("details")) box.open = true;
  control.focus();
  control.scrollIntoView({ block: "nearest" });
  if (control.matches("button")) control.click();
}
