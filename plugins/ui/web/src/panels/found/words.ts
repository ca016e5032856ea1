import { words } from "kit/words/words";

/** Details of the picture. */
export const t = words({
  title: ["Picture details", "Angaben zum Bild", "Détails de l'image"],
  none: ["Open a picture; its details are listed here.",
    "Öffnen Sie ein Bild; hier stehen dann die Angaben dazu.",
    "Ouvrez une image ; ses détails sont indiqués ici."],
  readAs: ["Picture", "Bild", "Image"],
  is_photograph: ["one photograph", "ein Foto", "une photographie"],
  is_depth: ["a pair, or with depth", "ein Paar oder mit Tiefe", "une paire, ou avec profondeur"],
  is_heights: ["a map of heights", "eine Höhenkarte", "une carte de hauteurs"],
  heights: ["Heights", "Höhen", "Hauteurs"],
  reliefFrom: ["Relief from", "Relief aus", "Relief d'après"],
  from_photograph: ["brightness", "Helligkeit", "la luminosité"],
  from_edges: ["edges", "Kanten", "les contours"],
  from_figure: ["what networks see", "dem, was Netze sehen", "ce que voient les réseaux"],
  from_lines: ["the drawing's lines", "den Linien der Zeichnung", "les lignes du dessin"],
  from_depth: ["depth", "Tiefe", "la profondeur"],
  from_heights: ["measured heights", "gemessenen Höhen", "des hauteurs mesurées"],
  from_parts: ["heights of its parts", "Höhen seiner Teile", "les hauteurs de ses parties"],
  size: ["Size", "Größe", "Taille"],
  sizeMm: ["{width} × {length} mm", "{width} × {length} mm", "{width} × {length} mm"],
  heightsMm: ["{low} to {high} mm", "{low} bis {high} mm", "{low} à {high} mm"],
  parts: ["Parts", "Teile", "Parties"],
  segments: ["Segments", "Segmente", "Segments"],
});
