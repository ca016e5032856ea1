import { words } from "./words";

/** What each shortcut does, by its name in shortcuts.ts. */
export const t = words({
  stop: ["Stop: no force", "Stopp: keine Kraft"],
  "next region": ["Go to the next part of the page", "Zum nächsten Bereich der Seite"],
  "previous region": ["Go to the part before", "Zum vorigen Bereich der Seite"],
  help: ["Show all keys", "Alle Tasten zeigen"],
  "move hand": ["Move the hand by a millimetre", "Die Hand um einen Millimeter bewegen"],
  "press or lift": ["Press into the surface, or lift the hand", "Auf die Oberfläche drücken oder die Hand heben"],
  deeper: ["Press deeper", "Tiefer drücken"],
  "less deep": ["Press less deep", "Weniger tief drücken"],
  where: ["Where am I? Says place, height, material and force",
    "Wo bin ich? Sagt Ort, Höhe, Material und Kraft"],
  describe: ["Describe the surface", "Die Oberfläche beschreiben"],
  sound: ["Sound on or off", "Ton ein oder aus"],
  aloud: ["Speech on or off", "Sprachausgabe ein oder aus"],
  "hear heights": ["Hear the heights from left to right, in the row under the hand",
    "Die Höhen von links nach rechts hören, in der Zeile unter der Hand"],
  "measure here": ["Set the next end of the ruler at the hand", "Das nächste Ende des Lineals bei der Hand setzen"],
  "remove ruler": ["Remove the ruler", "Das Lineal entfernen"],
  mark: ["Mark the place under the hand", "Die Stelle unter der Hand markieren"],
  enlarge: ["Feel half as much about the hand, enlarged", "Um die Hand herum halb so viel fühlen, vergrößert"],
  "whole picture": ["Feel the whole picture", "Das ganze Bild fühlen"],
  "copy values": ["Copy the values of the data cursor as text", "Die Messwerte am Cursor als Text kopieren"],
  "copy values as JSON": ["Copy the values of the data cursor as JSON", "Die Messwerte am Cursor als JSON kopieren"],
});
