/** Toolbar of the tools, their options, and undo, redo and zoom. */
import { button, field, labelled, make } from "kit/elements";
import { t } from "../editor/words";
import { caps } from "kit/key_caps";
import { KINDS } from "../editor/requests";
import { TOOL_KEYS } from "../editor/keys";
import type { EditorState } from "../editor/state";
import { LEVELS, percent, type Tool, TOOLS } from "./tools";
import { input, select } from "./part_list";

/** Changes of what the board shows. */
export interface Zoom {
  zoomBy(factor: number): void;
  fit(): void;
}

type FieldName = "width" | "snap" | "method" | "level";

/** The fields of each tool; a proposal is corrected with brush and lasso. */
const FIELDS: Record<Tool, readonly FieldName[]> = {
  select: [], brush: ["width"], lasso: ["snap"], propose: ["width", "method", "level"], split: [], join: [],
};

export class Toolbar {
  readonly tools = group(t("tools"));
  readonly options = document.createElement("div");
  readonly width = input("parts-width", "range");
  readonly level = input("parts-level", "range");
  private uses = new Map<Tool, HTMLButtonElement>();
  private newPart: HTMLButtonElement;
  private back: HTMLButtonElement;
  private again: HTMLButtonElement;
  private proposal: HTMLElement[];
  private erases: HTMLButtonElement;
  private addsTo: HTMLButtonElement;
  private fields: Record<FieldName, HTMLElement>;

  constructor(
    private state: EditorState,
    zoom: Zoom,
  ) {
    const { tools, drawing } = state;
    for (const tool of TOOLS) this.uses.set(tool, keyButton(t(tool), TOOL_KEYS[tool], () => state.use(tool)));
    this.newPart = keyButton(t("fresh"), "t", () => state.toggleNewPart());
    this.back = keyButton(t("undo"), "Ctrl+z", () => state.step("undo"));
    this.again = keyButton(t("redo"), "Ctrl+Shift+z", () => state.step("redo"));
    this.tools.append(
      ...this.uses.values(), gap(), this.newPart, gap(), this.back, this.again, gap(),
      keyButton(t("zoomIn"), "+", () => zoom.zoomBy(1.5)), keyButton(t("zoomOut"), "-", () => zoom.zoomBy(1 / 1.5)), keyButton(t("fit"), "0", () => zoom.fit()),
    );
    this.fields = { width: this.widthField(), snap: this.snapField(), method: this.methodField(), level: this.levelField() };
    this.erases = button(t("takeAway"), () => {
      tools.erases = !tools.erases;
      this.show();
    });
    const accept = keyButton(t("accept"), "Enter", () => tools.accept());
    accept.className = "primary";
    this.addsTo = button(t("addTo"), () => {
      tools.addsTo = !tools.addsTo;
      state.events.tell("options", null);
    });
    this.addsTo.id = "parts-add-to";
    this.proposal = [accept, this.addsTo, keyButton(t("discard"), "Escape", () => drawing.discard()), this.erases];
    this.options.className = "bar options";
    const { width, snap, method, level } = this.fields;
    const either = make("div", { className: "either" });
    either.append(width, snap); // no tool has both
    this.options.append(either, method, level, ...this.proposal);
  }

  show(): void {
    const { tools, drawing } = this.state;
    for (const [tool, each] of this.uses) each.ariaPressed = String(tool === tools.tool);
    this.newPart.ariaPressed = String(tools.newPart);
    this.erases.ariaPressed = String(tools.erases);
    this.addsTo.ariaPressed = String(tools.addsTo);
    this.back.disabled = !drawing.history.canUndo;
    this.again.disabled = !drawing.history.canRedo;
    for (const [name, each] of Object.entries(this.fields)) each.hidden = !(FIELDS[tools.tool] as readonly string[]).includes(name);
    this.fields.level.hidden ||= tools.how.kind !== "regions";
    for (const each of this.proposal) each.hidden = !drawing.proposed;
    this.erases.hidden ||= tools.tool !== "brush" && tools.tool !== "lasso";
    if (Math.abs(this.shownWidth - tools.width) >= 1) this.width.value = String(Math.log2(tools.width));
    this.width.setAttribute("aria-valuetext", t("pixels", { count: Math.round(tools.width) }));
    this.width.nextElementSibling!.textContent = this.width.getAttribute("aria-valuetext");
    const share = percent(tools.how.level);
    this.level.value = String(share);
    this.level.setAttribute("aria-valuetext", t("pieceLevel", { share }));
    this.level.nextElementSibling!.textContent = t("percent", { share });
  }

  private get shownWidth(): number {
    return 2 ** this.width.valueAsNumber;
  }

  /** Return the field of the brush's width, on a logarithmic scale. */
  private widthField(): HTMLElement {
    const most = Math.max(this.state.drawing.labels.columns, this.state.drawing.labels.rows);
    Object.assign(this.width, { min: "0", max: String(Math.log2(most)), step: "0.1" });
    this.width.addEventListener("input", () => {
      this.state.tools.width = Math.round(this.shownWidth);
      this.show();
    });
    const box = field(t("width"), this.width);
    box.append(document.createElement("output"));
    return box;
  }

  private snapField(): HTMLElement {
    const check = input("parts-snap", "checkbox");
    check.checked = this.state.tools.snaps;
    check.addEventListener("change", () => (this.state.tools.snaps = check.checked));
    return labelled(check, t("snap"));
  }

  private methodField(): HTMLElement {
    const choice = select("parts-method");
    for (const kind of KINDS) choice.add(new Option(t(kind), kind));
    choice.addEventListener("change", () => {
      void this.state.tools.change({ kind: choice.value });
      this.show();
    });
    return field(t("method"), choice);
  }

  /** Return the field of the size of a proposed region: by how many people would draw its border. */
  private levelField(): HTMLElement {
    const [min, max] = LEVELS;
    Object.assign(this.level, { min: String(min), max: String(max), step: "5" });
    this.level.addEventListener("input", () => {
      void this.state.tools.change({ level: this.level.valueAsNumber / 100 });
      this.show();
    });
    const box = field(t("piece"), this.level);
    box.append(document.createElement("output"));
    return box;
  }
}

function gap(): HTMLElement {
  return make("span", { className: "gap" });
}

export function group(name: string): HTMLElement {
  const box = make("div", { className: "bar" });
  box.setAttribute("role", "group");
  box.setAttribute("aria-label", name);
  return box;
}

/** Return a button that shows its key. */
export function keyButton(text: string, key: string, press: () => void): HTMLButtonElement {
  const toggle = button(text, press);
  const cap = caps(key);
  cap.setAttribute("aria-hidden", "true");
  toggle.append(" ", cap);
  toggle.setAttribute("aria-keyshortcuts", key.replace("Ctrl", "Control"));
  return toggle;
}
