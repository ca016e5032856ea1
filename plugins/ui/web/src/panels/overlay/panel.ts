/** What is shown over the surface, how large, and what limits the force. */
import "./overlay.css";
import { GLYPHS } from "../../overlay/pieces/contact_label";
import { LIMITS, perSecond, type Counts } from "../../contact/limits";
import { MM_PER_N, SECONDS, SWITCHES } from "../../overlay/settings";
import type { Page } from "../../page";
import type { Panel } from "../panel";
import { t } from "../../overlay/words";

const ASK_MS = 1000;

function build(page: Page, root: HTMLElement): void {
  const { overlay } = page;
  const box = document.createElement("fieldset");
  box.className = "switches";
  const legend = document.createElement("legend");
  legend.textContent = t("show");
  box.append(legend);
  for (const each of SWITCHES) {
    const input = document.createElement("input");
    input.type = "checkbox";
    input.checked = overlay.settings.show[each];
    input.onchange = () => {
      overlay.settings.show[each] = input.checked;
      overlay.changed = true;
    };
    const label = document.createElement("label");
    label.append(input, t(each));
    box.append(label);
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
  root.append(box, seconds, scale, grips(), limits(page, root));
}

/** A number with its bounds; what is not within them is not taken. */
function number(text: string, least: number, most: number, step: number, first: number, take: (value: number) => void): HTMLLabelElement {
  const label = document.createElement("label");
  const input = document.createElement("input");
  Object.assign(input, { type: "number", min: `${least}`, max: `${most}`, step: `${step}`, value: `${first}` });
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

/** What the words and shapes beside the cursor mean. */
function grips(): HTMLElement {
  const box = document.createElement("section");
  const heading = document.createElement("h3");
  heading.textContent = t("gripTitle");
  const list = document.createElement("ul");
  list.className = "limits-list grips";
  for (const each of ["rests", "sticks", "slips", "glides"] as const) {
    const [line, name, says] = [document.createElement("li"), document.createElement("strong"), document.createElement("span")];
    name.textContent = `${GLYPHS[each]} ${t(each)}`;
    says.textContent = t(`${each}Help`);
    line.append(name, says);
    list.append(line);
  }
  box.append(heading, list);
  return box;
}

/** How often each limit acted in the last second, as the loop counted it; asked for while the panel is open. */
function limits(page: Page, root: HTMLElement): HTMLElement {
  const box = document.createElement("section");
  const heading = document.createElement("h3");
  heading.textContent = `${t("limitsTitle")}: ${t("perSecond")}`;
  const list = document.createElement("ul");
  list.className = "limits-list";
  const counts = LIMITS.map(({ word }) => {
    const line = document.createElement("li");
    line.title = t(`${word}Help`);
    const count = document.createElement("span");
    count.className = "count";
    const name = document.createElement("span");
    name.textContent = t(word);
    line.append(count, name);
    list.append(line);
    return count;
  });
  box.append(heading, list);
  let before: { counts: Counts; atMs: number } | null = null;
  setInterval(async () => {
    if (document.hidden || !root.closest("details")?.open) return void (before = null);
    const found = await page.net.ask<Counts | null>("limits").catch(() => null);
    const now = found && { counts: found, atMs: performance.now() };
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

export const overlay: Panel = { id: "overlay-panel", title: t("title"), place: "right", open: false, build };
