/** The networks panel: what is known of each network; fetch, remove and check them, as `tangible networks` does. */
import { button, field, make, paragraph } from "kit/elements";
import type { Page } from "kit/page";
import type { Events } from "kit/server/messages";
import { decimal, language } from "kit/words/words";
import { sendFile } from "../open/upload";
import { t } from "./words";

const TASKS = ["figure", "borders", "faces", "text", "depth"] as const;

interface Network {
  name: string;
  title: string;
  task: (typeof TASKS)[number];
  state: "here" | "absent" | "damaged";
  bytes: number;
  licence: string;
  trained_on: string;
  source: string;
  verified: boolean;
  recommended: boolean;
  can_be_fetched: boolean;
}

const COLOURS = { here: "good", absent: "", damaged: "bad" };
const size = (bytes: number): string => (bytes ? t("megabytes", { size: decimal(bytes / 1e6, 1) }) : t("noSize"));

export function build(page: Page, root: HTMLElement): Promise<void> {
  const { hub, net } = page;
  const status = make("p", { id: "networks-status" });
  const running = make("p", { className: "hint progress", hidden: true });
  const bar = make("progress", { max: 1 });
  const share = document.createElement("span");
  const list = make("div", { textContent: t("waiting") });
  const folder = paragraph("", "hint");
  let wanted = false; // of this tab

  function say(text: string, className = ""): void {
    Object.assign(status, { textContent: text, className });
    page.say(text);
  }

  async function attempt(work: () => Promise<unknown>): Promise<void> {
    try {
      await work();
    } catch (error) {
      say((error as Error).message, "bad");
    }
  }

  async function load(check = false): Promise<Network[]> {
    const found = await net.ask<{ folder: string; networks: Network[] }>("networks", { check });
    const focused = document.activeElement?.id;
    list.replaceChildren(...everything(found.networks), ...TASKS.flatMap((task) => section(task, found.networks)));
    folder.textContent = t("folder", { folder: found.folder });
    if (focused && root.contains(document.getElementById(focused))) document.getElementById(focused)?.focus();
    return found.networks;
  }

  const add = (names: string[], batch = ""): Promise<void> =>
    attempt(async () => {
      await net.ask("add_networks", { names, batch });
      wanted = true;
    });

  const fromFile = (name: string, file: File): Promise<void> =>
    attempt(async () => {
      const batch = await net.ask<string>("batch");
      await sendFile(batch, file, (of, percent) => (status.textContent = t("sending", { name: of, percent })));
      await add([name], batch);
    });

  const remove = ({ name, title }: Network): Promise<void> =>
    attempt(async () => {
      await net.ask("remove_networks", { names: [name] });
      await load();
      say(t("removed", { name: title }));
    });

  const check = (): Promise<void> =>
    attempt(async () => {
      const damaged = (await load(true)).filter(({ state }) => state === "damaged");
      if (damaged.length) say(t("wrong", { names: damaged.map(({ title }) => title).join(", ") }), "bad");
      else say(t("right"));
    });

  /** The button for all that a photograph needs, where some of it is not here. */
  function everything(networks: Network[]): HTMLElement[] {
    const absent = networks.filter(({ task, state, recommended }) => recommended && task !== "depth" && task !== "text" && state !== "here");
    const whole = absent.reduce((sum, { bytes }) => sum + bytes, 0);
    const names = absent.map(({ name }) => name);
    return absent.length ? [button(t("addThese", { size: size(whole) }), () => add(names), { id: "networks-add" })] : [];
  }

  function section(task: (typeof TASKS)[number], networks: Network[]): HTMLElement[] {
    const lines = make("ul", { className: "devices" });
    lines.append(...networks.filter((each) => each.task === task).map(item));
    return [make("h3", { textContent: t(task) }), paragraph(t(`${task}Does`)), lines];
  }

  function item(about: Network): HTMLLIElement {
    const line = document.createElement("li");
    const name = make("h4", { textContent: about.title || about.name });
    name.append(" ", make("span", { className: `chip ${COLOURS[about.state]}`, textContent: t(about.state) }));
    const facts = paragraph(size(about.bytes), "hint");
    for (const [what, fact] of [["licence", about.licence], ["trained", about.trained_on], ["source", about.source]] as const)
      facts.append(`. ${t(what)}: `, make("span", { lang: fact ? "en" : language, textContent: fact || t("unknown") })); // a card is English
    line.append(name, facts);
    if (!about.verified) line.append(paragraph(t("unverified"), "hint"));
    line.append(...controls(about));
    return line;
  }

  /** A button to add or to remove it; a field for a file of somebody who cannot download it here. */
  function controls(about: Network): HTMLElement[] {
    const [id, name] = [`network-${about.name}`, about.title || about.name];
    if (about.state === "here") {
      return [button(t("remove"), () => remove(about), { id, ariaLabel: t("removeNamed", { name }) })];
    }
    const file = make("input", { type: "file", id: `${id}-file` });
    file.onchange = () => void (file.files?.[0] && fromFile(about.name, file.files[0]));
    const first = about.can_be_fetched
      ? button(t("add"), () => add([about.name]), { id, ariaLabel: t("addNamed", { name }) })
      : paragraph(t("byHand"), "hint");
    return [first, field(t("file", { name }), file)];
  }

  bar.setAttribute("aria-label", t("progress"));
  running.append(bar, share, button(t("stop"), () => attempt(() => net.ask("stop_networks"))));
  status.tabIndex = -1;
  root.append(paragraph(t("about")), status, running, list, button(t("check"), check, { id: "networks-check" }), folder);
  const follow = ({ name, done, whole, why }: Events["fetching"]): void => {
    running.hidden = !name;
    if (name) {
      if (whole) bar.value = Math.min(1, done / whole);
      else bar.removeAttribute("value");
      share.textContent = whole ? t("fetchingOf", { name, done: decimal(done / 1e6, 1), whole: size(whole) }) : t("fetching", { name });
      return;
    }
    if (why) say(why, "bad");
    else if (wanted) say(t("added"));
    wanted = false;
    void attempt(load);
  };
  hub.on("fetching", follow);
  const latest = hub.last("fetching");
  if (latest?.name) follow(latest);
  return load().then(() => undefined);
}
