/** The command palette: a combobox over all commands, in a dialog. */
import type { Page } from "kit/page";
import { caps } from "kit/key_caps";
import { fillAll } from "../panels/lazy";
import { keyName, SHORTCUTS } from "kit/shortcuts";
import { commands, type Command } from "./commands";
import { ranked } from "./match";
import "./palette.css";
import { t } from "./words";

/** Entries that are listed; more are found by typing more. */
const MOST = 60;
const STEPS: Record<string, number> = { ArrowDown: 1, ArrowUp: -1, PageDown: 10, PageUp: -10 };
const OWN_KEYS: readonly string[] = SHORTCUTS.palette.keys;

/** Open the palette. */
export function open(page: Pick<Page, "hub" | "canvas" | "say">): void {
  const dialog = Object.assign(document.createElement("dialog"), { id: "palette" });
  dialog.setAttribute("aria-label", t("title"));
  dialog.dataset.ownEscape = "";
  const input = Object.assign(document.createElement("input"), { id: "palette-input", role: "combobox", autocomplete: "off", spellcheck: false });
  const list = Object.assign(document.createElement("ul"), { id: "palette-list", role: "listbox" });
  list.setAttribute("aria-label", t("results"));
  for (const [name, value] of Object.entries({ label: t("title"), controls: list.id, expanded: "true", autocomplete: "list" }))
    input.setAttribute(`aria-${name}`, value);
  input.placeholder = t("title");
  const none = Object.assign(document.createElement("p"), { className: "hint", textContent: t("none") });
  dialog.append(input, list, none);
  let all = commands(page);
  const close = (): void => {
    dialog.close();
    dialog.remove(); // the event `close` comes later, when it may be open again
  };
  let found: Command[] = [];
  let at = 0;

  const mark = (to: number): void => {
    at = Math.max(0, Math.min(found.length - 1, to));
    for (const [place, item] of [...list.children].entries()) item.ariaSelected = String(place === at);
    const chosen = list.children[at];
    if (!chosen) return input.removeAttribute("aria-activedescendant");
    input.setAttribute("aria-activedescendant", chosen.id);
    chosen.scrollIntoView({ block: "nearest" });
  };
  const show = (): void => {
    found = ranked(input.value, all, ({ name, others, where }) => [name, others, `${name} ${where}`]).slice(0, MOST);
    list.replaceChildren(...found.map((each, place) => item(each, place, () => choose(place))));
    list.hidden = !found.length;
    none.hidden = found.length > 0;
    input.ariaExpanded = String(found.length > 0);
  };
  const look = (): void => {
    show();
    mark(0);
    if (input.value) page.say(found.length ? t("count", { count: found.length }) : t("none"), { topic: "palette" });
  };
  const choose = (place: number): void => {
    const chosen = found[place];
    if (!chosen) return;
    close();
    chosen.run();
  };
  input.oninput = look;
  dialog.onkeydown = (event) => {
    const step = STEPS[event.key];
    if (OWN_KEYS.includes(keyName(event))) close();
    else if (step) mark(step === 1 && at === found.length - 1 ? 0 : step === -1 && at === 0 ? found.length - 1 : at + step);
    else if (event.key === "Enter") choose(at);
    else return;
    event.preventDefault();
    event.stopPropagation();
  };
  dialog.onclick = ({ target }) => target === dialog && close();
  dialog.onclose = () => dialog.remove();
  document.body.append(dialog);
  look();
  dialog.showModal();
  input.focus();
  void fillAll().then(() => {
    const chosen = at ? found[at] : undefined; // who has moved down keeps what is chosen
    all = commands(page);
    show();
    mark(chosen ? found.findIndex(({ name, where }) => name === chosen.name && where === chosen.where) : 0);
  });
}

function item({ name, where, keys }: Command, place: number, choose: () => void): HTMLElement {
  const line = Object.assign(document.createElement("li"), { id: `palette-${place}`, role: "option" });
  const about = Object.assign(document.createElement("small"), { textContent: where });
  line.append(Object.assign(document.createElement("span"), { textContent: name }), " ", about, " ", ...keys.slice(0, 2).map(caps));
  line.onclick = choose;
  return line;
}
