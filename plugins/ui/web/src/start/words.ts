import { words } from "../words/words";

/** The start without a file, and the line that says how to feel. */
export const t = words({
  title: ["What do you want to feel?", "Was möchten Sie fühlen?"],
  picture: ["A picture of mine", "Ein eigenes Bild"],
  pictureSays: ["A photograph, the left and right picture of a pair, or a height map. You can also drop it here.",
    "Ein Foto, linkes und rechtes Bild eines Paares oder eine Höhenkarte. Sie können es auch hier ablegen."],
  choose: ["Choose a picture", "Bild wählen"],
  example: ["An example", "Ein Beispiel"],
  exampleSays: ["Pictures that come with the program.", "Bilder, die das Programm mitbringt."],
  file: ["A pipeline file", "Eine Pipeline-Datei"],
  fileSays: ["One that was saved on this computer before.", "Eine, die auf diesem Computer gespeichert wurde."],
  folder: ["Choose from a folder", "Aus einem Ordner wählen"],
  feelByMouse: ["Move the mouse over the surface and hold its button down to feel it; or use the arrow keys and Space.",
    "Bewegen Sie die Maus über die Oberfläche, und halten Sie die Taste gedrückt, um zu fühlen; oder nehmen Sie Pfeiltasten und Leertaste."],
  feelByFinger: ["Put a finger on the surface to feel it.", "Legen Sie einen Finger auf die Oberfläche, um zu fühlen."],
});
