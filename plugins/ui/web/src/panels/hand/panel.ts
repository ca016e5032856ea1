/** Settings of this page's hand: whether it is active, its mover, and its penetration. */
import { button, field, fieldset, hint, labelled, make } from "kit/elements";
import { type HandState, PRESS_M } from "kit/hand/state";
import type { Page } from "kit/page";
import type { Panel } from "../panel";
import { t } from "kit/hand/words";

function build(page: Page, root: HTMLElement): void {
  const status = make("p", { id: "hand-held" });
  const take = Object.assign(button(t("take"), () => page.hand?.take()), { hidden: true });
  const moved = document.createElement("p");
  const press = slider();
  const value = document.createElement("output");
  press.oninput = () => {
    if (page.hand) page.hand.pressM = Number(press.value) / 1000;
    show();
  };
  const ways = fieldset(t("moves"), way("surface", false), way("space", true));
  const depth = field(t("press"), press);
  depth.append(value);
  const hints = (["howMouse", "howFinger", "howKeys"] as const).map((each) => hint(t(each)));
  const pad = hint(t("padThere"));
  root.append(status, take, moved, ways, depth, ...hints, pad);

  function way(name: "surface" | "space", free: boolean): HTMLLabelElement {
    const input = make("input", { type: "radio", name: "hand-way", value: name, checked: !free });
    input.onchange = () => page.hand?.free(free);
    return labelled(input, t(name));
  }

  function show(): void {
    value.textContent = t("millimetres", { value: Number(press.value).toFixed(1) });
    press.setAttribute("aria-valuetext", value.textContent);
  }

  function hear(hand: HandState): void {
    status.textContent = t(holderOf(hand));
    take.hidden = !hand.there || hand.holding || hand.rests;
    moved.textContent = `${t("movedBy")}: ${t(hand.by ?? "nothing")}`;
    pad.hidden = !hand.pads;
    for (const each of ways.querySelectorAll("input")) each.checked = (each.value === "space") === hand.isFree;
  }

  page.hub.on("hand", hear);
  page.hub.on("drawn", () => {
    const mm = (1000 * (page.hand?.pressM ?? 0)).toFixed(1); // wheel, trigger and pen change the penetration too
    if (document.activeElement === press || Number(press.value).toFixed(1) === mm) return;
    press.value = mm;
    show();
  });
  if (page.hand) hear(page.hand);
  show();
}

type Held = "gone" | "rests" | "holds" | "nobody" | "watches";

/** Return the holder of the hand, as a key of the words. */
export function holderOf(hand: Pick<HandState, "there" | "holding" | "nobodyHolds" | "rests">): Held {
  if (!hand.there) return "gone";
  if (hand.rests) return "rests";
  if (hand.holding) return "holds";
  return hand.nobodyHolds ? "nobody" : "watches";
}

function slider(): HTMLInputElement {
  const input = document.createElement("input");
  const mm = (metres: number): string => (1000 * metres).toFixed(1);
  return Object.assign(input, {
    id: "press", type: "range", min: mm(PRESS_M.least), max: mm(PRESS_M.most), step: "0.1", value: mm(PRESS_M.first),
  });
}

export const hand: Panel = { id: "hand", title: t("title"), task: "feel", open: true, build };
