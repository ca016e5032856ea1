/** The head of the page: what goes on, the stop button, and who holds the hand. */
import type { Page } from "./page";
import { on } from "./shortcuts";
import { t } from "./words/frame";

type What = "idle" | "busy" | "felt" | "stopped" | "error";

export class Status {
  private line = document.getElementById("status")!;

  constructor(private page: Page) {
    const { hub } = page;
    this.button("hold", t("takeHand"), () => this.ask("hold"));
    this.button("again", t("feelAgain"), () => this.ask("feel"));
    this.stopButton();
    this.line.textContent = t("starting");
    hub.on("gone", () => this.say("error", t("gone"), "gone"));
    hub.on("hello", () => page.forget("gone"));
    hub.on("error", ({ text }) => this.say("error", text));
    hub.on("stage", ({ product, method, done }) => {
      if (!done.outcome) this.say("busy", t("making", { product, method }));
    });
    hub.on("touch", ({ law }) => this.say("felt", t("feeling", { law })));
    hub.on("loop", ({ running }) => {
      if (!running) this.say("stopped", t("stopped"));
    });
    hub.on("holding", ({ holding }) => {
      document.getElementById("hold")!.hidden = holding;
      if (!holding) this.say("idle", t("watching"));
    });
  }

  private button(id: string, text: string, act: () => void): HTMLButtonElement {
    const button = document.getElementById(id) as HTMLButtonElement;
    button.textContent = text;
    button.onclick = act;
    return button;
  }

  private stopButton(): void {
    const stop = (): void => this.ask("stop");
    const button = this.button("stop", t("stopLong"), stop);
    const key = document.createElement("kbd");
    key.textContent = "Esc";
    button.append(" ", key);
    button.setAttribute("aria-keyshortcuts", "Escape");
    on("stop", stop);
  }

  private ask(name: string): void {
    this.page.net.ask(name).catch((error: Error) => this.say("error", error.message));
  }

  private say(what: What, text: string, topic = what === "error" ? text : "status"): void {
    this.line.dataset.state = what;
    this.line.textContent = text;
    this.page.say(text, { topic, urgent: what === "error" || what === "stopped" });
  }
}
