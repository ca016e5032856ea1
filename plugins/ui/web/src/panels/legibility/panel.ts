/** Verdicts of legibility by medium; their places on the surface and in words; their cures as buttons. */
import { button, field, hint, paragraph } from "../../elements";
import { Editor } from "../../forms/editor";
import type { Legible, Medium } from "../../server/messages";
import type { Page } from "../../page";
import { t } from "./words";
import { decimal } from "../../words/words";
import { type Cure, sentence, verdicts } from "../verdicts/verdicts";
import { Marks } from "./fault_marks";
import { faults, places } from "./fault_list";

const MEDIA: Medium[] = ["swell", "print", "pins", "force"];
const SIMPLIFY = "simplify";
const WIDTH_MM = { least: 10, most: 2000 };

export function build(page: Page, root: HTMLElement): void {
  const editor = new Editor(page);
  const marks = new Marks(page);
  const medium = choice();
  const width = widthField();
  const told = document.createElement("p");
  told.setAttribute("role", "status");
  editor.onRefused = (why) => (told.textContent = why);
  const stale = paragraph(t("stale"), "warn");
  stale.hidden = true;
  const found = document.createElement("div");
  const marked = ticked(t("marks"), () => age());
  marked.input.checked = true;
  marked.root.hidden = true;
  const coloured = ticked(t("parts"), (on) => page.hub.tell("look at", { look: on ? "segments" : "photo" }));
  coloured.root.hidden = true;
  page.hub.on("look", ({ look }) => (coloured.input.checked = look === "segments"));
  coloured.input.checked = page.hub.last("look")?.look === "segments";
  let judged: Legible | null = null;

  const work = async (): Promise<void> => {
    if (!width.reportValidity()) return;
    told.textContent = t("checking");
    const width_m = width.value ? width.valueAsNumber / 1000 : null;
    try {
      const said = await page.net.ask<Legible | null>("legible", { medium: medium.value, width_m });
      told.textContent = said ? "" : t("stopped");
      if (said) page.say(said.sentence, { topic: "legible", asked: true });
    } catch (error) {
      told.textContent = (error as Error).message;
    }
  };
  const check = button(t("check"), work);
  check.id = "legible-check";
  const buttons = document.createElement("div");
  buttons.className = "buttons";
  buttons.append(check);
  const widthBox = field(t("width"), width);
  widthBox.append(Object.assign(hint(t("widthHint")), { id: "legible-width-hint" }));
  root.append(hint(t("about")), field(t("medium"), medium), widthBox, buttons, told, stale, found, marked.root, coloured.root);

  const age = (): void => {
    stale.hidden = !judged || judged.digest === page.document?.digest;
    marks.visible = stale.hidden && marked.input.checked;
  };
  const cure: Cure = (key, value) => {
    void editor.changed({ changes: { [key]: value } }).then((done) => (done ? work() : undefined));
  };
  const show = (said: Legible): void => {
    judged = said;
    check.textContent = t("again");
    medium.value = said.medium;
    const failing = faults(said.verdicts);
    const more = (each: Legible["verdicts"][number]): HTMLElement | null =>
      failing.has(each) ? places(page, each, failing.get(each)!, marks) : null;
    const of = paragraph(t("of", { medium: t(`${said.medium}Of`), width: decimal(1000 * said.width_m, 0) }), "hint");
    found.replaceChildren(sentence(said.grade, said.sentence), of, ...simplifying(said, editor, work), ...verdicts(said.verdicts, cure, more));
    const all = [...failing.values()].flat();
    marked.root.hidden = !all.length;
    coloured.root.hidden = false;
    marks.put(all);
    age();
  };
  page.hub.on("legible", show);
  page.hub.on("document", age);
  const before = page.hub.last("legible");
  if (before) show(before);
}

/** Everything that would make parts legible, as one edit; nothing where that is no cure. */
function simplifying({ verdicts: all }: Legible, editor: Editor, check: () => Promise<void>): HTMLElement[] {
  const wanted = all.flatMap((each) => each.changes).filter(({ key }) => key === SIMPLIFY || key.startsWith(`${SIMPLIFY}.`));
  if (!wanted.length) return [];
  const changes = Object.fromEntries(wanted.reverse().map(({ key, value }) => [key, value])); // the first of a key counts
  const written = Object.entries(changes).map(([key, value]) => `${key}: ${JSON.stringify(value)}`);
  const cure = button(t("simplify"), () => void editor.changed({ changes }).then((done) => (done ? check() : undefined)));
  cure.id = "legible-simplify";
  cure.className = "primary";
  const about = hint(t("simplifyHint", { changes: written.join(", ") }));
  about.id = "legible-simplify-hint";
  cure.setAttribute("aria-describedby", about.id);
  return [cure, about];
}

function choice(): HTMLSelectElement {
  const made = document.createElement("select");
  made.id = "legible-medium";
  for (const each of MEDIA) made.add(new Option(t(each), each));
  return made;
}

function widthField(): HTMLInputElement {
  const made = document.createElement("input");
  Object.assign(made, { id: "legible-width", type: "number", min: `${WIDTH_MM.least}`, max: `${WIDTH_MM.most}`, step: "any" });
  made.setAttribute("aria-describedby", "legible-width-hint");
  return made;
}

function ticked(text: string, change: (on: boolean) => void): { root: HTMLLabelElement; input: HTMLInputElement } {
  const root = document.createElement("label");
  const input = document.createElement("input");
  input.type = "checkbox";
  input.onchange = () => change(input.checked);
  root.append(input, text);
  return { root, input };
}
