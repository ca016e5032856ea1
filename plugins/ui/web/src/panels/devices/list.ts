/** List items of installed devices: kind, presence, problems. */
import { button, make } from "kit/elements";
import type { Page } from "kit/page";
import { t } from "./words";

interface Unit {
  name: string;
  serial: string;
  place: string;
  problem: string;
}

export interface Device {
  name: string;
  summary: string;
  simulated: boolean | null;
  units: Unit[];
  problem: string;
  usable: boolean;
}

interface Finding {
  check: string;
  verdict: "fine" | "failed" | "not asked";
  says: string;
  cure: string;
}

/** Return the item of a device. use: called when it is chosen. */
export function deviceItem(page: Page, about: Device, use: () => void): HTMLLIElement {
  const line = document.createElement("li");
  const name = element("h4", about.name);
  const chip = element("span", t(presenceOf(about)));
  chip.className = `chip ${about.usable ? "good" : about.problem ? "bad" : ""}`;
  name.append(" ", chip);
  const findings = document.createElement("ul");
  const uses = button(t("use"), use);
  uses.setAttribute("aria-label", t("useNamed", { name: about.name }));
  const examines = button(t("examine"), () => examine(page, about.name, findings));
  examines.setAttribute("aria-label", t("examineNamed", { name: about.name }));
  const buttons = make("div", { className: "buttons" });
  buttons.append(uses, examines);
  line.append(name, element("p", about.summary), ...problemTexts(about), buttons, findings);
  return line;
}

export function presenceOf({ simulated, units, problem }: Device): "simulated" | "connected" | "notAsked" | "notConnected" {
  if (simulated) return "simulated";
  if (units.length) return "connected";
  return problem ? "notAsked" : "notConnected";
}

function problemTexts({ units, problem }: Device): HTMLElement[] {
  const said = units.map((each) => [t("unit", { ...each }).trim(), each.problem].filter(Boolean).join(": "));
  if (problem) said.push(problem);
  return said.map((text) => Object.assign(element("p", text), { className: "hint" }));
}

async function examine(page: Page, name: string, into: HTMLElement): Promise<void> {
  try {
    const findings = await page.net.ask<Finding[]>("examine", { name });
    into.replaceChildren(...findings.map(findingItem));
    page.say(findings.map(({ check, verdict }) => `${check}: ${t(verdict)}`).join("; "));
  } catch (error) {
    into.replaceChildren(element("li", t("refused", { why: (error as Error).message })));
  }
}

function findingItem({ check, verdict, says, cure }: Finding): HTMLElement {
  const line = element("li", `${check}: `);
  const mark = Object.assign(element("strong", t(verdict)), { className: { fine: "good", failed: "bad", "not asked": "" }[verdict] });
  line.append(mark, `. ${says}`);
  if (cure) line.append(element("p", t("cure", { cure })));
  return line;
}

function element(tag: string, text: string): HTMLElement {
  return Object.assign(document.createElement(tag), { textContent: text });
}
