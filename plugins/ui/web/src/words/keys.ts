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
});
