/** Preflight: what is safe and what will be felt, in words, with cures that change the document. */
import { button, paragraph } from "../../elements";
import { Editor } from "../../forms/editor";
import type { Judged } from "../../server/messages";
import type { Page } from "../../page";
import type { Panel } from "../panel";
import { t } from "./words";
import { type Cure, sentence, verdicts } from "../verdicts/verdicts";
import "../verdicts/verdicts.css";

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
    found.replaceChildren(...shown(said, cure));
    age();
  });
  page.hub.on("document", age);

  function cure(...[key, value]: Parameters<Cure>): void {
    void editor.changed({ changes: { [key]: value } }).then((done) => (done ? work("preflight") : undefined));
  }
}

function shown(said: Judged, cure: Cure): HTMLElement[] {
  const device = said.device ? t("device", { device: said.device, law: said.law }) : t("ownHand", { law: said.law });
  const about = paragraph(`${device} ${t(said.of_loop ? "ofLoop" : "ofMaker")}`, "hint");
  return [sentence(said.grade, said.sentence), about, ...verdicts(said.verdicts, cure)];
}

function fixedInWords(fixed: Fixed): string {
  if (!fixed) return t("stopped");
  const changes = Object.entries(fixed.changes).map(([key, value]) => `${key}: ${value}`);
  const changed = changes.length ? t("fixed", { changes: changes.join(", ") }) : t("nothing");
  return fixed.safe ? changed : `${changed} ${t("notFixed", { sentence: fixed.sentence })}`;
}

export const preflight: Panel = { id: "preflight", title: t("title"), place: "left", open: false, build };
