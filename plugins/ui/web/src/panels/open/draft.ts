/** Offer of unsaved edits of a previous program: to open or discard. */
import { button } from "kit/elements";
import type { Page } from "kit/page";
import { language } from "kit/words/words";
import { t } from "./draft_words";

export function draftOffer({ hub, net, say }: Page): HTMLElement {
  const box = document.createElement("div");
  const text = document.createElement("p");
  const ask = (name: string) => (): Promise<unknown> => net.ask(name).catch((error: Error) => say(error.message));
  box.hidden = true;
  box.append(text, button(t("open"), ask("restore")), button(t("forget"), ask("forget_draft")));
  hub.on("restored", ({ path, edited_s }) => {
    box.hidden = !path;
    if (!path) return;
    const name = path.split(/[\\/]/).at(-1)!;
    text.textContent = t("left", { name, when: new Date(1000 * edited_s).toLocaleString(language) });
    say(text.textContent);
  });
  return box;
}
