import { words } from "../../words/words";

/** What was found about the picture. */
export const t = words({
  title: ["What was found", "Was gefunden wurde"],
  none: ["Open a picture; what was found about it is listed here.",
    "Öffnen Sie ein Bild; hier steht dann, was darüber gefunden wurde."],
  readAs: ["Picture", "Bild"],
  is_photograph: ["one photograph", "ein Foto"],
  is_depth: ["a pair, or with depth", "ein Paar oder mit Tiefe"],
  is_heights: ["a map of heights", "eine Höhenkarte"],
  heights: ["Heights", "Höhen"],
  reliefFrom: ["Relief from", "Relief aus"],
  from_photograph: ["brightness", "Helligkeit"],
  from_edges: ["edges", "Kanten"],
  from_depth: ["depth", "Tiefe"],
  from_heights: ["measured heights", "gemessenen Höhen"],
  from_parts: ["heights of its parts", "Höhen seiner Teile"],
  size: ["Size", "Größe"],
  sizeMm: ["{width} × {length} mm", "{width} × {length} mm"],
  heightsMm: ["{low} to {high} mm", "{low} bis {high} mm"],
  parts: ["Parts", "Teile"],
  segments: ["Segments", "Segmente"],
});
