/** The parts editor: the picture with the borders of its parts, in place of the page's columns. */
import type { Page, Server } from "kit/page";
import { letters, keyName } from "kit/shortcuts";
import { type Action, actionOf } from "./keys";
import { firstParts, type Opened, openParts, proposePart, snapOutline } from "./requests";
import { Saving } from "./saving";
import { announce } from "./speech";
import { EditorState } from "./state";
import { EditorView } from "./view";

type Shared = Pick<Page, "hub" | "net" | "say">;

/** Steps of the crosshair in CSS pixels. */
const STEP_PX = { step: 8, far: 64 };
const TYPING = "input:not([type=checkbox], [type=range]), select, textarea";

/** The open editor: one listener of the hub serves every editor that is opened. */
let current: Editor | null = null;
let listens = false;

/** Open the editor; resolves when it is open. back: the element that gets the focus when it closes. */
export async function edit(page: Shared, back: HTMLElement): Promise<void> {
  if (!listens) page.hub.on("theme", () => current?.dress());
  listens = true;
  const [scene, library] = await Promise.all([openParts(page.net), page.net.ask<{ name: string }[]>("library").catch(() => [])]);
  current ??= new Editor(page, scene, library.map(({ name }) => name), back);
}

class Editor {
  private state: EditorState;
  private view: EditorView;
  private saving: Saving;
  private asking = false;

  constructor(
    page: Shared,
    scene: Opened,
    materials: string[],
    private back: HTMLElement,
  ) {
    const { net } = page;
    this.state = new EditorState(scene, {
      propose: (stroke, width_px, how) => proposePart(net, stroke, width_px, how),
      snap: (outline, reach_px) => snapOutline(net, outline, reach_px),
    });
    this.view = new EditorView(this.state, scene.picture, materials, { save: async () => (await this.saving.save()) && this.close(), close: () => this.close() });
    this.saving = new Saving(this.state, net, () => this.view.fields.reportValidity());
    this.view.fields.onShape = () => this.saving.update();
    announce(this.state, (text, options) => page.say(text, options));
    this.view.root.addEventListener("keydown", (event) => this.key(event));
    window.addEventListener("beforeunload", this.leaving);
    this.state.survey();
    this.view.list.list.focus();
    if (!scene.divided) void this.begin(net);
  }

  dress(): void {
    this.view.board.dress();
  }

  /** Begin with parts that the program proposes; without them the picture is one part, to draw on. */
  private async begin(net: Server): Promise<void> {
    this.state.notify("searching", false);
    try {
      const proposed = await firstParts(net);
      if (current === this) this.state.begin(proposed);
    } catch (error) {
      this.state.fail(error as Error);
    }
  }

  private leaving = (event: BeforeUnloadEvent): void => {
    if (!this.state.isSaved) event.preventDefault();
  };

  private key(event: KeyboardEvent): void {
    if (event.isComposing || event.defaultPrevented) return;
    const target = event.target as HTMLElement;
    const where = { typing: target.matches(TYPING), onPicture: target === this.view.board.canvas, letters: letters.everywhere };
    const action = actionOf(keyName(event), event, where);
    if (!action) return;
    event.preventDefault();
    this.act(action);
  }

  private act(action: Action): void {
    const { state, view } = this;
    switch (action.do) {
      case "escape":
        return state.cancel() ? undefined : void this.close();
      case "undo":
      case "redo":
        return state.step(action.do);
      case "save":
        return void this.saving.save();
      case "use":
        view.board.canvas.focus();
        return state.use(action.tool);
      case "new part":
        view.board.canvas.focus();
        return state.toggleNewPart();
      case "list":
        return view.list.list.focus();
      case "narrower":
      case "wider":
        return state.resizeBrush(action.do === "wider" ? 1 : -1);
      case "where":
        return state.tellWhere();
      case "keys":
        return view.showKeys();
      case "move":
        return this.move(action);
      case "pen":
        return void state.pen();
      case "finish":
        return state.finish();
      case "nearer":
        return view.zoomBy(1.25);
      case "farther":
        return view.zoomBy(0.8);
      case "fit":
        return view.fit();
      case "nothing":
    }
  }

  private move({ x, y, pace }: Action & { do: "move" }): void {
    const step = pace === "pixel" ? 1 : Math.max(1, STEP_PX[pace] * this.view.board.scale);
    this.state.moveCrosshair(x * step, y * step);
  }

  private async close(): Promise<void> {
    if (current !== this || this.asking) return;
    this.asking = true;
    const may = await this.saving.mayClose();
    this.asking = false;
    if (!may || current !== this) return;
    current = null;
    window.removeEventListener("beforeunload", this.leaving);
    this.view.close();
    this.back.focus();
  }
}
