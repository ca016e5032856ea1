import { words } from "../../words/words";

export const t = words({
  title: ["Settings", "Einstellungen"],
  colours: ["Colours", "Farben"],
  system: ["as the system has them", "wie im System"],
  light: ["light", "hell"],
  dark: ["dark", "dunkel"],
  "contrast-light": ["high contrast, light", "hoher Kontrast, hell"],
  "contrast-dark": ["high contrast, dark", "hoher Kontrast, dunkel"],
  language: ["Language", "Sprache"],
  sizes: ["Columns and log", "Spalten und Protokoll"],
  wider: ["Larger", "Größer"],
  narrower: ["Smaller", "Kleiner"],
  reset: ["As at first", "Wie zu Anfang"],
  read: ["A screen reader reads every new line of the log", "Ein Screenreader liest jede neue Zeile des Protokolls vor"],
  letters: ["Letters are keys everywhere", "Buchstaben sind überall Tasten"],
  lettersHint: ["Off: letters such as W or S act on the surface alone, so that speech input does not set them off.",
    "Aus: Buchstaben wie W oder S wirken nur auf der Oberfläche, damit eine Spracheingabe sie nicht auslöst."],
});
