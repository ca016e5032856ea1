/** What is said of the picture and of the shape of all parts: fields that are saved along. */
import { field } from "../../../elements";
import { t } from "../editor/words";
import type { Heights, Opened } from "../editor/requests";
import { input } from "./part_list";

const SHAPES = ["round_m", "bulge_m", "detail_m"] as const;
const MM = 1000;
const MOST_MM = { round_m: 100, bulge_m: 10, detail_m: 10 };

export class Words {
  readonly elements: HTMLElement[];
  changed = false;
  /** Hears that the shape of the parts is another. */
  shaped: () => void = () => undefined;
  private title = input("parts-title", "text");
  private language = input("parts-language", "text");
  private shapes = new Map(SHAPES.map((name) => [name, input(`parts-${name}`, "number")]));

  constructor(private opened: Opened) {
    this.title.value = opened.title;
    this.language.value = opened.language;
    this.language.size = 5;
    const shape = SHAPES.map((name) => {
      const box = this.shapes.get(name)!;
      Object.assign(box, { min: "0", max: String(MOST_MM[name]), step: "any", value: String(Math.round(1e5 * opened.heights[name]) / 100) });
      return field(t(name), box);
    });
    this.elements = [
      folded(t("picturesWords"), [field(t("pictureTitle"), this.title), field(t("language"), this.language)]),
      folded(t("shapes"), shape),
    ];
    for (const each of [this.title, this.language, ...this.shapes.values()]) each.addEventListener("input", () => (this.changed = true));
    for (const each of this.shapes.values()) each.addEventListener("input", () => each.checkValidity() && this.shaped());
  }

  /** A field that cannot be sent as it is: it has the focus then. */
  get wrong(): boolean {
    const wrong = [...this.shapes.values()].find((each) => !each.reportValidity());
    return wrong !== undefined;
  }

  said(automatic: boolean): { heights: Heights; title: string; language: string } {
    const shapes = Object.fromEntries([...this.shapes].map(([name, each]) => [name, Math.round(1e5 * (each.valueAsNumber || 0) / MM) / 1e5]));
    const by = automatic ? this.opened.heights.by : "given";
    return { heights: { ...this.opened.heights, ...shapes, by }, title: this.title.value.trim(), language: this.language.value.trim() || "en" };
  }
}

export function folded(title: string, inside: HTMLElement[]): HTMLElement {
  const box = document.createElement("details");
  const heading = document.createElement("summary");
  heading.textContent = title;
  box.append(heading, ...inside);
  return box;
}
