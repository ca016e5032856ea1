/** The log panel, with filters and search. */
import { button, labelled, make } from "kit/elements";
import { download } from "../../files";
import type { Events } from "kit/server/messages";
import type { Page } from "kit/page";
import type { Panel } from "../panel";
import { recall, remember } from "kit/preferences";
import { t } from "./words";
import { productName } from "../../words/product_words";
import { decimal, language } from "kit/words/words";
import { asText, LEVELS, Lines, isShown, type Level, type Line } from "./lines";
import "./log.css";

const AT_FIRST: Record<Level, boolean> = { event: true, detail: false, warning: true, error: true };

class Log {
  private lines = new Lines();
  private items = new Map<Line, HTMLElement>();
  private levels = new Set(LEVELS.filter((each) => recall(`log.${each}`, AT_FIRST[each])));
  private wanted = "";
  private list = document.createElement("ol");
  private count = document.createElement("output");
  private fresh: Line[] = [];

  constructor(
    private page: Page,
    private root: HTMLElement,
  ) {
    const box = make("div", { id: "log", tabIndex: 0 });
    box.setAttribute("role", "log");
    box.setAttribute("aria-live", "off"); // the announcer reads what matters; a person can choose to hear every line
    this.page.hub.on("read log", ({ on }) => box.setAttribute("aria-live", on ? "polite" : "off"));
    box.setAttribute("aria-label", t("lines"));
    box.append(this.list);
    this.root.append(this.tools(), box);
    this.listen();
    this.show();
  }

  private tools(): HTMLElement {
    const tools = make("div", { className: "log-tools" });
    const filters = document.createElement("div");
    filters.setAttribute("role", "group");
    filters.setAttribute("aria-label", t("levels"));
    filters.append(...LEVELS.map((level) => this.filter(level)));
    const search = make("input", { type: "search", placeholder: t("search") });
    search.setAttribute("aria-label", t("search"));
    search.oninput = () => {
      this.wanted = search.value.trim();
      this.show();
      this.page.say(this.count.value, { topic: "log" });
    };
    const acts = make("div", { className: "log-acts" });
    acts.append(
      button(t("copy"), () => this.copy()),
      button(t("save"), () => this.save()),
      button(t("clear"), () => this.clear()),
    );
    tools.append(filters, search, this.count, acts);
    return tools;
  }

  private filter(level: Level): HTMLElement {
    return check(t(level), this.levels.has(level), (on) => {
      if (on) this.levels.add(level);
      else this.levels.delete(level);
      remember(`log.${level}`, on);
      this.show();
    });
  }

  private listen(): void {
    const { hub } = this.page;
    hub.on("stage", (stage) => this.stage(stage));
    hub.on("made", ({ at_s, outcome, why }) => {
      if (outcome === "failed") this.add("error", "", at_s, why);
      if (outcome === "stopped") this.add("event", t("makingStopped"), at_s);
    });
    hub.on("touch", ({ at_s, law, how }) => this.add("event", `${t("felt", { law })}: `, at_s, how));
    hub.on("loop", ({ at_s, running, why }) => this.add("event", `${t(running ? "running" : "stopped")} `, at_s, why));
    hub.on("scene", ({ at_s, name }) => this.add("event", t("shown", { name }), at_s));
    hub.on("log", ({ at_s, level, logger, text }) => {
      if (!logger.endsWith(".progress")) this.add(level, `${logger}: `, at_s, text); // the head of the page has it
    });
    hub.on("error", ({ at_s, text }) => this.add("error", "", at_s, text));
    hub.on("gone", ({ at_s }) => this.add("error", t("gone"), at_s));
  }

  private stage({ at_s, product, method, done: { outcome, seconds, why } }: Events["stage"]): void {
    if (!outcome) return this.add("detail", t("begun", { product: productName(product), method }), at_s);
    const told = { product: productName(product), method, outcome: t(outcome), seconds: decimal(seconds ?? 0, 3) };
    this.add(outcome === "failed" ? "error" : "event", `${t(method ? "stage" : "given by", told)}${why ? ": " : ""}`, at_s, why);
  }

  /** Add a line; many lines at once are rendered together. */
  private add(level: Level, own: string, at_s: number, foreign = ""): void {
    const text = own + foreign;
    const { line, again, dropped } = this.lines.add(level, text, at_s, foreign);
    if (dropped) {
      this.items.get(dropped)?.remove();
      this.items.delete(dropped);
    }
    if (level === "warning") this.page.say(t("said", { level: t(level), text: foreign }));
    if (!again || !this.items.has(line)) this.fresh.push(line);
    else fill(this.items.get(line)!, line);
    if (this.fresh.length === 1) setTimeout(() => this.flush());
  }

  private flush(): void {
    const follows = this.follows;
    const made = this.fresh.splice(0).filter((line) => this.lines.all.includes(line) && !this.items.has(line));
    for (const line of made) this.items.set(line, fill(document.createElement("li"), line));
    for (const line of made) this.items.get(line)!.hidden = !isShown(line, this.levels, this.wanted);
    this.list.append(...made.map((line) => this.items.get(line)!));
    this.tell();
    if (follows) this.scroller.scrollTop = this.scroller.scrollHeight;
  }

  private get scroller(): HTMLElement {
    const region = this.root.closest<HTMLElement>(".region")!;
    return getComputedStyle(region).overflowY === "auto" ? region : this.list.parentElement!;
  }

  /** True if the end is in sight: then new lines are scrolled to. */
  private get follows(): boolean {
    const { scrollTop, clientHeight, scrollHeight } = this.scroller;
    return scrollTop + clientHeight >= scrollHeight - 40;
  }

  private get shown(): Line[] {
    return this.lines.all.filter((line) => isShown(line, this.levels, this.wanted));
  }

  private show(): void {
    for (const [line, item] of this.items) item.hidden = !isShown(line, this.levels, this.wanted);
    this.tell();
  }

  private tell(): void {
    const [all, shown] = [this.lines.all.length, this.shown.length];
    this.count.value = t(all === shown ? "count" : "countOf", { all, shown });
  }

  private async copy(): Promise<void> {
    try {
      await navigator.clipboard.writeText(asText(this.shown));
      this.page.say(t("copied", { count: this.shown.length }), { asked: true });
    } catch {
      getSelection()?.selectAllChildren(this.list); // the browser forbids copying: Ctrl+C then works
      this.page.say(t("selected"), { asked: true });
    }
  }

  private save(): void {
    download(asText(this.shown), "tangible-log.txt", "text/plain");
  }

  private clear(): void {
    this.lines.clear();
    this.items.clear();
    this.fresh.length = 0;
    this.list.replaceChildren();
    this.tell();
    this.page.say(t("cleared"), { asked: true });
  }
}

function fill(item: HTMLElement, { level, text, foreign, at_s, times }: Line): HTMLElement {
  item.dataset.level = level;
  const at = document.createElement("time");
  const date = new Date(1000 * at_s);
  at.dateTime = date.toISOString();
  at.textContent = date.toLocaleTimeString(language);
  const mark = make("span", { className: "level", textContent: t(`one ${level}`) });
  const span = make("span", { textContent: foreign });
  item.replaceChildren(at, " ", mark, " ", text.slice(0, text.length - foreign.length), span);
  if (times > 1) item.append(" ", t("times", { times }));
  return item;
}

function check(text: string, on: boolean, change: (on: boolean) => void): HTMLElement {
  const input = make("input", { type: "checkbox", checked: on });
  input.onchange = () => change(input.checked);
  return labelled(input, text);
}

export const log: Panel = {
  id: "log-panel",
  title: t("title"),
  task: "log",
  open: true,
  build: (page, root) => void new Log(page, root),
};
