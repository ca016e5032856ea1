/** List of named parts, and guidance of the hand to one of them by a device. */
import { button, make } from "kit/elements";
import type { Events } from "kit/server/messages";
import type { Page } from "kit/page";
import { t } from "./words";

interface Named {
  number: number;
  name: string;
}

export function namedParts(page: Page): HTMLElement {
  const box = document.createElement("section");
  const heading = make("h3", { textContent: t("named") });
  const list = make("ul", { className: "named" });
  const hint = make("p", { className: "hint" });
  box.append(heading, hint, list);
  let parts: Named[] = [];
  let guided: number | null = null;
  let feels = false;

  const guide = async (number: number): Promise<void> => {
    try {
      await page.net.ask("beacon", { part: guided === number ? null : number });
    } catch (error) {
      page.say((error as Error).message, { topic: "beacon", asked: true });
    }
  };
  const show = (): void => {
    box.hidden = !parts.length;
    hint.textContent = t(feels ? "guideHint" : "noDevice");
    while (list.children.length > parts.length) list.lastElementChild!.remove();
    parts.forEach((each, at) => {
      const line = list.children[at] ?? list.appendChild(item());
      const go = line.querySelector("button")!;
      line.querySelector("span")!.textContent = each.name;
      go.textContent = t(guided === each.number ? "release" : "guide");
      go.setAttribute("aria-label", t(guided === each.number ? "releaseFrom" : "guideTo", { name: each.name }));
      go.setAttribute("aria-pressed", String(guided === each.number));
      go.hidden = !feels;
      go.onclick = () => void guide(each.number);
    });
  };
  page.hub.on("shown", ({ meta }) => {
    parts = (meta.parts ?? []).map((name, number) => ({ number, name })).filter(({ name }) => name);
    show();
  });
  page.hub.on("loop", ({ running, own_hand }) => {
    feels = running && !own_hand;
    if (!running) guided = null;
    show();
  });
  page.hub.on("beacon", (message: Events["beacon"]) => {
    if (message.part !== guided && !page.narration?.touring) page.say(inWords(message), { topic: "beacon", asked: true });
    guided = message.part;
    show();
  });
  show();
  return box;
}

function inWords({ part, name, why }: Events["beacon"]): string {
  if (part !== null) return t("guiding", { name });
  return t(why === "button" ? "letGo" : "guideEnded");
}

function item(): HTMLLIElement {
  const row = document.createElement("li");
  row.append(document.createElement("span"), button("", () => undefined));
  return row;
}
