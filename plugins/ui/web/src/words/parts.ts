import { words } from "./words";

/** Parts: what the panel says; what their editor says stands in words/drawing.ts, which comes when it is opened. */
export const t = words({
  title: ["Parts", "Teile"],
  about: ["Draw the parts of the picture, name them, and give each a height: what stands in front is higher.",
    "Zeichnen Sie die Teile des Bildes, benennen Sie sie und geben Sie jedem eine Höhe: Was vorn steht, ist höher."],
  edit: ["Edit the parts", "Teile bearbeiten"],
  opening: ["The parts are being opened.", "Die Teile werden geöffnet."],
  failed: ["The parts could not be opened: {why}", "Die Teile konnten nicht geöffnet werden: {why}"],
});
