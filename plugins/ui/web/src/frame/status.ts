/** The head of the page: what goes on, the stop button, and who holds the hand. */
import type { Page } from "../page";
import { on } from "../shortcuts";
import { t } from "./words";
import { made } from "../words/product_words";
import { language } from "../words/words";

type What = "idle" | "busy" | "felt" | "stopped" | "error";

export class Status {
  private line = document.getElementById("status")!;
  /** What is so while nothing is made: forces are given, or not. */
  private rest: "idle" | "felt" = "idle";

  constructor(private page: Page) {
    const { hub } = page;
    this.give("hold", t("takeHand"), () => this.ask("hold"));
    this.give("again", t("feelAgain"), () => void this.page.net.feel().catch((error: Error) => this.show("error", error.message)));
    this.stopButton();
    this.line.textContent = t("starting");
    new ResizeObserver(() => this.reach()).observe(this.line);
    hub.on("gone", () => this.show("error", t("gone"), "gone"));
    hub.on("refused", ({ why }) => this.show("error", t(why === "key" ? "wrongKey" : "loadAgain"), "gone"));
    hub.on("hello", () => page.forget("gone"));
    hub.on("error", ({ text }) => this.show("error", text));
    hub.on("stage", ({ product, method, done }) => {
      if (!done.outcome) this.show("busy", t("making", { product: made(product), method }));
    });
    hub.on("made", ({ want, outcome, why }) => {
      if (outcome === "failed") this.show("error", why);
      else if (outcome === "stopped") this.show(this.rest, t("makingStopped"));
      else if (want !== "touch") this.show(this.rest, t("made"));
    });
    hub.on("maker_gone", ({ why }) => this.show("error", why));
    hub.on("touch", ({ law }) => this.show((this.rest = "felt"), t("feeling", { law })));
    hub.on("loop", ({ running, stopped, why, waiting }) => {
      if (!running) this.rest = "idle";
      if (!running) this.show("stopped", stopped ? t("stopped") : t(waiting ? "waiting" : "ended", { why }));
    });
    hub.on("holding", ({ holding, free }) => {
      document.getElementById("hold")!.hidden = holding;
      if (!holding) this.show("idle", t(free ? "nobody" : "watching"));
    });
  }

  private give(id: string, text: string, act: () => void): HTMLButtonElement {
    const button = document.getElementById(id) as HTMLButtonElement;
    button.textContent = text;
    button.onclick = act;
    return button;
  }

  private stopButton(): void {
    const stop = (): void => void this.page.net.stop().catch((error: Error) => this.show("error", error.message));
    const button = this.give("stop", t("stopLong"), stop);
    const key = document.createElement("kbd");
    key.textContent = t("escape");
    button.append(" ", key);
    button.setAttribute("aria-keyshortcuts", "Escape");
    on("stop", stop);
  }

  private ask(name: string): void {
    this.page.net.ask(name).catch((error: Error) => this.show("error", error.message));
  }

  private show(what: What, text: string, topic = what === "error" ? text : "status"): void {
    this.line.dataset.state = what;
    this.line.textContent = text;
    this.line.lang = what === "error" && topic !== "gone" ? "en" : language; // the program's own words are English
    this.page.say(text, { topic, urgent: what === "error" || what === "stopped" });
    this.reach();
  }

  /** A text that is longer than its place is scrolled, by the keyboard as well. */
  private reach(): void {
    const { line } = this;
    if (line.scrollHeight > line.clientHeight) line.tabIndex = 0;
    else line.removeAttribute("tabindex");
  }
}
