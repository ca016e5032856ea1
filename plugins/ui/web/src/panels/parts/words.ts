import { words } from "../../words/words";

/** Parts: what the panel says; what their editor says stands in editor/words.ts, which comes when it is opened. */
export const t = words({
  title: ["Parts", "Teile"],
  about: ["Draw the parts of the picture, name them, and give each a height: what stands in front is higher.",
    "Zeichnen Sie die Teile des Bildes, benennen Sie sie und geben Sie jedem eine Höhe: Was vorn steht, ist höher."],
  edit: ["Edit the parts", "Teile bearbeiten"],
  opening: ["The parts are being opened.", "Die Teile werden geöffnet."],
  named: ["Named parts", "Benannte Teile"],
  guideHint: ["The device pulls gently towards the part, until you press again, press Escape or a button of the device.",
    "Das Gerät zieht sanft zu dem Teil hin, bis Sie noch einmal, Escape oder eine Taste des Geräts drücken."],
  noDevice: ["A device with a motor can guide the hand to each of these parts: choose one under “Devices”.",
    "Ein Gerät mit Motor kann die Hand zu jedem dieser Teile führen: Wählen Sie eines unter „Geräte“."],
  guide: ["Guide me there", "Hinführen"],
  guideTo: ["{name}: guide me there", "{name}: hinführen"],
  release: ["Let me go", "Loslassen"],
  releaseFrom: ["{name}: let me go", "{name}: loslassen"],
  guiding: ["You are guided to: {name}.", "Sie werden geführt zu: {name}."],
  guideEnded: ["You are not guided any more.", "Sie werden nicht mehr geführt."],
  letGo: ["A button of the device let you go.", "Eine Taste des Geräts hat Sie losgelassen."],
  failed: ["The parts could not be opened: {why}", "Die Teile konnten nicht geöffnet werden: {why}"],
});
