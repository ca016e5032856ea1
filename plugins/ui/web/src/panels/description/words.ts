import { words } from "../../words/words";

/** Texts of the description panel. */
export const t = words({
  about: ["The surface in words, to read before touching it or instead. “Export” writes the text into files.",
    "Was zu fühlen ist, in Worten: um es vorher zu lesen oder stattdessen. „Exportieren“ schreibt den Text in Dateien."],
  language: ["Language", "Sprache"],
  en: ["English", "Englisch"],
  de: ["German", "Deutsch"],
  fr: ["French", "Französisch"],
  text: ["Description", "Beschreibung"],
  waiting: ["The description appears as soon as a surface is computed.", "Die Beschreibung erscheint, sobald etwas berechnet ist."],
  read: ["Read aloud", "Vorlesen"],
  quiet: ["Stop reading", "Nicht weiterlesen"],
  noVoice: ["The browser has no voice for this language. A screen reader reads the text above.",
    "Der Browser hat keine Stimme für diese Sprache. Ein Screenreader liest den Text oben."],
  copy: ["Copy", "Kopieren"],
  copied: ["The description is in the clipboard.", "Die Beschreibung ist in der Zwischenablage."],
  asText: ["Save as text", "Als Text sichern"],
  asHtml: ["Save as HTML", "Als HTML sichern"],
  fresh: ["The description has changed.", "Die Beschreibung ist jetzt eine andere."],
  failed: ["There is no description: {why}", "Es gibt keine Beschreibung: {why}"],
});
