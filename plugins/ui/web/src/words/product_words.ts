import { words } from "kit/words/words";

const t = words({
  views: ["Pictures", "Bilder", "Images"],
  disparity: ["Disparity", "Disparität", "Disparité"],
  figure: ["What networks see", "Was Netze sehen", "Ce que voient les réseaux"],
  relief: ["Relief", "Relief", "Relief"],
  segments: ["Segments", "Segmente", "Segments"],
  parts: ["Parts", "Teile", "Parties"],
  simplified: ["Legible parts", "Lesbare Teile", "Parties lisibles"],
  materials: ["Materials", "Materialien", "Matières"],
  surface: ["Surface", "Oberfläche", "Surface"],
  touch: ["Force law", "Kraftgesetz", "Loi de force"],
  export: ["Export", "Export", "Export"],
  exportAs: ["Export as {name}", "Export als {name}", "Export en {name}"],
});

/** The program's prefix of exported products. */
const EXPORT = "export: ";

/** Return a product's name; an unknown one keeps the name of the pipeline file. */
export function productName(product: string): string {
  if (product.startsWith(EXPORT)) return t("exportAs", { name: product.slice(EXPORT.length) });
  return t.has(product) ? t(product) : product;
}
