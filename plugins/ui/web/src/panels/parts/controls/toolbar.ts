/** The tools, what the one in use can be told, and what is done with the drawing as a whole. */
import { button, field } from "../../../elements";
import { t } from "../editor/words";
import { caps } from "../../help/panel";
import { KINDS } from "../editor/requests";
import type { Drawing } from "../drawing/drawing";
import { TOOL_KEYS } from "../editor/keys";
import { type Pens, type Tool, TOOLS } from "./tools";
import { input, select } from "./part_list";

export interface Acts {
  use: (tool: Tool) => void;
  fresh: () => void;
  accept: () => void;
  discard: () => void;
  undo: () => void;
  redo: () => void;
  nearer: (factor: number) => void;
  fit: () => void;
}

/** Which fields a tool has; what was proposed is corrected with the first two kinds of tool. */
const FIELDS: Record<Tool, readonly ("width" | "snap" | "method")[]> = {
  select: [], brush: ["width"], lasso: ["snap"], propose: ["width", "method"], split: [], join: [],
};

export class Bar {
  readonly tools = group(t("tools"));
  readonly options = document.createElement("div");
  readonly width = input("parts-width", "range");
  private uses = new Map<Tool, HTMLButtonElement>();
  private fresh: HTMLButtonElement;
  private back: HTMLButtonElement;
  private again: HTMLButtonElement;
  private proposal: HTMLElement[];
  private takes: HTMLButtonElement;
  private fields: Record<"width" | "snap" | "method", HTMLElement>;

  constructor(
    private drawing: Drawing,
    private pens: Pens,
    act: Acts,
  ) {
    for (const tool of TOOLS) this.uses.set(tool, keyed(t(tool), TOOL_KEYS[tool], () => act.use(tool)));
    this.fresh = keyed(t("fresh"), "t", act.fresh);
    this.back = keyed(t("undo"), "Ctrl+z", act.undo);
    this.again = keyed(t("redo"), "Ctrl+Shift+z", act.redo);
    this.tools.append(
      ...this.uses.values(), gap(), this.fresh, gap(), this.back, this.again, gap(),
      keyed(t("zoomIn"), "+", () => act.nearer(1.5)), keyed(t("zoomOut"), "-", () => act.nearer(1 / 1.5)), keyed(t("fit"), "0", act.fit),
    );
    this.fields = { width: this.widthField(), snap: this.snapField(), method: this.methodField() };
    this.takes = button(t("takeAway"), () => {
      pens.takesAway = !pens.takesAway;
      this.show();
    });
    const accept = keyed(t("accept"), "Enter", act.accept);
    accept.className = "primary";
    this.proposal = [accept, keyed(t("discard"), "Escape", act.discard), this.takes];
    this.options.className = "bar";
    this.options.append(...Object.values(this.fields), ...this.proposal);
  }

  show(): void {
    const { pens, drawing } = this;
    for (const [tool, each] of this.uses) each.ariaPressed = String(tool === pens.tool);
    this.fresh.ariaPressed = String(pens.fresh);
    this.takes.ariaPressed = String(pens.takesAway);
    this.back.disabled = !drawing.canUndo;
    this.again.disabled = !drawing.canRedo;
    for (const [name, each] of Object.entries(this.fields)) each.hidden = !(FIELDS[pens.tool] as readonly string[]).includes(name);
    for (const each of this.proposal) each.hidden = !drawing.proposed;
    this.takes.hidden ||= pens.tool !== "brush" && pens.tool !== "lasso";
    this.options.hidden = [...this.options.children].every((each) => (each as HTMLElement).hidden);
    if (Math.abs(this.shownWidth - pens.width) >= 1) this.width.value = String(Math.log2(pens.width));
    this.width.setAttribute("aria-valuetext", t("pixels", { count: Math.round(pens.width) }));
    this.width.nextElementSibling!.textContent = this.width.getAttribute("aria-valuetext");
  }

  private get shownWidth(): number {
    return 2 ** this.width.valueAsNumber;
  }

  /** As wide as one likes: each step is the same share. */
  private widthField(): HTMLElement {
    const most = Math.max(this.drawing.labels.columns, this.drawing.labels.rows);
    Object.assign(this.width, { min: "0", max: String(Math.log2(most)), step: "0.1" });
    this.width.addEventListener("input", () => {
      this.pens.width = Math.round(this.shownWidth);
      this.show();
    });
    const box = field(t("width"), this.width);
    box.append(document.createElement("output"));
    return box;
  }

  private snapField(): HTMLElement {
    const check = input("parts-snap", "checkbox");
    check.checked = this.pens.snaps;
    check.addEventListener("change", () => (this.pens.snaps = check.checked));
    const label = document.createElement("label");
    label.append(check, t("snap"));
    return label;
  }

  private methodField(): HTMLElement {
    const choice = select("parts-method");
    for (const kind of KINDS) choice.add(new Option(t(kind), kind));
    choice.addEventListener("change", () => (this.pens.kind = choice.value));
    return field(t("method"), choice);
  }
}

function gap(): HTMLElement {
  return Object.assign(document.createElement("span"), { className: "gap" });
}

export function group(name: string): HTMLElement {
  const box = document.createElement("div");
  box.className = "bar";
  box.setAttribute("role", "group");
  box.setAttribute("aria-label", name);
  return box;
}

/** A button that shows its key. */
export function keyed(text: string, key: string, press: () => void): HTMLButtonElement {
  const made = button(text, press);
  const cap = caps(key);
  cap.setAttribute("aria-hidden", "true");
  made.append(" ", cap);
  made.setAttribute("aria-keyshortcuts", key.replace("Ctrl", "Control"));
  return made;
}
