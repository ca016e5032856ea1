/** Figures of the force loop, four times a second while visible. */
import { make } from "kit/elements";
import type { Page } from "kit/page";
import { LIMITS } from "kit/contact/limits";
import { t } from "./words";
import { t as named } from "kit/overlay/words";
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

/** Return the figures. open: whether the panel is visible. */
export function loopFigures(page: Page, open: () => boolean): HTMLElement {
  const box = document.createElement("section");
  const heading = make("h3", { textContent: t("doctor") });
  const none = make("p", { className: "hint", textContent: t("noLoop") });
  const list = make("dl", { className: "figures" });
  const how = make("p", { className: "hint" });
  const late = new Spark(t("worstLine"), 0);
  const force = new Spark(t("forceLine"), 2);
  box.append(heading, none, list, how, figureWithCaption(t("worstLine"), late), figureWithCaption(t("forceLine"), force));
  let asking = false;

  async function look(): Promise<void> {
    if (asking || document.hidden || !open()) return;
    asking = true;
    try {
      show(await page.net.ask<Figures | null>("doctor"));
    } catch {
      show(null); // the header shows that the program is gone
    } finally {
      asking = false;
    }
  }

  function show(figures: Figures | null): void {
    none.hidden = figures !== null;
    for (const each of [list, how, late.element.parentElement!, force.element.parentElement!]) each.hidden = !figures;
    if (!figures) return;
    list.replaceChildren(...rows(figures).flatMap(([name, value]) => [element("dt", name), element("dd", value)]));
    how.textContent = t("how", { how: figures.how });
    late.add(figures.late_us?.most ?? 0);
    force.add(figures.force_n);
  }

  setInterval(() => void look(), LOOK_MS);
  show(null);
  return box;
}

function rows(figures: Figures): [string, string][] {
  const [x, y, z] = figures.position_m.map((part) => (1000 * part).toFixed(1));
  const share = { now: (100 * figures.late_share).toFixed(1), whole: (100 * figures.whole_late_share).toFixed(2) };
  return [
    [t("rate"), t("hertz", { value: figures.rate_hz.toFixed(0) })],
    [t("late"), spread(figures.late_us)],
    [t("share"), t("percent", share)],
    [t("whole"), spread(figures.whole_late_us)],
    [t("overruns"), t("overrunsOf", { overruns: figures.overruns, ticks: figures.ticks })],
    [t("force"), t("newtons", { now: figures.force_n.toFixed(2), most: figures.most_force_n.toFixed(2) })],
    [t("position"), t("millimetres", { x: x!, y: y!, z: z! })],
    [t("buttons"), pressedButtons(figures.buttons).join(", ") || t("none")],
    [t("limits"), limits(figures.flagged) || t("none")],
  ];
}

function spread(values: Spread | null): string {
  if (!values) return "–";
  return t("spread", { p50: values.p50.toFixed(0), p99: values.p99.toFixed(0), most: values.most.toFixed(0) });
}

/** Return the numbers of the pressed buttons, from 1. */
export function pressedButtons(buttons: number): number[] {
  return Array.from({ length: 8 }, (_, i) => i + 1).filter((each) => buttons & (1 << (each - 1)));
}

/** Return "force limited 12": ticks changed by each limit; overruns are shown separately. */
export function limits(flagged: Record<string, number>): string {
  return LIMITS.filter(({ name }) => name !== "OVERRUN" && flagged[name])
    .map(({ name, word }) => `${named(word)} ${flagged[name]}`)
    .join(", ");
}

function figureWithCaption(text: string, spark: Spark): HTMLElement {
  const box = document.createElement("figure");
  box.append(element("figcaption", text), spark.element as unknown as HTMLElement);
  return box;
}

function element(tag: string, text: string): HTMLElement {
  return Object.assign(document.createElement(tag), { textContent: text });
}
