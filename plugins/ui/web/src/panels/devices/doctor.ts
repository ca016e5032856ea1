/** How the force loop runs, four times a second while somebody looks. */
import type { Page } from "../../page";
import { LIMITS } from "../../contact/limits";
import { t } from "./words";
import { t as named } from "../../overlay/words";
import { Spark } from "./sparkline";

const LOOK_MS = 250;

interface Spread {
  p50: number;
  p99: number;
  most: number;
}

interface Figures {
  rate_hz: number;
  late_us: Spread | null;
  late_share: number;
  force_n: number;
  most_force_n: number;
  position_m: [number, number, number];
  buttons: number;
  ticks: number;
  whole_late_us: Spread | null;
  whole_late_share: number;
  overruns: number;
  flagged: Record<string, number>;
  how: string;
}

/** open: whether somebody can see it. */
export function doctor(page: Page, open: () => boolean): HTMLElement {
  const box = document.createElement("section");
  const heading = document.createElement("h3");
  heading.textContent = t("doctor");
  const none = document.createElement("p");
  none.className = "hint";
  none.textContent = t("noLoop");
  const list = document.createElement("dl");
  list.className = "figures";
  const how = Object.assign(document.createElement("p"), { className: "hint" });
  const late = new Spark(t("worstLine"), 0);
  const force = new Spark(t("forceLine"), 2);
  box.append(heading, none, list, how, captioned(t("worstLine"), late), captioned(t("forceLine"), force));
  let asking = false;

  async function look(): Promise<void> {
    if (asking || document.hidden || !open()) return;
    asking = true;
    try {
      show(await page.net.ask<Figures | null>("doctor"));
    } catch {
      show(null); // the program is gone, which the head of the page says
    } finally {
      asking = false;
    }
  }

  function show(found: Figures | null): void {
    none.hidden = found !== null;
    for (const each of [list, how, late.element.parentElement!, force.element.parentElement!]) each.hidden = !found;
    if (!found) return;
    list.replaceChildren(...rows(found).flatMap(([name, value]) => [made("dt", name), made("dd", value)]));
    how.textContent = t("how", { how: found.how });
    late.add(found.late_us?.most ?? 0);
    force.add(found.force_n);
  }

  setInterval(() => void look(), LOOK_MS);
  show(null);
  return box;
}

function rows(found: Figures): [string, string][] {
  const [x, y, z] = found.position_m.map((part) => (1000 * part).toFixed(1));
  const share = { now: (100 * found.late_share).toFixed(1), whole: (100 * found.whole_late_share).toFixed(2) };
  return [
    [t("rate"), t("hertz", { value: found.rate_hz.toFixed(0) })],
    [t("late"), spread(found.late_us)],
    [t("share"), t("percent", share)],
    [t("whole"), spread(found.whole_late_us)],
    [t("overruns"), t("overrunsOf", { overruns: found.overruns, ticks: found.ticks })],
    [t("force"), t("newtons", { now: found.force_n.toFixed(2), most: found.most_force_n.toFixed(2) })],
    [t("position"), t("millimetres", { x: x!, y: y!, z: z! })],
    [t("buttons"), bits(found.buttons).join(", ") || t("none")],
    [t("limits"), limits(found.flagged) || t("none")],
  ];
}

function spread(found: Spread | null): string {
  if (!found) return "–";
  return t("spread", { p50: found.p50.toFixed(0), p99: found.p99.toFixed(0), most: found.most.toFixed(0) });
}

/** The first button is 1, as people count. */
export function bits(buttons: number): number[] {
  return Array.from({ length: 8 }, (_, i) => i + 1).filter((each) => buttons & (1 << (each - 1)));
}

/** "force limited 12": how many ticks each limit changed; overruns have a line of their own. */
export function limits(flagged: Record<string, number>): string {
  return LIMITS.filter(({ name }) => name !== "OVERRUN" && flagged[name])
    .map(({ name, word }) => `${named(word)} ${flagged[name]}`)
    .join(", ");
}

function captioned(text: string, spark: Spark): HTMLElement {
  const box = document.createElement("figure");
  box.append(made("figcaption", text), spark.element as unknown as HTMLElement);
  return box;
}

function made(tag: string, text: string): HTMLElement {
  return Object.assign(document.createElement(tag), { textContent: text });
}
