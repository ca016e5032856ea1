/** Verdicts as tables, with source, cure in words, and buttons that change the document. */
import { button, foldable, make, paragraph, tableWithHeads } from "kit/elements";
import type { Grade, Verdict } from "kit/server/messages";
import { distinct, restOf, sentenceOf } from "./cures";
import { t } from "./words";

const SHAPES: Record<Grade, string> = { ok: "✓", warn: "▲", unsafe: "✕", illegible: "✕" };

/** Changes a key of the document. */
export type Cure = (key: string, value: Setting) => void;
type Setting = Verdict["changes"][number]["value"];
/** Returns an element below a verdict; null for none. */
export type More = (said: Verdict) => HTMLElement | null;

/** Return tables of verdicts: failed ones first, passed ones folded. */
export function verdictTables(verdicts: Verdict[], cure: Cure, more: More = () => null): HTMLElement[] {
  const all = distinct(verdicts);
  const wrong = all.filter(({ verdict }) => verdict !== "ok");
  const fine = all.filter(({ verdict }) => verdict === "ok");
  const element = wrong.length ? [table(t("wrong"), wrong, cure, more)] : [];
  const passed = t("passed", { count: fine.length });
  return fine.length ? [...element, foldable(passed, table(passed, fine, cure, more))] : element;
}

/** Return the program's overall sentence with its symbol. */
export function gradeSentence(grade: Grade, text: string): HTMLElement {
  const status = paragraph("", `sentence ${grade}`);
  status.append(mark(grade), text);
  return status;
}

function table(caption: string, all: Verdict[], cure: Cure, more: More): HTMLElement {
  const tableElement = tableWithHeads(caption, [t("verdict"), t("what"), t("stands")], "verdicts");
  const body = tableElement.createTBody();
  const said = new Set<string>();
  /** Return whether a source, cure or button is new: repeated ones are shown once. */
  const fresh = (text: string): boolean => said.size !== said.add(text).size;
  for (const each of all) row(body, each, cure, more, fresh);
  return tableElement;
}

function row(body: HTMLTableSectionElement, said: Verdict, cure: Cure, more: More, fresh: (text: string) => boolean): void {
  const element = body.insertRow();
  element.className = said.verdict;
  const verdict = element.insertCell();
  verdict.className = said.verdict;
  verdict.append(mark(said.verdict), t(said.verdict));
  const what = make("th", { scope: "row", textContent: `${said.check}: ${said.of}` });
  element.append(what);
  element.insertCell().append(withUnits(said.stands));
  const texts = [said.note, said.source, said.verdict === "ok" ? "" : restOf(said)].filter((text) => text && fresh(`${said.check} ${text}`)).map(withUnits);
  const changes = said.changes.filter((each) => fresh(JSON.stringify(each)));
  const also = more(said);
  if (!texts.length && !changes.length && !also) return;
  const below = body.insertRow().insertCell();
  below.colSpan = 3;
  below.className = "below";
  below.append(...texts.map((text) => paragraph(text, "hint")));
  if (also) below.append(also);
  for (const { key, value } of changes) below.append(button(sentenceOf(key, value), () => cure(key, value)));
}

/** Return a text of the program, which writes micrometres as a terminal can. */
const withUnits = (text: string): string => text.replace(/(\d) um\b/g, "$1 µm");

/** Return the verdict's symbol; its word is next to it, or in the sentence. */
function mark(verdict: Grade): HTMLElement {
  const span = make("span", { className: "shape" });
  span.setAttribute("aria-hidden", "true");
  span.textContent = `${SHAPES[verdict]} `;
  return span;
}
