/** What the signs on the surface and the words at the contact mean. */
import { make } from "kit/elements";
import { GLYPHS } from "kit/overlay/pieces/contact_label";
import { t as overlay } from "kit/overlay/words";
import type { Page } from "kit/page";
import type { Panel } from "../panel";
import "./signs.css";
import { t } from "./words";

/** Signs in the colours of the overlay. */
const SIGNS = { hand: "●", proxy: "◆", contact: "○", force: "➔" } as const;
const STATES = ["rests", "sticks", "slips", "glides"] as const;

function build(_: Page, root: HTMLElement): void {
  const signs = (Object.keys(SIGNS) as (keyof typeof SIGNS)[]).map((each) => line(SIGNS[each], each, t(each)));
  const states = STATES.map((each) => line(GLYPHS[each], "", `${overlay(each)}: ${overlay(`${each}Help`)}`));
  root.append(listOf(signs), make("h3", { textContent: overlay("gripTitle") }), listOf(states));
}

function listOf(lines: HTMLElement[]): HTMLElement {
  const list = make("ul", { className: "signs" });
  list.append(...lines);
  return list;
}

function line(sign: string, name: string, text: string): HTMLElement {
  const mark = make("span", { className: `sign ${name}`, ariaHidden: "true", textContent: sign });
  const item = document.createElement("li");
  item.append(mark, make("span", { textContent: text }));
  return item;
}

export const signs: Panel = { id: "signs", title: t("title"), task: "feel", open: false, build };
