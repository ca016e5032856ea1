/** List of the places at which a verdict fails, each with a button that leads there. */
import { button, make, paragraph } from "kit/elements";
import type { Verdict } from "kit/server/messages";
import type { Page } from "kit/page";
import { t } from "./words";
import { ninthOfPicture } from "kit/words/place_words";
import type { Fault, FaultMarks } from "./fault_marks";

/** Greatest number of places listed per verdict. */
const MOST = 9;

/** Return the failing places of all verdicts, numbered in order. */
export function numberFaults(verdicts: Verdict[]): Map<Verdict, Fault[]> {
  let number = 0;
  const failing = verdicts.filter((each) => each.verdict !== "ok" && each.at?.length);
  return new Map(failing.map((each) => [each, each.at!.slice(0, MOST).map((at) => ({ number: ++number, at }))]));
}

export function faultList(page: Page, verdict: Verdict, all: Fault[], marks: FaultMarks): HTMLElement {
  const box = make("div", { className: "places" });
  const list = document.createElement("ol");
  list.setAttribute("aria-label", t("places"));
  list.append(...all.map((each) => line(page, each, marks)));
  box.append(list);
  const rest = verdict.at!.length - all.length;
  if (rest) box.append(paragraph(t("more", { count: rest }), "hint"));
  return box;
}

function line(page: Page, fault: Fault, marks: FaultMarks): HTMLElement {
  const { number, at } = fault;
  const where = ninthOfPicture(...at);
  const part = partAt(page, at);
  const go = button(`${number}`, () => {
    marks.look(at);
    const [x, y] = at.map((share) => Math.round(100 * share));
    page.say(t("placeSaid", { number, x, y, part: part || t("noPart") }), { topic: "place", asked: true });
  });
  const words = part ? t("placeIn", { number, where, part }) : t("place", { number, where });
  go.className = "chip";
  go.title = words;
  go.setAttribute("aria-label", words);
  for (const name of ["mouseenter", "focus"]) go.addEventListener(name, () => marks.point(number));
  for (const name of ["mouseleave", "blur"]) go.addEventListener(name, () => marks.point(null));
  const item = document.createElement("li");
  item.append(go);
  return item;
}

function partAt({ scene }: Page, [x, y]: [number, number]): string {
  if (!scene) return "";
  const [w, l] = scene.meta.extent_m;
  return scene.part((x - 0.5) * w, (0.5 - y) * l);
}
