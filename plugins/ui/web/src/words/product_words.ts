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
  export: ["Export as {name}", "Export als {name}"],
});

/** The program's prefix of exported products. */
const EXPORT = "export: ";

/** Return a product's name; an unknown one keeps the name of the pipeline file. */
export function productName(product: string): string {
  if (product.startsWith(EXPORT)) return t("export", { name: product.slice(EXPORT.length) });
  return t.has(product) ? t(product) : product;
}
