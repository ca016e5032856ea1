/** Every installed device: what it is, whether it is there, and why not. */
import { button } from "../../elements";
import type { Page } from "../../page";
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

/** One device. use: called when it is to be felt. */
export function device(page: Page, found: Device, use: () => void): HTMLLIElement {
  const line = document.createElement("li");
  const name = made("h4", found.name);
  const chip = made("span", t(there(found)));
  chip.className = `chip ${found.usable ? "good" : found.problem ? "bad" : ""}`;
  name.append(" ", chip);
  const findings = document.createElement("ul");
  const uses = button(t("use"), use);
  uses.setAttribute("aria-label", t("useNamed", { name: found.name }));
  const examines = button(t("examine"), () => examine(page, found.name, findings));
  examines.setAttribute("aria-label", t("examineNamed", { name: found.name }));
  const buttons = document.createElement("div");
  buttons.className = "buttons";
  buttons.append(uses, examines);
  line.append(name, made("p", found.summary), ...troubles(found), buttons, findings);
  return line;
}

export function there({ simulated, units, problem }: Device): "simulated" | "connected" | "notAsked" | "notConnected" {
  if (simulated) return "simulated";
  if (units.length) return "connected";
  return problem ? "notAsked" : "notConnected";
}

function troubles({ units, problem }: Device): HTMLElement[] {
  const said = units.map((each) => [t("unit", { ...each }).trim(), each.problem].filter(Boolean).join(": "));
  if (problem) said.push(problem);
  return said.map((text) => Object.assign(made("p", text), { className: "hint" }));
}

async function examine(page: Page, name: string, into: HTMLElement): Promise<void> {
  try {
    const found = await page.net.ask<Finding[]>("examine", { name });
    into.replaceChildren(...found.map(finding));
    page.say(found.map(({ check, verdict }) => `${check}: ${t(verdict)}`).join("; "));
  } catch (error) {
    into.replaceChildren(made("li", t("refused", { why: (error as Error).message })));
  }
}

function finding({ check, verdict, says, cure }: Finding): HTMLElement {
  const line = made("li", `${check}: `);
  const mark = Object.assign(made("strong", t(verdict)), { className: { fine: "good", failed: "bad", "not asked": "" }[verdict] });
  line.append(mark, `. ${says}`);
  if (cure) line.append(made("p", t("cure", { cure })));
  return line;
}

function made(tag: string, text: string): HTMLElement {
  return Object.assign(document.createElement(tag), { textContent: text });
}
