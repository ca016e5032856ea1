/** The devices panel: installed devices, the choice of one, and figures of its loop. */
import { button, make } from "kit/elements";
import type { Page } from "kit/page";
import { type Panel, reveal } from "../panel";
import { t } from "./words";
import { deviceItem, type Device } from "./list";
import { loopFigures } from "./doctor";
import { confirmStart, type About } from "./confirmation";
import "./devices.css";

type Kind = "hand" | "document" | "other";

function build(page: Page, root: HTMLElement): void {
  const { hub, net } = page;
  const status = make("p", { id: "device-felt" });
  const list = make("ul", { className: "devices" });
  const panel = root.closest("details")!;

  async function attempt(work: () => Promise<unknown>): Promise<void> {
    try {
      await work();
    } catch (error) {
      say(t("refused", { why: (error as Error).message }));
    }
  }

  function say(text: string): void {
    status.textContent = text;
    page.say(text);
  }

  const choose = (kind: Kind, name = ""): Promise<void> =>
    attempt(async () => {
      const about = await net.ask<About>("about_device", { kind, name });
      if (!about.simulated && !(await confirmStart(about))) return;
      if (kind !== "hand") say(t("starting", { name: about.name }));
      await net.ask("choose_device", { kind, name, sure: !about.simulated });
    });

  async function look(): Promise<void> {
    list.replaceChildren(make("li", { textContent: t("looking") }));
    const devices = await net.ask<Device[]>("devices");
    list.replaceChildren(...devices.map((each) => deviceItem(page, each, () => void choose("other", each.name))));
  }

  const hand = Object.assign(button(t("useHand"), () => choose("hand")), { id: "use-hand" });
  const ofDocument = Object.assign(button("", () => choose("document")), { id: "use-document", hidden: true });
  const wait = Object.assign(button(t("wait"), () => attempt(() => net.ask("wait_for_device"))), { hidden: true });
  const again = Object.assign(button(t("again"), () => attempt(() => net.feel())), { hidden: true });
  const preflight = Object.assign(button(t("preflight"), () => reveal("preflight")), { hidden: true });
  const refresh = button(t("refresh"), () => attempt(look));

  hub.on("document", ({ values }) => {
    const name = (values?.device as { use?: string } | undefined)?.use;
    ofDocument.hidden = !name;
    ofDocument.textContent = t("useDocument", { name: name ?? "" });
  });
  hub.on("loop", ({ running, why, waiting, lost, device: name, own_hand }) => {
    wait.hidden = running || !lost || waiting === true;
    again.hidden = running;
    if (running) status.textContent = t("felt", { device: own_hand ? t("ownHand") : (name ?? "") });
    else status.textContent = t(waiting ? "waiting" : "nothingFelt", { why });
  });
  panel.addEventListener("toggle", () => {
    preflight.hidden = !document.getElementById("preflight");
    if (panel.open && !list.children.length) void attempt(look);
  });
  hub.on("hello", () => panel.open && void attempt(look));
  const heading = make("h3", { textContent: t("installed") });
  root.append(status, row(wait, again), row(hand, ofDocument, preflight), loopFigures(page, () => panel.open), heading, list, row(refresh));
}

function row(...buttons: HTMLElement[]): HTMLElement {
  const results = make("div", { className: "buttons" });
  results.append(...buttons);
  return results;
}

export const devices: Panel = { id: "devices", title: t("title"), task: "feel", open: false, build };
