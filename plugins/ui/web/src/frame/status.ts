/** The head: the sentence about what goes on, the stop button, and the buttons for force and hand. */
import type { Page } from "kit/page";
import { on } from "kit/shortcuts";
import { productName } from "../words/product_words";
import { follow, headline, type Facts } from "./headline";
import { t as says } from "./status_words";
import { t } from "./words";

/** Time for which the head says that the connection is back, ms; then it says what goes on alone. */
const BACK_MS = 4000;

export class Status {
  private line = document.getElementById("status")!;
  private facts: Facts;
  private wasLost = false;
  private back = 0;
  /** True from a stop by this page's key or button on: it is confirmed, and no alarm. */
  private stopping = false;

  constructor(private page: Pick<Page, "hub" | "net" | "say">) {
    const { hub } = page;
    this.give("hold", t("takeHand"), () => this.ask("hold"));
    this.give("again", t("feelAgain"), () => void this.page.net.feel().catch((error: Error) => this.fail(error)));
    this.stopButton();
    new ResizeObserver(() => this.reach()).observe(this.line);
    hub.on("gone", () => (this.wasLost = true));
    hub.on("hello", () => {
      if (!this.wasLost) return;
      this.wasLost = false;
      this.back = window.setTimeout(() => this.endBack(), BACK_MS);
    });
    this.facts = follow(hub, (facts) => this.show(facts));
    hub.on("loop", () => (this.stopping = false));
    hub.on("made", ({ want, outcome }) => {
      if (outcome === "stopped") page.say(says("makingStopped"), { topic: "made" });
      else if (outcome === "made" && want !== "touch") page.say(says("computed", { product: productName(want) }), { topic: "made" });
    });
    this.show(this.facts);
  }

  private give(id: string, text: string, act: () => void): HTMLButtonElement {
    const button = document.getElementById(id) as HTMLButtonElement;
    button.textContent = text;
    button.onclick = act;
    return button;
  }

  private stopButton(): void {
    const stop = (): void => {
      this.stopping = true;
      void this.page.net.stop().catch((error: Error) => this.fail(error));
    };
    const button = this.give("stop", t("stop"), stop);
    const more = Object.assign(document.createElement("span"), { className: "long", textContent: t("stopMore") });
    const key = Object.assign(document.createElement("kbd"), { textContent: t("escape") });
    button.append(more, " ", key);
    button.setAttribute("aria-keyshortcuts", "Escape");
    on("stop", stop);
  }

  private ask(name: string): void {
    this.page.net.ask(name).catch((error: Error) => this.fail(error));
  }

  private fail(error: Error): void {
    this.show(Object.assign(this.facts, { trouble: error.message }));
  }

  private endBack(): void {
    clearTimeout(this.back);
    this.back = 0;
    this.show(this.facts);
  }

  private show(facts: Facts): void {
    const { what, text } = headline(facts);
    const { line, page } = this;
    if (["lost", "silent", "dead"].includes(facts.connection)) this.back = (clearTimeout(this.back), 0);
    const shown = this.back ? `${says("back")} ${text}` : text;
    this.showButtons(facts);
    if (line.textContent === shown && line.dataset.state === what) return;
    line.dataset.state = what;
    line.textContent = shown;
    const asked = what === "stopped" && this.stopping;
    const news = { topic: "status", asked, urgent: what === "error" || (what === "stopped" && !asked) };
    const words = text.replace(/\d+/g, "#"); // seconds that run down are not spoken one by one
    if (shown !== text || line.dataset.said !== words) page.say(shown, news);
    line.dataset.said = words;
    this.reach();
  }

  /** Show the buttons that do something now; a button that leaves gives its focus to the stop button. */
  private showButtons({ hand, noForce }: Facts): void {
    const there = { hold: hand !== "ours", again: noForce !== "" };
    for (const [id, on] of Object.entries(there)) {
      const button = document.getElementById(id)!;
      if (!on && document.activeElement === button) document.getElementById("stop")!.focus();
      button.hidden = !on;
    }
  }

  /** Make a text longer than its place reachable, so that the keyboard scrolls it. */
  private reach(): void {
    const { line } = this;
    if (line.scrollHeight > line.clientHeight) line.tabIndex = 0;
    else line.removeAttribute("tabindex");
  }
}
