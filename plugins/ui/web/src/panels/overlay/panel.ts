/** Settings of the overlay, and what limits the force. */
import { fieldset, labelled, make } from "kit/elements";
import "./overlay.css";
import { LIMITS, perSecond, type Counts } from "kit/contact/limits";
import { MM_PER_N, SECONDS, SWITCHES } from "kit/overlay/settings";
import type { Page } from "kit/page";
import type { Panel } from "../panel";
import { t } from "kit/overlay/words";

const ASK_MS = 1000;

function build(page: Page, root: HTMLElement): void {
  const { overlay } = page;
  const box = fieldset(t("show"));
  box.className = "switches";
  for (const each of SWITCHES) {
    const input = make("input", { type: "checkbox", checked: overlay.settings.show[each] });
    input.onchange = () => {
      overlay.settings.show[each] = input.checked;
      overlay.changed = true;
    };
    box.append(labelled(input, t(each)));
  }
  const seconds = number(t("seconds"), SECONDS.least, SECONDS.most, 1, overlay.settings.seconds, (value) => {
    overlay.settings.seconds = value;
    overlay.changed = true;
  });
  const scale = number(t("mmPerNewton"), MM_PER_N.least, MM_PER_N.most, 0.1, 1000 * overlay.settings.metresPerNewton, (value) => {
    overlay.settings.metresPerNewton = value / 1000;
    overlay.changed = true;
  });
  page.hub.on("shown", () => {
    scale.querySelector("input")!.value = `${Number((1000 * overlay.settings.metresPerNewton).toPrecision(3))}`;
  });
  root.append(box, seconds, scale, limits(page));
}

/** Return a number field; values outside of the bounds are not taken. */
function number(text: string, least: number, most: number, step: number, first: number, take: (value: number) => void): HTMLLabelElement {
  const label = document.createElement("label");
  const input = make("input", { type: "number", min: `${least}`, max: `${most}`, step: `${step}`, value: `${first}` });
  input.oninput = () => {
    const value = input.valueAsNumber;
    if (value >= least && value <= most) take(value);
  };
  input.onchange = () => {
    if (!input.validity.valid) input.reportValidity();
  };
  label.append(text, input);
  return label;
}

/** Return a list of how often each limit acted in the last second, polled while it is seen. */
function limits(page: Page): HTMLElement {
  const box = document.createElement("section");
  const heading = make("h3", { textContent: `${t("limitsTitle")}: ${t("perSecond")}` });
  const list = make("ul", { className: "limits-list" });
  const counts = LIMITS.map(({ word }) => {
    const line = make("li", { title: t(`${word}Help`) });
    const count = make("span", { className: "count" });
    const name = make("span", { textContent: t(word) });
    line.append(count, name);
    list.append(line);
    return count;
  });
  box.append(heading, list);
  let before: { counts: Counts; atMs: number } | null = null;
  setInterval(async () => {
    if (document.hidden || !list.checkVisibility()) return void (before = null);
    const answer = await page.net.ask<Counts | null>("limits").catch(() => null);
    const now = answer && { counts: answer, atMs: performance.now() };
    const rates = now && before && perSecond(before.counts, now.counts, (now.atMs - before.atMs) / 1000);
    before = now;
    for (const [i, count] of counts.entries()) {
      const rate = rates?.[i];
      count.textContent = rate === undefined ? "–" : `${Math.round(rate)}`;
      count.parentElement!.classList.toggle("quiet", !rate || Math.round(rate) === 0);
    }
  }, ASK_MS);
  return box;
}

export const overlay: Panel = { id: "overlay-panel", title: t("title"), task: "advanced", open: false, build };
