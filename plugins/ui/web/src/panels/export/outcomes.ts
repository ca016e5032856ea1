/** What became of each exporter: its files, what was decided, and whether fingers can read it. */
import { paragraph } from "../../elements";
import { token } from "../../server/token";
import type { Exported, Outcome } from "../../server/messages";
import { t } from "./words";
import { decimal } from "../../words/words";
import { type Cure, sentence, verdicts } from "../verdicts/verdicts";
import { called } from "./choices";

const SHAPES: Partial<Record<Outcome["outcome"], string>> = { ran: "✓", refused: "⊘", failed: "✕" };
const UNITS = [["megabytes", 1e6, 1], ["kilobytes", 1e3, 0], ["bytes", 1, 0]] as const;

export function outcomes(said: Exported, cure: Cure): HTMLElement[] {
  return said.exports.map((each) => outcome(said.folder, each, cure));
}

/** An address of the server's; the key is that of this page. */
export function address(folder: string, name: string): string {
  return `/export/${folder}/${encodeURIComponent(name)}?token=${encodeURIComponent(token)}`;
}

function outcome(folder: string, said: Exported["exports"][number], cure: Cure): HTMLElement {
  const box = document.createElement("section");
  box.className = `outcome ${said.outcome}`;
  const heading = document.createElement("h3");
  heading.textContent = called(said.name);
  const became = document.createElement("span");
  became.className = "became";
  const known = said.outcome === "refused" || said.outcome === "failed" ? said.outcome : "ran";
  const seconds = known === "ran" ? t("seconds", { seconds: decimal(said.seconds, 1) }) : "";
  became.append(shape(known), [t(known), seconds].filter(Boolean).join(", "));
  box.append(heading, became);
  if (known !== "ran") box.append(english(said.why, "bad"));
  if (said.files.length) box.append(files(folder, said.files));
  if (said.legible) box.append(legible(said.legible, cure));
  if (said.notes.length) box.append(notes(said.notes));
  return box;
}

function files(folder: string, all: Exported["exports"][number]["files"]): HTMLElement {
  const list = document.createElement("ul");
  list.className = "files";
  for (const { name, bytes } of all) {
    const link = document.createElement("a");
    link.href = address(folder, name);
    link.download = name;
    link.textContent = name;
    const item = document.createElement("li");
    const size = document.createElement("span");
    size.className = "size";
    size.textContent = sized(bytes);
    item.append(link, " ", size);
    list.append(item);
  }
  return list;
}

function legible(said: NonNullable<Exported["exports"][number]["legible"]>, cure: Cure): HTMLElement {
  const box = document.createElement("div");
  box.append(sentence(said.grade, said.sentence));
  const wrong = said.verdicts.filter(({ verdict }) => verdict !== "ok");
  if (wrong.length) box.append(folded(t("verdicts", { count: wrong.length }), verdicts(wrong, cure)));
  return box;
}

function notes(all: Outcome["notes"]): HTMLElement {
  return folded(t("notes", { count: all.length }), all.map(({ kind, text }) => english(text, kind === "decision" ? "hint" : "hint warn")));
}

function folded(title: string, inside: HTMLElement[]): HTMLElement {
  const box = document.createElement("details");
  const heading = document.createElement("summary");
  heading.textContent = title;
  box.append(heading, ...inside);
  return box;
}

function english(text: string, className: string): HTMLElement {
  const made = paragraph(text, className);
  made.lang = "en";
  return made;
}

function shape(known: Outcome["outcome"]): HTMLElement {
  const made = document.createElement("span");
  made.setAttribute("aria-hidden", "true");
  made.textContent = `${SHAPES[known] ?? ""} `;
  return made;
}

export function sized(bytes: number): string {
  const [unit, of, digits] = UNITS.find((each) => bytes >= each[1]) ?? UNITS[2];
  return t(unit, { size: decimal(bytes / of, digits) });
}
