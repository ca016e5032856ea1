import { words } from "./words";

const t = words({
  views: ["Pictures", "Bilder"],
  disparity: ["Disparity", "Disparität"],
  relief: ["Relief", "Relief"],
  segments: ["Segments", "Segmente"],
  parts: ["Parts", "Teile"],
  simplified: ["Legible parts", "Lesbare Teile"],
  materials: ["Materials", "Materialien"],
  surface: ["Surface", "Oberfläche"],
  touch: ["Force law", "Kraftgesetz"],
  export: ["Export as {name}", "Ausgabe als {name}"],
});

/** How the program names what an exporter writes. */
const EXPORT = "export: ";

/** A product's name for people; one that is not known keeps the name that it has in the pipeline file. */
export function made(product: string): string {
  if (product.startsWith(EXPORT)) return t("export", { name: product.slice(EXPORT.length) });
  return t.has(product) ? t(product) : product;
}
