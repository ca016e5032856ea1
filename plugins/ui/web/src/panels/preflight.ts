/** Preflight: what is safe and what will be felt, in words, with cures that change the document. */
import { button, headed } from "../elements";
import { Editor } from "../forms/editor";
import type { Judged, Verdict } from "../messages";
import type { Page } from "../page";
import type { Panel } from "../panel";
import { t } from "../words/preflight";
import "./preflight.css";

const SHAPES: Record<Verdict["verdict"], string> = { ok: "✓", warn: "▲", unsafe: "✕" };
type Fixed = { changes: Record<string, string | number>; safe: boolean; sentence: string } | null;

function build(page: Page, root: HTMLElement): void {
  const editor = new Editor(page);
  const about = paragraph(t("about"), "hint");
  const told = document.createElement("p");
  told.setAttribute("role", "status");
  const stale = paragraph(t("stale"), "warn");
  stale.hidden = true;
  const found = document.createElement("div");
  editor.onRefused = (why) => (told.textContent = why);
  let judged: Judged | null = null;

  const work = async (name: "preflight" | "fix"): Promise<void> => {
    told.textContent = t("checking");
    try {
      const answer = await page.net.ask<Fixed>(name, name === "fix" ? { apply: editor.apply } : {});
      told.textContent = name === "fix" ? fixedInWords(answer) : answer ? "" : t("stopped");
    } catch (error) {
      told.textContent = (error as Error).message;
    }
  };
  const check = button(t("check"), () => work("preflight"));
  check.id = "preflight-check";
  const fix = button(t("fix"), () => work("fix"));
  fix.id = "preflight-fix";
  fix.hidden = true;
  const buttons = document.createElement("div");
  buttons.className = "buttons";
  buttons.append(check, fix);
  root.append(about, buttons, told, stale, found);

  const age = (): void => void (stale.hidden = !judged || judged.digest === page.document?.digest);
  page.hub.on("preflight", (said) => {
    judged = said;
    check.textContent = t("again");
    fix.hidden = !said.verdicts.some(({ changes }) => changes.length);
    found.replaceChildren(...shown(said, (key, value) => cure(key, value)));
    age();
  });
  page.hub.on("document", age);

  function cure(key: string, value: string | number): void {
    void editor.changed({ changes: { [key]: value } }).then((done) => (done ? work("preflight") : undefined));
  }
}

function shown(said: Judged, cure: (key: string, value: string | number) => void): HTMLElement[] {
  const sentence = paragraph("", `sentence ${said.grade}`);
  sentence.lang = "en";
  sentence.append(mark(said.grade), said.sentence);
  const device = said.device ? t("device", { device: said.device, law: said.law }) : t("ownHand", { law: said.law });
  const about = paragraph(`${device} ${t(said.of_loop ? "ofLoop" : "ofMaker")}`, "hint");
  const wrong = said.verdicts.filter(({ verdict }) => verdict !== "ok");
  const fine = said.verdicts.filter(({ verdict }) => verdict === "ok");
  const made = [sentence, about];
  if (wrong.length) made.push(table(t("wrong"), wrong, cure));
  if (fine.length) made.push(folded(t("passed", { count: fine.length }), table(t("passed", { count: fine.length }), fine, cure)));
  return made;
}

function table(caption: string, verdicts: Verdict[], cure: (key: string, value: string | number) => void): HTMLElement {
  const made = headed(caption, [t("verdict"), t("what"), t("stands")], "verdicts");
  const body = made.createTBody();
  for (const each of verdicts) row(body, each, cure);
  return made;
}

function row(body: HTMLTableSectionElement, said: Verdict, cure: (key: string, value: string | number) => void): void {
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
  const more = [said.note, said.source, said.verdict === "ok" ? "" : said.cure].filter(Boolean);
  if (!more.length && !said.changes.length) return;
  const below = body.insertRow().insertCell();
  below.colSpan = 3;
  below.className = "below";
  for (const each of more.map((text) => paragraph(text, "hint"))) {
    each.lang = "en";
    below.append(each);
  }
  for (const { key, value } of said.changes) below.append(button(t("set", { key, value }), () => cure(key, value)));
}

function folded(title: string, inside: HTMLElement): HTMLElement {
  const box = document.createElement("details");
  const heading = document.createElement("summary");
  heading.textContent = title;
  box.append(heading, inside);
  return box;
}

/** The verdict's shape; its word stands beside it, or in the sentence. */
function mark(verdict: Verdict["verdict"]): HTMLElement {
  const made = document.createElement("span");
  made.className = "shape";
  made.setAttribute("aria-hidden", "true");
  made.textContent = `${SHAPES[verdict]} `;
  return made;
}

function paragraph(text: string, name: string): HTMLElement {
  const made = document.createElement("p");
  made.className = name;
  made.textContent = text;
  return made;
}

function fixedInWords(fixed: Fixed): string {
  if (!fixed) return t("stopped");
  const changes = Object.entries(fixed.changes).map(([key, value]) => `${key}: ${value}`);
  const changed = changes.length ? t("fixed", { changes: changes.join(", ") }) : t("nothing");
  return fixed.safe ? changed : `${changed} ${t("notFixed", { sentence: fixed.sentence })}`;
}

export const preflight: Panel = { id: "preflight", title: t("title"), place: "left", open: false, build };
