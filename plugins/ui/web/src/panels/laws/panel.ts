/** Two laws on one hand: side by side, or blindly with a tally. */
import { button, field, hint } from "kit/elements";
import type { Events } from "kit/server/messages";
import type { Page } from "kit/page";
import type { Panel } from "../panel";
import { t } from "./words";

interface Tally {
  laws: [string, string];
  chosen: [number, number];
  neither: number;
  chance: number;
  path?: string;
}

const LETTERS = ["a", "b"] as const;

function build(page: Page, root: HTMLElement): void {
  const { hub, net } = page;
  const status = document.createElement("p");
  const result = document.createElement("ul");
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
  const two = group(t("felt"));
  const letters = LETTERS.map((to) => button(to, () => attempt(() => net.ask("switch_law", { to }))));
  const question = input("laws-question");
  question.value = t("questionFirst");
  two.append(
    ...letters,
    field(t("question"), question),
    hint(t("blindHelp")),
    button(t("blind"), () => attempt(() => net.ask("begin_blind", { question: question.value }))),
    button(t("end"), () => attempt(() => net.ask("end_laws"))),
  );
  const blind = group("");
  const asked = blind.querySelector("legend")!;
  const trial = document.createElement("p");
  const feel = ([1, 2] as const).map((called) => button(t(`feel${called}`), () => attempt(() => net.ask("feel_blind", { called }))));
  const choose = (choice: number): Promise<void> => attempt(() => net.ask("choose_blind", { choice }));
  blind.append(
    trial,
    ...feel,
    button(t("choose1"), () => choose(1)),
    button(t("choose2"), () => choose(2)),
    button(t("chooseNone"), () => choose(0)),
    button(t("reveal"), () => attempt(async () => reveal(await net.ask<Tally>("end_blind")))),
  );

  function reveal({ laws, chosen, neither, chance, path }: Tally): void {
    const lines = laws.map((law, i) => t("result", { law, count: chosen[i]! }));
    lines.push(t("neither", { count: neither }), t("chance", { percent: (100 * chance).toPrecision(2) }));
    if (path) lines.push(t("kept", { path }));
    result.replaceChildren(...lines.map((text) => Object.assign(document.createElement("li"), { textContent: text })));
    page.say(lines.slice(0, 2).join(" "));
  }

  function show(message: Events["laws"]): void {
    choice.hidden = message.state !== "one";
    two.hidden = message.state !== "two";
    blind.hidden = message.state !== "blind";
    if (message.state === "two") {
      letters.forEach((each, i) => {
        each.textContent = t("named", { letter: LETTERS[i]!, law: message.named[i]! });
        each.setAttribute("aria-pressed", String(message.felt === i));
      });
      say(t("feeling", { letter: LETTERS[message.felt]!, law: message.named[message.felt]! }));
    } else if (message.state === "blind") {
      asked.textContent = message.question;
      trial.textContent = t("trial", { number: message.trials + 1, called: message.called });
      feel.forEach((each, i) => each.setAttribute("aria-pressed", String(message.called === i + 1)));
      page.say(trial.textContent);
    } else status.textContent = "";
  }

  hub.on("laws", show);
  show({ event: "laws", at_s: 0, state: "one" });
  root.append(hint(t("about")), choice, two, blind, result, status);
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
  const law = document.createElement("select");
  law.id = "laws-other";
  const options = input("laws-options");
  options.spellcheck = false;
  const help = hint(t("optionsHelp"));
  help.id = "laws-options-help";
  options.setAttribute("aria-describedby", help.id);
  box.append(field(t("other"), law), field(t("options"), options), help);
  box.append(button(t("begin"), () => begin(law.value, options.value)));
  return box;
}

function group(title: string): HTMLFieldSetElement {
  const box = document.createElement("fieldset");
  const legend = document.createElement("legend");
  legend.textContent = title;
  box.append(legend);
  return box;
}

function input(id: string): HTMLInputElement {
  const control = document.createElement("input");
  control.id = id;
  return control;
}

export const laws: Panel = { id: "laws", title: t("title"), task: "feel", open: false, build };
