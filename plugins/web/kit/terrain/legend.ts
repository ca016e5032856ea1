/** Legends of colours and patterns. */
import type { Scene } from "../surface/scene";
import { materialWord } from "../words/material_words";
import { shownNumber } from "../words/part_words";
import { notation } from "../words/words";
import { t } from "../view/words";
import { darken, heat, isMarked, styleOf, type Colour } from "./colours";

const SWATCH_PX = 22;
const PERIOD_PX = 11;
const BAR_PX = 220;
/** Materials and segments listed; of more, the number is shown. */
const MOST = 24;

/** Return the legend of a look; null if it needs none. */
export function legend(scene: Scene, look: string): HTMLElement | null {
  const { meta } = scene;
  if (look === "height") return scale(meta.height_m[0] * 1000, meta.height_m[1] * 1000, "mm", false);
  if (look === "slope") return scale(0, 90, "°", false);
  if (look === "materials") return kinds(meta.materials.map(({ name }) => name));
  if (look === "segments") return kinds(Array.from({ length: meta.labels }, (_, label) => partName(scene, label)));
  const layer = meta.layers[look];
  return layer ? scale(layer.low, layer.high, layer.unit, true) : null;
}

function partName(scene: Scene, label: number): string {
  const material = scene.meta.materials[scene.kinds[label]];
  const number = shownNumber(label);
  return material ? t("partOf", { number, material: materialWord(material.name) }) : t("part", { number });
}

function scale(low: number, high: number, unit: string, unknowns: boolean): HTMLElement {
  const box = document.createElement("figure");
  box.className = "legend";
  const bar = picture(BAR_PX, 14, (x) => heat(x / (BAR_PX - 1)));
  bar.setAttribute("role", "img");
  const [from, to] = [low, high].map((value) => `${number(value, high - low)} ${unit}`.trim());
  bar.setAttribute("aria-label", t("scale", { from, to }));
  const ends = document.createElement("p");
  ends.className = "ends";
  ends.ariaHidden = "true";
  for (const text of [from, to]) {
    const end = document.createElement("span");
    end.textContent = text;
    ends.append(end);
  }
  box.append(bar, ends);
  if (unknowns) box.append(swatchItem((x, y) => ((x + y) / PERIOD_PX) % 1 > 0.5 ? [80, 80, 80] : [115, 115, 115], t("unknown"), "p"));
  return box;
}

/** Return a number of a scale with enough digits for its span. */
export function number(value: number, span: number): string {
  const digits = Math.min(Math.max(2 - Math.floor(Math.log10(Math.max(Math.abs(span), 1e-9))), 0), 6);
  return notation(value.toFixed(digits).replace(/(\.\d*?)0+$/, "$1").replace(/\.$/, ""));
}

function kinds(names: string[]): HTMLElement {
  const list = document.createElement("ul");
  list.className = "legend";
  names.slice(0, MOST).forEach((name, kind) => {
    const { colour, pattern } = styleOf(kind);
    const at = (x: number, y: number): Colour => (isMarked(pattern, x / PERIOD_PX, -y / PERIOD_PX) ? darken(colour) : colour);
    list.append(swatchItem(at, name, "li"));
  });
  if (names.length > MOST) {
    const more = document.createElement("li");
    more.textContent = t("more", { count: names.length - MOST });
    list.append(more);
  }
  return list;
}

function swatchItem(colour: (x: number, y: number) => Colour, text: string, tag: "li" | "p"): HTMLElement {
  const item = document.createElement(tag);
  const swatch = picture(SWATCH_PX, SWATCH_PX, colour);
  swatch.ariaHidden = "true";
  item.append(swatch, text);
  return item;
}

function picture(width: number, height: number, colour: (x: number, y: number) => Colour): HTMLCanvasElement {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [width, height];
  const data = new ImageData(width, height);
  for (let y = 0, k = 0; y < height; y++) for (let x = 0; x < width; x++, k += 4) data.data.set([...colour(x, y), 255], k);
  canvas.getContext("2d")!.putImageData(data, 0, 0);
  return canvas;
}
