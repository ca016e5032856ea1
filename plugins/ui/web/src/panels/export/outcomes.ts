/** Outcome of each exporter: files, decisions, and tactile legibility. */
import { foldable, make, paragraph } from "kit/elements";
import { token } from "kit/server/token";
import type { Exported, Outcome } from "kit/server/messages";
import { t } from "./words";
import { decimal } from "kit/words/words";
import { type Cure, gradeSentence, verdictTables } from "../verdicts/verdicts";
import { exporterName } from "./choices";

const SHAPES: Partial<Record<Outcome["outcome"], string>> = { ran: "✓", refused: "⊘", failed: "✕" };
const UNITS = [["megabytes", 1e6, 1], ["kilobytes", 1e3, 0], ["bytes", 1, 0]] as const;

export function outcomes(exported: Exported, cure: Cure): HTMLElement[] {
  return exported.exports.map((each) => outcome(exported.folder, each, cure));
}

/** Return the address of an exported file, with this page's key. */
export function address(folder: string, name: string): string {
  return `/export/${folder}/${encodeURIComponent(name)}?token=${encodeURIComponent(token)}`;
}

function outcome(folder: string, exported: Exported["exports"][number], cure: Cure): HTMLElement {
  const box = make("section", { className: `outcome ${exported.outcome}` });
  const heading = make("h3", { textContent: exporterName(exported.name) });
  const became = make("span", { className: "became" });
  const known = exported.outcome === "refused" || exported.outcome === "failed" ? exported.outcome : "ran";
  const seconds = known === "ran" ? t("seconds", { seconds: decimal(exported.seconds, 1) }) : "";
  became.append(symbolOf(known), [t(known), seconds].filter(Boolean).join(", "));
  box.append(heading, became);
  if (known !== "ran") box.append(paragraph(exported.why, "bad"));
  if (exported.files.length) box.append(files(folder, exported.files));
  if (exported.legible) box.append(legible(exported.legible, cure));
  if (exported.notes.length) box.append(notes(exported.notes));
  return box;
}

function files(folder: string, all: Exported["exports"][number]["files"]): HTMLElement {
  const list = make("ul", { className: "files" });
  for (const { name, bytes } of all) {
    const link = make("a", { href: address(folder, name), download: name, textContent: name });
    const item = document.createElement("li");
    const size = make("span", { className: "size", textContent: formatBytes(bytes) });
    item.append(link, " ", size);
    list.append(item);
  }
  return list;
}

function legible(judgement: NonNullable<Exported["exports"][number]["legible"]>, cure: Cure): HTMLElement {
  const box = document.createElement("div");
  box.append(gradeSentence(judgement.grade, judgement.sentence));
  const wrong = judgement.verdicts.filter(({ verdict }) => verdict !== "ok");
  if (wrong.length) box.append(foldable(t("verdicts", { count: wrong.length }), ...verdictTables(wrong, cure)));
  return box;
}

function notes(all: Outcome["notes"]): HTMLElement {
  return foldable(t("notes", { count: all.length }), ...all.map(({ kind, text }) => paragraph(text, kind === "decision" ? "hint" : "hint warn")));
}

function symbolOf(known: Outcome["outcome"]): HTMLElement {
  const span = document.createElement("span");
  span.setAttribute("aria-hidden", "true");
  span.textContent = `${SHAPES[known] ?? ""} `;
  return span;
}

export function formatBytes(bytes: number): string {
  const [unit, of, digits] = UNITS.find((each) => bytes >= each[1]) ?? UNITS[2];
  return t(unit, { size: decimal(bytes / of, digits) });
}
