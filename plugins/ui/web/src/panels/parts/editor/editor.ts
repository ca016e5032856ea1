/** The editor of the parts: the picture with their borders in place of the columns, and all that is done to them. */
import { button, headed } from "../../../elements";
import type { Page } from "../../../page";
import { letters, pressed } from "../../../shortcuts";
import { t } from "./words";
import { t as frame } from "../../../frame/words";
import { caps } from "../../help/panel";
import { opened, type Opened, save } from "./requests";
import { Bar } from "../controls/toolbar";
import { Board } from "../board/board";
import { Drawing, Full } from "../drawing/drawing";
import { KEYS, TOOL_KEYS, WAYS } from "./keys";
import { labelAt, type Point } from "../pixels/labels";
import { type Felt, Live } from "./live_update";
import { neighboursOf, type Place, placesOf } from "../pixels/pieces";
import { type Fault, Pens, type Tool } from "../controls/tools";
import { pointers } from "../board/pointers";
import { question } from "./question";
import { Side } from "../controls/part_list";
import { called, heightOf, placeOf, shareOf, whereOf } from "./part_words";
import { folded, Words } from "../controls/picture_fields";

/** Names and sizes are found anew when nothing was drawn for so long. */
const REST_MS = 150;
/** Steps of the crosshair in pixels of the page. */
const STEP_PX = { usual: 8, far: 64 };
/** Pieces of a smaller share of the picture are crumbs. */
const CRUMB = 0.0005;
const MOST_TOLD = 6;
const TYPED = "input:not([type=checkbox], [type=range]), select, textarea";

/** The one that is open; the hub keeps who hears it. */
let current: Editor | null = null;
let hears = false;

/** Open the editor; ends when it is open. back: what gets the focus when it is closed. */
export async function edit(page: Page, back: HTMLElement): Promise<void> {
  if (!hears) page.hub.on("theme", () => current?.dress());
  hears = true;
  const [scene, library] = await Promise.all([opened(page.net), page.net.ask<{ name: string }[]>("library").catch(() => [])]);
  current ??= new Editor(page, scene, library.map(({ name }) => name), back);
}

class Editor {
  private root = document.createElement("section");
  private told = document.createElement("p");
  private helped = "";
  private drawing: Drawing;
  private board: Board;
  private pens: Pens;
  private bar: Bar;
  private side: Side;
  private words: Words;
  private live: Live;
  private places = new Map<number, Place>();
  private order = new Map<number, number>();
  /** The numbers that labels were opened or saved with, and what was said of them. */
  private numbers: Map<number, number>;
  private base: Felt;
  private digest: string;
  private resting = 0;
  private cross: Point | null = null;
  private asking = false;
  private saving: Promise<boolean> | null = null;

  constructor(
    private page: Page,
    scene: Opened,
    materials: string[],
    private back: HTMLElement,
  ) {
    this.digest = scene.digest;
    this.drawing = new Drawing(scene.labels, scene.parts, scene.top_m);
    this.numbers = new Map(scene.parts.map(({ label }) => [label, label]));
    this.board = new Board(this.drawing, scene.picture);
    this.pens = new Pens(this.drawing, page.net, () => this.board.scale);
    this.pens.width = Math.max(1, Math.round(Math.max(scene.labels.columns, scene.labels.rows) / 40));
    this.pens.fresh = scene.parts.length === 1;
    this.side = new Side(this.drawing, materials);
    this.words = new Words(scene);
    this.base = this.feltNow();
    this.live = new Live((felt) => page.net.ask("parts_heights", { ...felt }), (error) => this.say(t("failed", { why: error.message })));
    this.bar = new Bar(this.drawing, this.pens, {
      use: (tool) => this.use(tool),
      fresh: () => this.toggleFresh(),
      accept: () => this.pens.accept(),
      discard: () => this.drawing.discard(),
      undo: () => this.step("undo"),
      redo: () => this.step("redo"),
      nearer: (factor) => this.nearer(factor),
      fit: () => this.fit(),
    });
    this.build();
    this.listen();
    this.survey();
    this.side.list.focus();
  }

  private build(): void {
    const { root, board, side } = this;
    root.id = "parts-editor";
    root.setAttribute("aria-label", frame("parts-editor"));
    board.canvas.id = "parts-picture";
    board.canvas.tabIndex = 0;
    board.canvas.setAttribute("role", "application");
    board.canvas.setAttribute("aria-label", t("picture"));
    const keys = Object.assign(document.createElement("p"), { id: "parts-keys", className: "visually-hidden", textContent: t("pictureKeys") });
    board.canvas.setAttribute("aria-describedby", keys.id);
    this.told.className = "told";
    this.told.id = "parts-told";
    const stage = Object.assign(document.createElement("div"), { className: "stage" });
    stage.append(this.bar.tools, this.bar.options, board.element, this.told, keys);
    const ends = Object.assign(document.createElement("div"), { className: "buttons" });
    const saves = button(t("save"), () => this.save());
    saves.id = "parts-save";
    saves.className = "primary";
    ends.append(saves, button(t("close"), () => this.close()));
    const column = Object.assign(document.createElement("div"), { className: "side" });
    column.append(ends, side.list, side.said, ...this.words.elements, folded(t("keys"), [table()]));
    root.append(stage, column);
    document.getElementById("main")!.before(root);
    document.body.classList.add("editing");
    board.dress();
  }

  private listen(): void {
    const { drawing, board, pens, side, root } = this;
    drawing.changed = (box, parts) => {
      board.changed(box, this.eventMs());
      if (parts) this.changed();
      else this.bar.show();
    };
    pens.failed = (why) => this.complain(why);
    pens.waits = (busy) => (busy ? this.say(t("proposing"), false) : this.help());
    pens.chose = (label) => this.choose(label);
    side.chose = (label) => this.choose(label);
    side.joined = (label) => this.tried(() => drawing.join(label, drawing.selected));
    side.ordered = () => this.tellOrder();
    side.numberOf = (label) => this.order.get(label) ?? label;
    side.isFelt = (label) => this.numbers.has(label);
    this.words.shaped = () => this.feel();
    pointers(board, pens, {
      moved: (at, event) => this.pointed(at, event.pointerType !== "touch"),
      lifted: () => this.lifted(),
    });
    board.canvas.addEventListener("pointerleave", () => board.mark({ at: null }));
    board.canvas.addEventListener("focus", () => board.canvas.matches(":focus-visible") && this.moveCross(0, 0));
    board.canvas.addEventListener("blur", () => board.mark({ at: null }));
    root.addEventListener("keydown", (event) => this.key(event));
    window.addEventListener("beforeunload", this.leaving);
  }

  dress(): void {
    this.board.dress();
  }

  private leaving = (event: BeforeUnloadEvent): void => {
    if (!this.isSaved) event.preventDefault();
  };

  private get isSaved(): boolean {
    return this.drawing.saved && !this.words.changed;
  }

  /** When what is done now was asked for, on the clock of drawings. */
  private eventMs(): number {
    return window.event?.timeStamp ?? performance.now();
  }

  // -- what is seen and said --

  /** Parts changed: their list at once, names and sizes when nothing more is drawn. */
  private changed(): void {
    this.bar.show();
    this.side.show();
    this.help();
    this.feel();
    clearTimeout(this.resting);
    this.resting = window.setTimeout(() => this.survey(), REST_MS);
  }

  private survey(): void {
    const { drawing, side, board } = this;
    this.places = placesOf(drawing.labels);
    this.order = new Map([...this.places.keys()].map((label, i) => [label, i]));
    const touching = neighboursOf(drawing.labels, drawing.selected);
    side.neighbours = drawing.parts.filter(({ label }) => touching.has(label));
    const named = drawing.parts.flatMap((part) => {
      const place = this.places.get(part.label);
      const number = this.order.get(part.label)!;
      return place ? [{ place, label: part.label, text: part.name ? `${number} ${part.name}` : String(number) }] : [];
    });
    board.name(named.sort((a, b) => b.place.pixels - a.place.pixels));
    this.bar.show();
    side.show();
    if (this.told.textContent === this.helped) this.help(); // what was said stays
  }

  private named(label: number): string {
    return called(this.drawing.part(label), this.side.numberOf(label));
  }

  /** What the tool in use does, and to which part. */
  private help(): void {
    const { pens, drawing } = this;
    const paints = ["brush", "lasso", "propose"].includes(pens.tool);
    const what = pens.fresh ? t("intoFresh") : t("into", { name: this.named(drawing.selected) });
    const help = drawing.proposed ? t("proposed") : t(`${pens.tool}Help`);
    this.told.textContent = this.helped = paints ? `${help} ${what}` : help;
    this.told.classList.remove("bad");
  }

  /** Shown until something else is done, and said. */
  private say(text: string, bad = true): void {
    this.told.textContent = text;
    this.told.classList.toggle("bad", bad);
    this.page.say(text, { topic: "parts" });
  }

  private complain(why: Fault | Error): void {
    this.bar.show();
    if (why instanceof Full) this.say(t("full"));
    else if (why instanceof Error) this.say(t("failed", { why: why.message }));
    else this.say(t(why, { name: this.named(this.drawing.selected) }));
  }

  private choose(label: number): void {
    const { drawing, pens } = this;
    drawing.endGesture();
    drawing.selected = label;
    if (pens.tool !== "select") pens.fresh = false;
    this.survey();
    const part = drawing.part(label);
    const place = this.places.get(label);
    if (part && place)
      this.page.say(
        t("said", { name: this.named(label), height: heightOf(part), share: shareOf(drawing.share(label)), place: placeOf(place, drawing.labels) }),
        { topic: "parts", asked: true },
      );
  }

  private tellOrder(): void {
    const { drawing } = this;
    const part = drawing.part(drawing.selected)!;
    const before = drawing.parts.filter((each) => each.height_m > part.height_m).length;
    const said = { name: this.named(part.label), place: before + 1, count: drawing.parts.length, height: heightOf(part) };
    this.page.say(t("order", said), { topic: "parts", asked: true });
  }

  // -- what is done --

  private use(tool: Tool): void {
    this.pens.cancel();
    this.pens.tool = tool;
    this.lifted();
    this.bar.show();
    this.help();
    this.page.say(`${t(tool)}. ${this.told.textContent}`, { topic: "tool", asked: true });
  }

  /** By a key: what is chosen is used on the picture. */
  private take(act: () => void): void {
    this.board.canvas.focus();
    act();
  }

  private toggleFresh(): void {
    this.pens.fresh = !this.pens.fresh || this.drawing.parts.length === 1; // there is nothing else to paint
    if (this.pens.tool === "select") this.pens.tool = "brush";
    this.bar.show();
    this.help();
    this.page.say(this.told.textContent!, { topic: "tool", asked: true });
  }

  private tried(act: () => void): void {
    try {
      act();
    } catch (error) {
      this.complain(error as Error);
    }
  }

  private step(which: "undo" | "redo"): void {
    if (this.pens.down || this.pens.busy || this.saving) return;
    this.drawing.discard();
    const done = this.drawing[which]();
    if (which === "undo") this.say(t(done ? "undone" : "nothingToUndo"), false);
    else this.say(t(done ? "redone" : "nothingToRedo"), false);
  }

  private nearer(factor: number): void {
    const { sight } = this.board;
    sight.nearer(factor, this.cross ? sight.toBoard(this.cross) : undefined);
    this.board.look();
  }

  private fit(): void {
    this.board.sight.fit();
    this.board.look();
  }

  private thicken(by: number): void {
    const { labels } = this.drawing;
    const wanted = by > 0 ? Math.max(this.pens.width + 1, this.pens.width * 1.25) : Math.min(this.pens.width - 1, this.pens.width / 1.25);
    this.pens.width = Math.max(1, Math.min(Math.max(labels.columns, labels.rows), Math.round(wanted)));
    this.bar.show();
    this.lifted();
    this.page.say(t("pixels", { count: this.pens.width }), { topic: "tool", asked: true });
  }

  // -- the pointer and the crosshair --

  private pointed(at: Point, shown: boolean): void {
    const { pens, board } = this;
    this.cross = at;
    board.mark({ ...this.tip, at: shown || pens.down ? at : null, cross: false });
  }

  private lifted(): void {
    this.board.mark(this.tip);
    this.bar.show();
    if (!this.pens.busy && !this.told.classList.contains("bad")) this.help();
  }

  /** What the tool shows. */
  private get tip(): { line: readonly Point[]; closed: boolean; brush: number } {
    const { tool, line, width } = this.pens;
    const brush = tool === "brush" || tool === "propose" ? width : 0;
    return { line: tool === "brush" || tool === "select" ? [] : line, closed: tool === "lasso", brush };
  }

  private moveCross(dx: number, dy: number): void {
    const { board, drawing, pens } = this;
    const { columns, rows } = drawing.labels;
    const from = this.cross ?? this.places.get(drawing.selected)?.at ?? [columns / 2, rows / 2];
    const before = labelAt(drawing.labels, ...from);
    const within = (at: number, most: number): number => Math.max(0, Math.min(most - 1, Math.floor(at))) + 0.5;
    const at: Point = [within(from[0] + dx, columns), within(from[1] + dy, rows)];
    this.cross = at;
    if (dx || dy) pens.move(at);
    if (board.sight.reveal(at)) board.look();
    const line = pens.down && pens.tool !== "brush" && pens.tool !== "select" ? [...pens.line, at] : [];
    board.mark({ ...this.tip, line, at, cross: true });
    const now = labelAt(drawing.labels, ...at);
    if (now !== before && pens.tool !== "brush") this.page.say(this.named(now), { topic: "cross" });
  }

  private async pen(): Promise<void> {
    const { pens } = this;
    const tool = t(pens.tool);
    if (!this.cross) this.moveCross(0, 0);
    if (!pens.down) {
      pens.put(this.cross!);
      if (pens.tool !== "select" && pens.tool !== "join") return this.page.say(t("down", { tool }), { topic: "tool", asked: true });
    }
    pens.move(this.cross!);
    if (pens.tool !== "select") this.page.say(t("up", { tool }), { topic: "tool" });
    await pens.lift();
    this.lifted();
    if (this.drawing.proposed) this.page.say(t("proposed"), { topic: "tool" });
  }

  // -- keys --

  private key(event: KeyboardEvent): void {
    if (event.isComposing || event.defaultPrevented) return;
    const target = event.target as HTMLElement;
    const key = pressed(event);
    const typed = target.matches(TYPED);
    const act = this.everywhere(key) ?? (typed ? undefined : this.letter(key, target)) ?? (target === this.board.canvas ? this.onPicture(event) : undefined);
    if (!act || (typed && (key === "Ctrl+z" || key === "Ctrl+Shift+z"))) return; // a field takes back its own letters
    event.preventDefault();
    act();
  }

  private everywhere(key: string): (() => void) | undefined {
    if (key === "Escape") return () => this.escape();
    if (key === "Ctrl+z") return () => this.step("undo");
    if (key === "Ctrl+Shift+z" || key === "Ctrl+y") return () => this.step("redo");
    if (key === "Ctrl+s") return () => void this.save();
    return undefined;
  }

  private letter(key: string, target: HTMLElement): (() => void) | undefined {
    if (!letters.everywhere && target !== this.board.canvas) return undefined;
    const tool = (Object.keys(TOOL_KEYS) as Tool[]).find((each) => TOOL_KEYS[each] === key);
    if (tool) return () => this.take(() => this.use(tool));
    if (key === "t") return () => this.take(() => this.toggleFresh());
    if (key === "o") return () => this.side.list.focus();
    if (key === "[" || key === "]") return () => this.thicken(key === "]" ? 1 : -1);
    if (key === "i") return () => this.tellWhere();
    if (key === "?" || key === "F1") return () => this.showKeys();
    return undefined;
  }

  private onPicture({ key, shiftKey, ctrlKey, altKey, repeat }: KeyboardEvent): (() => void) | undefined {
    const way = WAYS[key];
    if (way && !altKey) {
      const step = shiftKey ? 1 : Math.max(1, (ctrlKey ? STEP_PX.far : STEP_PX.usual) * this.board.scale);
      return () => this.moveCross(way[0] * step, way[1] * step);
    }
    if (key === " ") return () => void (repeat || this.pen());
    if (key === "Enter") return () => (this.drawing.proposed && !this.pens.down ? this.pens.accept() : void this.pen());
    if (key === "+" || key === "-") return () => this.nearer(key === "+" ? 1.25 : 0.8);
    if (key === "0") return () => this.fit();
    return undefined;
  }

  private tellWhere(): void {
    const { labels } = this.drawing;
    if (!this.cross) this.moveCross(0, 0);
    const label = labelAt(labels, ...this.cross!);
    const text = whereOf(this.cross!, labels, label < 0 ? t("outside") : this.named(label));
    this.told.textContent = text;
    this.page.say(text, { topic: "cross", asked: true });
  }

  private showKeys(): void {
    const box = this.root.querySelector<HTMLDetailsElement>(".side > details:last-of-type")!;
    box.open = true;
    box.querySelector("summary")!.focus();
  }

  /** What is begun is given up first; then it closes. */
  private escape(): void {
    if (this.pens.cancel()) this.lifted();
    else if (this.drawing.proposed) this.drawing.discard();
    else void this.close();
  }

  // -- felt, saved, closed --

  /** What is said of parts that were opened or saved is felt at once. */
  private feel(): void {
    this.live.feel(this.feltNow(), this.base);
  }

  private feltNow(): Felt {
    const heights_m = [...(this.base?.heights_m ?? [])];
    const materials = [...(this.base?.materials ?? [])];
    const { parts } = this.drawing;
    for (const { label, height_m, material, automatic } of parts) {
      const number = this.numbers.get(label);
      if (number === undefined) continue;
      heights_m[number] = automatic ? null : height_m;
      materials[number] = material;
    }
    return { heights_m, materials, heights: this.words.said(parts.some((each) => each.automatic)).heights };
  }

  /** Whether it was saved; one that goes on is waited for. */
  private save(): Promise<boolean> {
    if (this.pens.down || this.pens.busy || this.words.wrong) return Promise.resolve(false);
    this.saving ??= this.saves().finally(() => (this.saving = null));
    return this.saving;
  }

  private async saves(): Promise<boolean> {
    const { drawing } = this;
    drawing.discard();
    try {
      if (!(await this.settled())) return false;
      this.say(t("saving"), false);
      const steps = drawing.steps;
      const { parts } = drawing;
      const automatic = parts.some((each) => each.automatic);
      const said = await save(this.page.net, drawing.labels, parts, { ...this.words.said(automatic), of: this.digest });
      this.digest = said.digest;
      this.numbers = new Map(parts.map(({ label }) => [label, said.numbers[label]![0]!]));
      this.base = { heights_m: [], materials: [], heights: {} };
      this.base = this.feltNow();
      this.live.settled();
      drawing.keep(steps);
      this.words.changed = false;
      this.survey();
      this.say(t("saved", { path: said.path }), false);
      return true;
    } catch (error) {
      this.complain(error as Error);
      return false;
    }
  }

  /** Whether every part is one piece now, after a question where some were not. */
  private async settled(): Promise<boolean> {
    const { drawing } = this;
    const scattered = [...drawing.scattered()];
    if (!scattered.length) return true;
    const whole = drawing.labels.data.length;
    const texts = scattered.slice(0, MOST_TOLD).map(([label, sizes]) => {
      const said = sizes.slice(0, MOST_TOLD).map((each) => shareOf(each / whole));
      return t("inPieces", { name: this.named(label), count: sizes.length, sizes: said.join(", ") + (sizes.length > MOST_TOLD ? " …" : "") });
    });
    if (scattered.length > MOST_TOLD) texts.push(t("morePieces", { count: scattered.length - MOST_TOLD }));
    texts.push(t("eachBecomes", { share: shareOf(CRUMB) }));
    const answer = await question(t("scattered"), texts, [["", t("goOn")], ["tidy", t("saveTidy")], ["pieces", t("savePieces")]]);
    if (answer) drawing.settle(answer === "tidy" ? CRUMB * whole : 0);
    return answer !== "";
  }

  /** After a question, where something would be lost. */
  private async close(): Promise<void> {
    await this.saving;
    if (current !== this || this.asking) return;
    this.asking = true;
    const may = await this.mayClose();
    this.asking = false;
    if (!may) return;
    current = null;
    clearTimeout(this.resting);
    window.removeEventListener("beforeunload", this.leaving);
    this.root.remove();
    this.board.close();
    document.body.classList.remove("editing");
    this.back.focus();
  }

  private async mayClose(): Promise<boolean> {
    if (this.isSaved) return true;
    const answers = [["", t("goOn")], ["save", t("save")], ["lose", t("throwAway")]] as const;
    const answer = await question(t("unsaved"), [t("unsavedText")], answers);
    if (answer === "save") return this.save();
    if (answer === "lose") this.live.feel(this.base, this.base);
    return answer === "lose";
  }
}

function table(): HTMLTableElement {
  const made = headed(t("keys"), [t("key"), t("does")], "keys");
  const body = made.createTBody();
  for (const [name, keys] of Object.entries(KEYS)) {
    const row = body.insertRow();
    row.insertCell().append(...keys.flatMap((each) => [caps(each), " "]));
    row.insertCell().textContent = t(name as keyof typeof KEYS);
  }
  return made;
}
