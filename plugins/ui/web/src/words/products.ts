import { words } from "./words";

const t = words({
  views: ["Pictures", "Bilder"],
  disparity: ["Disparity", "Disparität"],
  relief: ["Relief", "Relief"],
  segments: ["Segments", "Segmente"],
  parts: ["Parts", "Teile"],
  materials: ["Materials", "Materialien"],
  surface: ["Surface", "Oberfläche"],
  touch: ["Force law", "Kraftgesetz"],
});

/** A product's name for people; one that is not known keeps the name that it has in the pipeline file. */
export function made(product: string): string {
  return t.has(product) ? t(product) : product;
}
