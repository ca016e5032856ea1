/** Preflight: verdicts on safety and perceptibility, with cures that change the document. */
import { button, make, paragraph } from "kit/elements";
import { DocumentEditor } from "../../forms/editor";
import type { Judged } from "kit/server/messages";
import type { Page } from "kit/page";
import type { Panel } from "../panel";
import { t } from "./words";
import { type Cure, gradeSentence, verdictTables } from "../verdicts/verdicts";
import "../verdicts/verdicts.css";

type Fixed = { changes: Record<string, string | number>; safe: boolean; sentence: string } | null;

function build(page: Page, root: HTMLElement): void {
  const editor = new DocumentEditor(page);
  const about = paragraph(t("about"), "hint");
  const status = document.createElement("p");
  status.setAttribute("role", "status");
  const stale = paragraph(t("stale"), "warn");
  stale.hidden = true;
  const results = document.createElement("div");
  editor.onRefused = (why) => (status.textContent = why);
  let judged: Judged | null = null;

  const work = async (name: "preflight" | "fix"): Promise<void> => {
    status.textContent = t("checking");
    try {
      const answer = await page.net.ask<Fixed>(name, name === "fix" ? { apply: editor.apply } : {});
      status.textContent = name === "fix" ? fixedInWords(answer) : answer ? "" : t("stopped");
    } catch (error) {
      status.textContent = (error as Error).message;
    }
  };
  const check = button(t("check"), () => work("preflight"), { id: "preflight-check" });
  const fix = button(t("fix"), () => work("fix"), { id: "preflight-fix", hidden: true });
  const buttons = make("div", { className: "buttons" });
  buttons.append(check, fix);
  root.append(about, buttons, status, stale, results);

  const age = (): void => void (stale.hidden = !judged || judged.digest === page.document?.digest);
  page.hub.on("preflight", (message) => {
    judged = message;
    check.textContent = t("again");
    fix.hidden = !message.verdicts.some(({ changes }) => changes.length);
    results.replaceChildren(...verdictElements(message, cure));
    age();
  });
  page.hub.on("document", age);

  function cure(...[key, value]: Parameters<Cure>): void {
    void editor.submit({ changes: { [key]: value } }).then((done) => (done ? work("preflight") : undefined));
  }
}

function verdictElements(judgement: Judged, cure: Cure): HTMLElement[] {
  const device = judgement.device ? t("device", { device: judgement.device, law: judgement.law }) : t("ownHand", { law: judgement.law });
  const about = paragraph(`${device} ${t(judgement.of_loop ? "ofLoop" : "ofMaker")}`, "hint");
  return [gradeSentence(judgement.grade, judgement.sentence), about, ...verdictTables(judgement.verdicts, cure)];
}

function fixedInWords(fixed: Fixed): string {
  if (!fixed) return t("stopped");
  const changes = Object.entries(fixed.changes).map(([key, value]) => `${key}: ${value}`);
  const changed = changes.length ? t("fixed", { changes: changes.join(", ") }) : t("nothing");
  return fixed.safe ? changed : `${changed} ${t("notFixed", { sentence: fixed.sentence })}`;
}

export const preflight: Panel = { id: "preflight", title: t("title"), task: "advanced", open: false, build };
