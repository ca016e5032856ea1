/** Verdicts as tables, each with what it stands on, its cure in words, and buttons that change the document. */
import { button, headed, paragraph } from "../../elements";
import type { Grade, Verdict } from "../../server/messages";
import { t } from "./words";

const SHAPES: Record<Grade, string> = { ok: "✓", warn: "▲", unsafe: "✕", illegible: "✕" };

/** Change this key of the document. */
export type Cure = (key: string, value: Setting) => void;
type Setting = Verdict["changes"][number]["value"];
/** What stands below a verdict beside its cure; null for nothing. */
export type More = (said: Verdict) => HTMLElement | null;

/** What failed first; what passed is folded. */
export function verdicts(all: Verdict[], cure: Cure, more: More = () => null): HTMLElement[] {
  const wrong = all.filter(({ verdict }) => verdict !== "ok");
  const fine = all.filter(({ verdict }) => verdict === "ok");
  const made = wrong.length ? [table(t("wrong"), wrong, cure, more)] : [];
  const passed = t("passed", { count: fine.length });
  return fine.length ? [...made, folded(passed, table(passed, fine, cure, more))] : made;
}

/** The whole in a sentence of the program, with its shape. */
export function sentence(grade: Grade, text: string): HTMLElement {
  const made = paragraph("", `sentence ${grade}`);
  made.lang = "en";
  made.append(mark(grade), text);
  return made;
}

function table(caption: string, all: Verdict[], cure: Cure, more: More): HTMLElement {
  const made = headed(caption, [t("verdict"), t("what"), t("stands")], "verdicts");
  const body = made.createTBody();
  const said = new Set<string>();
  /** A source, a cure or its button that several verdicts have stands at the first of them. */
  const fresh = (text: string): boolean => said.size !== said.add(text).size;
  for (const each of all) row(body, each, cure, more, fresh);
  return made;
}

function row(body: HTMLTableSectionElement, said: Verdict, cure: Cure, more: More, fresh: (text: string) => boolean): void {
  const made = body.insertRow();
  made.className = said.verdict;
  const verdict = made.insertCell();
  verdict.className = said.verdict;
  verdict.append(mark(said.verdict), t(said.verdict));
  const what = document.createElement("th");
  what.scope = "row";
  what.lang = "en";
  what.textContent = `${said.check}: ${said.of}`;
  made.append(what);
  made.insertCell().append(said.stands);
  const texts = [said.note, said.source, said.verdict === "ok" ? "" : said.cure].filter((text) => text && fresh(`${said.check} ${text}`));
  const changes = said.changes.filter((each) => fresh(JSON.stringify(each)));
  const also = more(said);
  if (!texts.length && !changes.length && !also) return;
  const below = body.insertRow().insertCell();
  below.colSpan = 3;
  below.className = "below";
  for (const each of texts.map((text) => paragraph(text, "hint"))) {
    each.lang = "en";
    below.append(each);
  }
  if (also) below.append(also);
  for (const { key, value } of changes) below.append(button(t("set", { key, value: written(value) }), () => cure(key, value)));
}

/** A value as the pipeline file writes it. */
function written(value: Setting): string {
  return typeof value === "string" ? value : JSON.stringify(value);
}

function folded(title: string, inside: HTMLElement): HTMLElement {
  const box = document.createElement("details");
  const heading = document.createElement("summary");
  heading.textContent = title;
  box.append(heading, inside);
  return box;
}

/** The verdict's shape; its word stands beside it, or in the sentence. */
function mark(verdict: Grade): HTMLElement {
  const made = document.createElement("span");
  made.className = "shape";
  made.setAttribute("aria-hidden", "true");
  made.textContent = `${SHAPES[verdict]} `;
  return made;
}
