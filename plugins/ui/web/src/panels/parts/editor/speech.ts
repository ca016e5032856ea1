/** The texts of the parts editor: its status line, and what it announces. */
import type { Page } from "kit/page";
import { heightOf, nameOf, placeOf, shareOf } from "./part_words";
import type { EditorState, Notice } from "./state";
import { t } from "./words";

const PAINTING = ["brush", "lasso", "propose"];

export const nameIn = (state: EditorState, label: number): string => nameOf(state.drawing.part(label), state.numberOf(label));

/** Return what the tool in use does, and to which part. */
export function helpOf(state: EditorState): string {
  const { tools, drawing } = state;
  const help = drawing.proposed ? t("proposed") : t(`${tools.tool}Help`);
  if (!PAINTING.includes(tools.tool)) return help;
  const isNew = drawing.proposed || tools.tool === "propose" ? !tools.addsTo : tools.newPart;
  if (drawing.proposed) return `${help} ${isNew ? t("becomesNew") : t("isAdded", { name: nameIn(state, drawing.selected) })}`;
  return `${help} ${isNew ? t("intoFresh") : t("into", { name: nameIn(state, drawing.selected) })}`;
}

export function textOf(state: EditorState, { word, values, label = state.drawing.selected }: Notice): string {
  return t(word, { name: label < 0 ? t("outside") : nameIn(state, label), ...values });
}

/** Announce what changes in the editor. */
export function announce(state: EditorState, say: Page["say"]): void {
  const { events, drawing, tools } = state;
  events.on("notice", (notice) => say(textOf(state, notice), { topic: "parts" }));
  events.on("where", (notice) => say(textOf(state, notice), { topic: "cross", asked: true }));
  events.on("selected", (label) => {
    const text = describe(state, label);
    if (text) say(text, { topic: "parts", asked: true });
  });
  events.on("reordered", () => say(orderOf(state), { topic: "parts", asked: true }));
  events.on("tool", (tool) => say(tool === "newPart" ? helpOf(state) : `${t(tool)}. ${helpOf(state)}`, { topic: "tool", asked: true }));
  events.on("width", (count) => say(t("pixels", { count }), { topic: "tool", asked: true }));
  events.on("entered", (label) => say(nameIn(state, label), { topic: "cross" }));
  events.on("pen", (what) => {
    if (what === "proposed") say(t("proposed"), { topic: "tool" });
    else say(t(what, { tool: t(tools.tool) }), { topic: "tool", asked: what === "down" });
  });

  function orderOf(state: EditorState): string {
    const part = drawing.part(drawing.selected)!;
    const before = drawing.parts.filter((each) => each.height_m > part.height_m).length;
    return t("order", { name: nameIn(state, part.label), place: before + 1, count: drawing.parts.length, height: heightOf(part) });
  }
}

/** Return a sentence about a part: name, height, size, place; empty for a part without pixels. */
export function describe(state: EditorState, label: number): string {
  const { drawing, places } = state;
  const [part, place] = [drawing.part(label), places.get(label)];
  if (!part || !place) return "";
  const values = { height: heightOf(part), share: shareOf(drawing.share(label)), place: placeOf(place, drawing.labels) };
  return t("said", { name: nameIn(state, label), ...values });
}
