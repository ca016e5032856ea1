import { words } from "./words";

/** What each shortcut does, by its name in shortcuts.ts. */
export const t = words({
  stop: ["Stop: no force", "Stopp: keine Kraft"],
  "next region": ["Go to the next part of the page", "Zum nächsten Bereich der Seite"],
  "previous region": ["Go to the part before", "Zum vorigen Bereich der Seite"],
  help: ["Show all keys", "Alle Tasten zeigen"],
  "move hand": ["Move the hand by a millimetre; held down, 40 mm a second",
    "Die Hand um einen Millimeter bewegen; gedrückt gehalten 40 mm in der Sekunde"],
  "move finely": ["Move it by 0.2 mm; held down, 8 mm a second", "Um 0,2 mm; gedrückt gehalten 8 mm in der Sekunde"],
  "move coarsely": ["Move it by 5 mm; held down, 160 mm a second",
    "Um 5 mm; gedrückt gehalten 160 mm in der Sekunde"],
  "to the middle": ["Lift the hand and bring it to the middle", "Die Hand heben und in die Mitte bringen"],
  "next part": ["Lift the hand and bring it over the next part", "Die Hand heben und über den nächsten Teil bringen"],
  "previous part": ["The part before", "Der Teil davor"],
  "in space": ["Move the hand freely in space, or over the surface again",
    "Die Hand frei im Raum bewegen oder wieder über der Oberfläche"],
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
});
