/** The four tasks of the page, as tabs above their panels, and the switch for all settings. */
import { recall, remember } from "kit/preferences";
import { TASKS, type Task } from "kit/server/messages";
import { t } from "./task_words";

/** A task, or: advanced, all settings; log, the log under them; any, below the panels of every task. */
export type Place = Task | "advanced" | "log" | "any";

const STEPS: Record<string, number> = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 };
const changed: (() => void)[] = [];
const element = (id: string): HTMLElement => document.getElementById(id)!;
const tab = (task: Task): HTMLElement => element(`tab-${task}`);
const isTask = (text: string): text is Task => (TASKS as readonly string[]).includes(text);

/** Return the element that holds the panels of a place. */
export function holder(place: Place): HTMLElement {
  if (isTask(place)) return element(`task-${place}`);
  return element(place === "advanced" ? "right" : place === "log" ? "bottom" : "always");
}

/** Call a function whenever other panels are to be seen. */
export function onChange(act: () => void): void {
  changed.push(act);
}

/** Call a function whenever this panel may have come into view or left it: it is opened or closed, or others are to be seen. */
export function onComingOrGoing(panel: HTMLElement, act: () => void): void {
  panel.addEventListener("toggle", act);
  onChange(act);
}

export function buildTasks(): void {
  const tabs = element("tasks");
  tabs.setAttribute("aria-label", t("tasks"));
  TASKS.forEach((task, at) => {
    tabs.append(tabOf(task, at + 1));
    element("always").before(panelsOf(task));
  });
  const kept = recall("task", "");
  showTask(isTask(kept) ? kept : "picture");
  const advanced = element("advanced");
  advanced.querySelector("span")!.textContent = t("advanced");
  advanced.setAttribute("aria-controls", "right");
  advanced.onclick = () => showAdvanced(!isAdvanced());
  showAdvanced(recall("advanced", false));
}

/** Show the panels of a task; the choice is remembered. */
export function showTask(task: Task): void {
  for (const each of TASKS) {
    tab(each).setAttribute("aria-selected", String(each === task));
    tab(each).tabIndex = each === task ? 0 : -1;
    holder(each).hidden = each !== task;
  }
  remember("task", task);
  for (const act of changed) act();
}

export function isAdvanced(): boolean {
  return document.body.classList.contains("advanced");
}

/** Show all settings and the log, or hide them; the choice is remembered. */
export function showAdvanced(on: boolean): void {
  document.body.classList.toggle("advanced", on);
  element("advanced").setAttribute("aria-pressed", String(on));
  remember("advanced", on);
  for (const act of changed) act();
}

/** Bring the task, or all settings, to the screen in which an element stands. */
export function bring(inside: Element): void {
  const task = TASKS.find((each) => holder(each).contains(inside));
  if (task) showTask(task);
  else if (element("right").contains(inside) || element("bottom").contains(inside)) showAdvanced(true);
}

function tabOf(task: Task, number: number): HTMLElement {
  const tab = document.createElement("button");
  Object.assign(tab, { type: "button", id: `tab-${task}`, role: "tab" });
  tab.setAttribute("aria-controls", `task-${task}`);
  const badge = Object.assign(document.createElement("span"), { className: "badge", textContent: String(number) });
  tab.append(badge, " ", t(task));
  tab.onclick = () => showTask(task);
  tab.onkeydown = (event) => walk(event, task);
  return tab;
}

function panelsOf(task: Task): HTMLElement {
  const box = Object.assign(document.createElement("div"), { id: `task-${task}`, className: "task", role: "tabpanel" });
  box.setAttribute("aria-labelledby", `tab-${task}`);
  return box;
}

/** Go from tab to tab by arrow keys, Home and End. */
function walk(event: KeyboardEvent, from: Task): void {
  const at = TASKS.indexOf(from) + (STEPS[event.key] ?? 0);
  const to = event.key === "Home" ? TASKS[0] : event.key === "End" ? TASKS.at(-1)! : TASKS.at(at % TASKS.length)!;
  if (to === from && event.key !== "Home" && event.key !== "End") return;
  event.preventDefault();
  showTask(to);
  tab(to).focus();
}
