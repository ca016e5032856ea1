/** Saving of the parts after questions, and live updates of heights and materials. */
import type { Server } from "kit/page";
import { shareOf, sliversInWords } from "./part_words";
import { question } from "../controls/question";
import { saveParts } from "./requests";
import { nameIn } from "./speech";
import type { EditorState, Update } from "./state";
import { t } from "./words";

/** Parts in pieces, and sizes of each, that a question lists. */
const MAX_LISTED = 6;

export class Saving {
  private running: Promise<boolean> | null = null;
  /** What the surface is made of, as JSON; empty if that is not known. */
  private felt: string;

  constructor(
    private state: EditorState,
    private net: Server,
    /** Returns whether every field is valid. */
    private isValid: () => boolean,
  ) {
    this.felt = JSON.stringify(state.base);
    state.events.on("parts", () => this.update());
  }

  /** Send heights and materials, so that they take effect before saving. Of those that wait, the server makes the newest alone. */
  update(wanted: Update = this.state.update()): void {
    const text = JSON.stringify(wanted);
    if (text === this.felt) return;
    this.felt = text;
    this.net.ask("parts_heights", { ...wanted }).catch((error: Error) => {
      if (this.felt === text) this.felt = "";
      this.state.fail(error);
    });
  }

  /** Save the parts; return whether they were saved. A save that runs is waited for. */
  save(): Promise<boolean> {
    const { tools } = this.state;
    if (tools.down || tools.busy || !this.isValid()) return Promise.resolve(false);
    this.running ??= this.run().finally(() => {
      this.running = null;
      this.state.saving = false;
    });
    this.state.saving = true;
    return this.running;
  }

  /** Return whether the editor may close, after a question if something would be lost. */
  async mayClose(): Promise<boolean> {
    await this.running;
    if (this.state.isSaved) return true;
    const answers = [["", t("goOn")], ["save", t("save")], ["lose", t("throwAway")]] as const;
    const answer = await question(t("unsaved"), [t("unsavedText")], answers);
    if (answer === "save") return this.save();
    if (answer === "lose") this.update(this.state.base);
    return answer === "lose";
  }

  private async run(): Promise<boolean> {
    const { state } = this;
    const { drawing } = state;
    drawing.discard();
    try {
      const given = drawing.tidy();
      if (!(await this.settle())) return false;
      const beside = await this.place();
      if (beside === null) return false;
      state.notify("saving", false);
      const { parts } = drawing;
      const steps = drawing.history.length;
      const saved = await saveParts(this.net, drawing.labels, parts, { ...state.savedDetails, of: state.digest, beside });
      state.markSaved(saved, parts, steps);
      this.felt = JSON.stringify(state.base);
      if (given) state.notify("savedTidy", false, { path: saved.file, given: sliversInWords(given) });
      else state.notify("saved", false, { path: saved.file });
      return true;
    } catch (error) {
      state.fail(error as Error);
      return false;
    }
  }

  /** Return whether a new file goes next to the photograph, after a question if it may; null to go on editing. */
  private async place(): Promise<boolean | null> {
    const { file, beside } = this.state;
    if (file || !beside) return false;
    const answers = [["", t("goOn")], ["beside", t("beside", { folder: beside })], ["own", t("ownFolder")]] as const;
    const answer = await question(t("saveWhere"), [t("whereText")], answers);
    return answer ? answer === "beside" : null;
  }

  /** Make every part one piece, after a question if some are not; return whether to go on. */
  private async settle(): Promise<boolean> {
    const { drawing } = this.state;
    const scattered = [...drawing.scattered()];
    if (!scattered.length) return true;
    const pixels = drawing.labels.data.length;
    const texts = scattered.slice(0, MAX_LISTED).map(([label, sizes]) => {
      const listed = sizes.slice(0, MAX_LISTED).map((each) => shareOf(each / pixels)).join(", ");
      return t("inPieces", { name: nameIn(this.state, label), count: sizes.length, sizes: listed + (sizes.length > MAX_LISTED ? " …" : "") });
    });
    if (scattered.length > MAX_LISTED) texts.push(t("morePieces", { count: scattered.length - MAX_LISTED }));
    texts.push(t("eachBecomes"));
    const answer = await question(t("scattered"), texts, [["", t("goOn")], ["pieces", t("savePieces")]]);
    if (answer) drawing.settle();
    return answer !== "";
  }
}
