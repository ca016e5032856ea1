/** Verdicts of tactile legibility by medium, with places and cures. */
import { button, field, hint, make, paragraph } from "kit/elements";
import { DocumentEditor } from "../../forms/editor";
import { onComingOrGoing } from "../../frame/tasks";
import type { Legible, Medium } from "kit/server/messages";
import type { Page } from "kit/page";
import { t } from "./words";
import { decimal } from "kit/words/words";
import { sentenceOf } from "../verdicts/cures";
import { type Cure, gradeSentence, verdictTables } from "../verdicts/verdicts";
import { FaultMarks } from "./fault_marks";
import { numberFaults, faultList } from "./fault_list";

const MEDIA: Medium[] = ["swell", "print", "pins", "force"];
const SIMPLIFY = "simplify";
const WIDTH_MM = { least: 10, most: 2000 };

export function build(page: Page, root: HTMLElement): void {
  const editor = new DocumentEditor(page);
  const marks = new FaultMarks(page, () => root.checkVisibility());
  onComingOrGoing(root.closest("details")!, () => (page.overlay.changed = true));
  const medium = choice();
  const width = widthField();
  const status = document.createElement("p");
  status.setAttribute("role", "status");
  editor.onRefused = (why) => (status.textContent = why);
  const stale = paragraph(t("stale"), "warn");
  stale.hidden = true;
  const results = document.createElement("div");
  const marked = checkbox(t("marks"), () => age());
  marked.input.checked = true;
  marked.root.hidden = true;
  const coloured = checkbox(t("parts"), (on) => page.hub.tell("look at", { look: on ? "segments" : "photo" }));
  coloured.root.hidden = true;
  page.hub.on("look", ({ look }) => (coloured.input.checked = look === "segments"));
  coloured.input.checked = page.hub.last("look")?.look === "segments";
  let judged: Legible | null = null;

  const work = async (): Promise<void> => {
    if (!width.reportValidity()) return;
    status.textContent = t("checking");
    const width_m = width.value ? width.valueAsNumber / 1000 : null;
    try {
      const legible = await page.net.ask<Legible | null>("legible", { medium: medium.value, width_m });
      status.textContent = legible ? "" : t("stopped");
      if (legible) page.say(legible.sentence, { topic: "legible", asked: true });
    } catch (error) {
      status.textContent = (error as Error).message;
    }
  };
  const check = button(t("check"), work, { id: "legible-check" });
  const buttons = make("div", { className: "buttons" });
  buttons.append(check);
  const widthBox = field(t("width"), width);
  widthBox.append(Object.assign(hint(t("widthHint")), { id: "legible-width-hint" }));
  root.append(hint(t("about")), field(t("medium"), medium), widthBox, buttons, status, stale, results, marked.root, coloured.root);

  const age = (): void => {
    stale.hidden = !judged || judged.digest === page.document?.digest;
    marks.visible = stale.hidden && marked.input.checked;
  };
  const cure: Cure = (key, value) => {
    if (key.startsWith("export.")) width.value = ""; // it is judged as export draws it from now on
    void editor.submit({ changes: { [key]: value } }).then((done) => (done ? work() : undefined));
  };
  const show = (verdict: Legible): void => {
    judged = verdict;
    check.textContent = t("again");
    medium.value = verdict.medium;
    const failing = numberFaults(verdict.verdicts);
    const more = (each: Legible["verdicts"][number]): HTMLElement | null =>
      failing.has(each) ? faultList(page, each, failing.get(each)!, marks) : null;
    const of = paragraph(t(verdict.simplified ? "ofSimplified" : "of", { medium: t(`${verdict.medium}Of`), width: decimal(1000 * verdict.width_m, 0) }), "hint");
    results.replaceChildren(gradeSentence(verdict.grade, verdict.sentence), of, ...simplifyButton(verdict, editor, work), ...verdictTables(verdict.verdicts, cure, more));
    const all = [...failing.values()].flat();
    marked.root.hidden = !all.length;
    coloured.root.hidden = false;
    marks.replace(all);
    age();
  };
  page.hub.on("legible", show);
  page.hub.on("document", age);
  const before = page.hub.last("legible");
  if (before) show(before);
}

/** Return a button that applies all simplifications as one edit, if there are any. */
function simplifyButton({ verdicts: all }: Legible, editor: DocumentEditor, check: () => Promise<void>): HTMLElement[] {
  const wanted = all.flatMap((each) => each.changes).filter(({ key }) => key === SIMPLIFY || key.startsWith(`${SIMPLIFY}.`));
  if (!wanted.length) return [];
  const changes = Object.fromEntries(wanted.reverse().map(({ key, value }) => [key, value])); // the first value of a key counts
  const written = Object.entries(changes).map(([key, value]) => sentenceOf(key, value));
  const cure = button(t("simplify"), () => void editor.submit({ changes }).then((done) => (done ? check() : undefined)));
  cure.id = "legible-simplify";
  cure.className = "primary";
  const about = hint(t("simplifyHint", { changes: written.join("; ") }));
  about.id = "legible-simplify-hint";
  cure.setAttribute("aria-describedby", about.id);
  return [cure, about];
}

function choice(): HTMLSelectElement {
  const select = make("select", { id: "legible-medium" });
  for (const each of MEDIA) select.add(new Option(t(each), each));
  return select;
}

function widthField(): HTMLInputElement {
  const input = make("input", { id: "legible-width", type: "number", min: `${WIDTH_MM.least}`, max: `${WIDTH_MM.most}`, step: "any" });
  input.setAttribute("aria-describedby", "legible-width-hint");
  return input;
}

function checkbox(text: string, change: (on: boolean) => void): { root: HTMLLabelElement; input: HTMLInputElement } {
  const root = document.createElement("label");
  const input = make("input", { type: "checkbox" });
  input.onchange = () => change(input.checked);
  root.append(input, text);
  return { root, input };
}
