/** Two laws on one hand, side by side; and a blind study of both. */
import { button, field, fieldset, hint, make } from "kit/elements";
import type { Events } from "kit/server/messages";
import type { Page } from "kit/page";
import { language } from "kit/words/words";
import type { Panel } from "../panel";
import { t } from "./words";

/** A study that was written: its file, and the commands that run and analyse it. */
interface Study {
  file: string;
  run: string;
  analyse: string;
}

const LETTERS = ["a", "b"] as const;

function build(page: Page, root: HTMLElement): void {
  const { hub, net } = page;
  const status = document.createElement("p");
  const written = document.createElement("div");
  const attempt = async (work: () => Promise<unknown>): Promise<void> => {
    try {
      await work();
    } catch (error) {
      say(t("failed", { why: (error as Error).message }));
    }
  };
  const say = (text: string): void => {
    status.textContent = text;
    page.say(text);
  };

  const choice = setup((use, options) => attempt(() => net.ask("compare_laws", { use, options })));
  const two = fieldset(t("felt"));
  const letters = LETTERS.map((to) => button(to, () => attempt(() => net.ask("switch_law", { to }))));
  const question = make("select", { id: "laws-question" });
  question.append(...(["same", "rougher", "higher"] as const).map((each) => new Option(t(each), each)));
  const study = async (): Promise<void> => {
    const asked = { question: question.value, language: language === "de" ? "de" : "en" };
    const { file, run, analyse } = await net.ask<Study>("study_laws", asked);
    written.replaceChildren(hint(t("studyHow")), ...[run, analyse].map(command));
    say(t("studyWritten", { file }));
  };
  two.append(
    ...letters,
    field(t("question"), question),
    hint(t("studyHelp")),
    button(t("study"), () => attempt(study)),
    button(t("end"), () => attempt(() => net.ask("end_laws"))),
  );
  function show(message: Events["laws"]): void {
    choice.hidden = message.state !== "one";
    two.hidden = message.state !== "two";
    if (message.state === "one") written.replaceChildren();
    if (message.state === "two") {
      letters.forEach((each, i) => {
        each.textContent = t("named", { letter: LETTERS[i]!, law: message.named[i]! });
        each.setAttribute("aria-pressed", String(message.felt === i));
      });
      say(t("feeling", { letter: LETTERS[message.felt]!, law: message.named[message.felt]! }));
    } else status.textContent = "";
  }

  hub.on("laws", show);
  show({ event: "laws", at_s: 0, state: "one" });
  root.append(hint(t("about")), choice, two, status, written);
  let known = false;
  hub.on("touch", () => {
    if (known) return;
    known = true;
    void net.ask<string[]>("law_names").then((names) => {
      const select = choice.querySelector("select")!;
      select.replaceChildren(...names.map((name) => new Option(name)));
    }, () => (known = false));
  });
}

function setup(begin: (use: string, options: string) => Promise<void>): HTMLElement {
  const box = document.createElement("div");
  const law = make("select", { id: "laws-other" });
  const options = input("laws-options");
  options.spellcheck = false;
  const help = hint(t("optionsHelp"));
  help.id = "laws-options-help";
  options.setAttribute("aria-describedby", help.id);
  box.append(field(t("other"), law), field(t("options"), options), help);
  box.append(button(t("begin"), () => begin(law.value, options.value)));
  return box;
}

function command(text: string): HTMLPreElement {
  return make("pre", { textContent: text });
}

function input(id: string): HTMLInputElement {
  const control = make("input", { id });
  return control;
}

export const laws: Panel = { id: "laws", title: t("title"), task: "feel", open: false, build };
