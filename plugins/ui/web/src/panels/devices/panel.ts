/** Devices: which there are and why one is not, which one is felt, and how its loop runs. */
import { button } from "../../elements";
import type { Page } from "../../page";
import { type Panel, reveal } from "../panel";
import { t } from "./words";
import { device, type Device } from "./list";
import { doctor } from "./doctor";
import { sure, type About } from "./confirmation";
import "./devices.css";

type Kind = "hand" | "document" | "other";

function build(page: Page, root: HTMLElement): void {
  const { hub, net } = page;
  const told = Object.assign(document.createElement("p"), { id: "device-felt" });
  const list = Object.assign(document.createElement("ul"), { className: "devices" });
  const panel = root.closest("details")!;

  async function tried(work: () => Promise<unknown>): Promise<void> {
    try {
      await work();
    } catch (error) {
      say(t("refused", { why: (error as Error).message }));
    }
  }

  function say(text: string): void {
    told.textContent = text;
    page.say(text);
  }

  const choose = (kind: Kind, name = ""): Promise<void> =>
    tried(async () => {
      const about = await net.ask<About>("about_device", { kind, name });
      if (!about.simulated && !(await sure(about))) return;
      if (kind !== "hand") say(t("starting", { name: about.name }));
      await net.ask("choose_device", { kind, name, sure: !about.simulated });
    });

  async function look(): Promise<void> {
    list.replaceChildren(Object.assign(document.createElement("li"), { textContent: t("looking") }));
    const { devices } = await net.ask<{ devices: Device[] }>("devices");
    list.replaceChildren(...devices.map((each) => device(page, each, () => void choose("other", each.name))));
  }

  const hand = Object.assign(button(t("useHand"), () => choose("hand")), { id: "use-hand" });
  const ofDocument = Object.assign(button("", () => choose("document")), { id: "use-document", hidden: true });
  const wait = Object.assign(button(t("wait"), () => tried(() => net.ask("wait_for_device"))), { hidden: true });
  const again = Object.assign(button(t("again"), () => tried(() => net.feel())), { hidden: true });
  const preflight = Object.assign(button(t("preflight"), () => reveal("preflight")), { hidden: true });
  const refresh = button(t("refresh"), () => tried(look));

  hub.on("document", ({ values }) => {
    const name = (values?.device as { use?: string } | undefined)?.use;
    ofDocument.hidden = !name;
    ofDocument.textContent = t("useDocument", { name: name ?? "" });
  });
  hub.on("loop", ({ running, why, waiting, lost, device: name, own_hand }) => {
    wait.hidden = running || !lost || waiting === true;
    again.hidden = running;
    if (running) told.textContent = t("felt", { device: own_hand ? t("ownHand") : (name ?? "") });
    else told.textContent = t(waiting ? "waiting" : "nothingFelt", { why });
  });
  panel.addEventListener("toggle", () => {
    preflight.hidden = !document.getElementById("preflight");
    if (panel.open && !list.children.length) void tried(look);
  });
  hub.on("hello", () => panel.open && void tried(look));
  const heading = Object.assign(document.createElement("h3"), { textContent: t("installed") });
  root.append(told, row(wait, again), row(hand, ofDocument, preflight), doctor(page, () => panel.open), heading, list, row(refresh));
}

function row(...buttons: HTMLElement[]): HTMLElement {
  const made = document.createElement("div");
  made.className = "buttons";
  made.append(...buttons);
  return made;
}

export const devices: Panel = { id: "devices", title: t("title"), place: "right", open: false, build };
