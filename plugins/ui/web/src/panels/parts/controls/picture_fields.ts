/** Fields for the picture's title and language, and for the shape of all parts. */
import { field, foldable } from "kit/elements";
import { SHAPES } from "../drawing/picture_details";
import type { EditorState } from "../editor/state";
import { t } from "../editor/words";
import { input } from "./part_list";

const MM = 1000;
const MAX_MM = { round_m: 100, bulge_m: 10, detail_m: 10 };

export class PictureFields {
  readonly elements: HTMLElement[];
  /** Called when the shape of the parts changed. */
  onShape: () => void = () => undefined;
  private shapes: HTMLInputElement[];

  constructor(private state: EditorState) {
    const { title, language } = state.details;
    this.shapes = SHAPES.map((name) => this.shape(name));
    const texts = [field(t("pictureTitle"), this.text("title", title)), field(t("language"), this.text("language", language))];
    (texts[1]!.lastElementChild as HTMLInputElement).size = 5;
    this.elements = [
      foldable(t("picturesWords"), ...texts),
      foldable(t("shapes"), ...SHAPES.map((name, i) => field(t(name), this.shapes[i]!))),
    ];
  }

  /** Return whether every field is valid; the first that is not gets the focus. */
  reportValidity(): boolean {
    return this.shapes.every((each) => each.reportValidity());
  }

  private text(name: "title" | "language", value: string): HTMLInputElement {
    const box = input(`parts-${name}`, "text");
    box.value = value;
    box.addEventListener("input", () => this.state.setDetails({ [name]: box.value }));
    return box;
  }

  private shape(name: (typeof SHAPES)[number]): HTMLInputElement {
    const { details } = this.state;
    const box = input(`parts-${name}`, "number");
    Object.assign(box, { min: "0", max: String(MAX_MM[name]), step: "any", value: String(Math.round(1e5 * details.heights[name]) / 100) });
    box.addEventListener("input", () => {
      if (!box.checkValidity()) return this.state.setDetails({});
      const metres = Math.round((1e5 * (box.valueAsNumber || 0)) / MM) / 1e5;
      this.state.setDetails({ heights: { ...details.heights, [name]: metres } });
      this.onShape();
    });
    return box;
  }
}
