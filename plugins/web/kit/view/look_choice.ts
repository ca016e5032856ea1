/** The choice of what the surface shows, with its legend, in the strip below the surface. */
import type { Page } from "../page";
import { legend } from "../terrain/legend";
import { type Look, looksOf } from "./look";
import { t } from "./words";

type Word = Parameters<typeof t>[0];

export function lookChoice(page: Pick<Page, "scene">, showing: Look, choose: (look: string) => void): void {
  const box = Object.assign(document.createElement("div"), { className: "looks", hidden: true });
  const select = Object.assign(document.createElement("select"), { id: "look" });
  const label = document.createElement("label");
  label.append(Object.assign(document.createElement("span"), { textContent: t("look") }), select);
  const meaning = document.createElement("div");
  box.append(label, meaning);
  document.getElementById("strip")!.prepend(box);
  select.onchange = () => choose(select.value);
  showing.onChange = () => {
    const { scene } = page;
    box.hidden = !scene;
    if (!scene) return;
    const there = looksOf(scene.meta);
    if ([...select.options].map(({ value }) => value).join() !== there.join())
      select.replaceChildren(...there.map((look) => new Option(t(look as Word), look)));
    select.value = showing.look;
    meaning.replaceChildren(...[legend(scene, showing.look)].filter((each) => each !== null));
  };
}
