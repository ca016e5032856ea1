/** The head of the page: what goes on, the stop button, and who holds the hand. */
import type { Page } from "./page";
import { t } from "./words/frame";

export class Status {
  constructor(private page: Page) {
    const { hub, net } = page;
    const stop = document.getElementById("stop") as HTMLButtonElement;
    const again = document.getElementById("again") as HTMLButtonElement;
    const hold = document.getElementById("hold") as HTMLButtonElement;
    stop.textContent = t("stop");
    again.textContent = t("feelAgain");
    hold.textContent = t("takeHand");
    stop.onclick = () => void net.ask("stop");
    again.onclick = () => void net.ask("feel").catch((error: Error) => this.say(error.message));
    hold.onclick = () => void net.ask("hold");
    hub.on("gone", () => this.say(t("gone")));
    hub.on("error", ({ text }) => this.say(text));
    hub.on("stage", ({ product, method, done }) => {
      if (!done.outcome) this.say(t("making", { product, method }));
    });
    hub.on("touch", ({ law }) => this.say(t("feeling", { law })));
    hub.on("loop", ({ running }) => {
      if (!running) this.say(t("stopped"));
    });
    hub.on("holding", ({ holding }) => {
      hold.hidden = holding;
      if (!holding) this.say(t("watching"));
    });
    document.addEventListener("keydown", (event) => {
      if (event.key === "Escape") void net.ask("stop");
    });
  }

  private say(text: string): void {
    document.getElementById("status")!.textContent = text;
    this.page.say(text);
  }
}
