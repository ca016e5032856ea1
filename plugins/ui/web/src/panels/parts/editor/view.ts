/** The elements of the parts editor: they show its state and change with it. */
import { button, foldable, make, tableWithHeads } from "kit/elements";
import { t as frame } from "../../../frame/words";
import { caps } from "kit/key_caps";
import { Board } from "../board/board";
import { attachPointers } from "../board/pointers";
import { PartList } from "../controls/part_list";
import { PictureFields } from "../controls/picture_fields";
import { Toolbar } from "../controls/toolbar";
import type { Point } from "../pixels/labels";
import { KEYS } from "./keys";
import { helpOf, textOf } from "./speech";
import type { EditorState } from "./state";
import { t } from "./words";

/** Names and sizes are found again when nothing was drawn for this long. */
const REST_MS = 150;

export class EditorView {
  readonly root = document.createElement("section");
  readonly board: Board;
  readonly list: PartList;
  readonly fields: PictureFields;
  private status = document.createElement("p");
  private toolbar: Toolbar;
  private keys = foldable(t("keys"), keyTable());
  private resting = 0;

  constructor(
    private state: EditorState,
    picture: ImageBitmap,
    materials: string[],
    ends: { save(): unknown; close(): unknown },
  ) {
    const { drawing, tools } = state;
    this.board = new Board(drawing, picture);
    this.list = new PartList(drawing, materials);
    this.fields = new PictureFields(state);
    this.toolbar = new Toolbar(state, this);
    tools.scale = () => this.board.scale;
    this.build(ends);
    this.subscribe();
    this.listen();
  }

  zoomBy(factor: number): void {
    const { viewport } = this.board;
    viewport.zoomBy(factor, this.state.crosshair ? viewport.toBoard(this.state.crosshair) : undefined);
    this.board.look();
  }

  fit(): void {
    this.board.viewport.fit();
    this.board.look();
  }

  showKeys(): void {
    this.keys.open = true;
    this.keys.querySelector("summary")!.focus();
  }

  close(): void {
    clearTimeout(this.resting);
    this.root.remove();
    this.board.close();
    document.body.classList.remove("editing");
  }

  private build(ends: { save(): unknown; close(): unknown }): void {
    const { root, board, list } = this;
    root.id = "parts-editor";
    root.setAttribute("aria-label", frame("parts-editor"));
    board.canvas.id = "parts-picture";
    board.canvas.tabIndex = 0;
    board.canvas.setAttribute("role", "application");
    board.canvas.setAttribute("aria-label", t("picture"));
    const keys = make("p", { id: "parts-keys", className: "visually-hidden", textContent: t("pictureKeys") });
    board.canvas.setAttribute("aria-describedby", keys.id);
    this.status.className = "told";
    this.status.id = "parts-told";
    const stage = make("div", { className: "stage" });
    stage.append(this.toolbar.tools, board.element, this.status, this.toolbar.options, keys);
    const buttons = make("div", { className: "buttons" });
    const save = button(t("saveAndClose"), () => ends.save(), { id: "parts-save", className: "primary" });
    buttons.append(save, button(t("close"), () => ends.close()));
    const column = make("div", { className: "side" });
    column.append(buttons, list.list, list.said, ...this.fields.elements, this.keys);
    root.append(stage, column);
    document.getElementById("main")!.before(root);
    document.body.classList.add("editing");
    board.dress();
  }

  private subscribe(): void {
    const { state, board, list } = this;
    const { events } = state;
    events.on("pixels", (box) => board.changed(box, window.event?.timeStamp ?? performance.now()));
    events.on("parts", () => {
      list.show();
      this.showOptions();
      clearTimeout(this.resting);
      this.resting = window.setTimeout(() => state.survey(), REST_MS);
    });
    events.on("survey", () => this.showSurvey());
    for (const name of ["options", "tool", "notice", "where"] as const) events.on(name, () => this.showOptions());
    events.on("width", () => this.toolbar.show());
    events.on("crosshair", (at) => this.showCrosshair(at));
  }

  private listen(): void {
    const { state, board, list } = this;
    list.onSelect = (label) => state.select(label);
    list.onJoin = (label) => state.join(label);
    list.onReorder = () => state.events.tell("reordered", null);
    list.numberOf = (label) => state.numberOf(label);
    list.isFelt = (label) => state.isFelt(label);
    attachPointers(board, state.tools, {
      moved: (at, event) => this.showPointer(at, event.pointerType !== "touch"),
      lifted: () => state.lifted(),
    });
    board.canvas.addEventListener("pointerleave", () => board.mark({ at: null }));
    board.canvas.addEventListener("focus", () => board.canvas.matches(":focus-visible") && state.moveCrosshair(0, 0));
    board.canvas.addEventListener("blur", () => board.mark({ at: null }));
  }

  private showOptions(): void {
    const { notice } = this.state;
    this.toolbar.show();
    this.board.mark(this.tip);
    const text = notice ? textOf(this.state, notice) : helpOf(this.state);
    if (this.status.textContent !== text) this.status.textContent = text;
    this.status.classList.toggle("bad", notice?.bad ?? false);
  }

  private showSurvey(): void {
    const { drawing, places } = this.state;
    const named = drawing.parts.flatMap((part) => {
      const place = places.get(part.label);
      const number = this.state.numberOf(part.label);
      return place ? [{ place, label: part.label, text: part.name ? `${number} ${part.name}` : String(number) }] : [];
    });
    this.board.name(named.sort((a, b) => b.place.pixels - a.place.pixels));
    this.list.neighbours = this.state.neighbours;
    this.list.show();
    this.showOptions();
  }

  private showPointer(at: Point, shown: boolean): void {
    this.state.crosshair = at;
    this.board.mark({ ...this.tip, at: shown || this.state.tools.down ? at : null, cross: false });
  }

  private showCrosshair(at: Point): void {
    const { board } = this;
    const { tools } = this.state;
    if (board.viewport.reveal(at)) board.look();
    const line = tools.down && tools.tool !== "brush" && tools.tool !== "select" ? [...tools.line, at] : [];
    board.mark({ ...this.tip, line, at, cross: true });
  }

  /** The marks of the tool in use. */
  private get tip(): { line: readonly Point[]; closed: boolean; brush: number } {
    const { tool, line, width } = this.state.tools;
    const brush = tool === "brush" || tool === "propose" ? width : 0;
    return { line: tool === "brush" || tool === "select" ? [] : line, closed: tool === "lasso", brush };
  }
}

function keyTable(): HTMLTableElement {
  const table = tableWithHeads(t("keys"), [t("key"), t("does")], "keys");
  const body = table.createTBody();
  for (const [name, keys] of Object.entries(KEYS)) {
    const row = body.insertRow();
    row.insertCell().append(...keys.flatMap((each) => [caps(each), " "]));
    row.insertCell().textContent = t(name as keyof typeof KEYS);
  }
  return table;
}
