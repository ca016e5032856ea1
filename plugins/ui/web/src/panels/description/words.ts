import { words } from "../../words/words";

/** The description of what is felt. */
export const t = words({
  about: ["What there is to feel, in words: to be read before it is felt, or instead. “Export” writes it into files.",
    "Was zu fühlen ist, in Worten: um es vorher zu lesen oder stattdessen. „Weitergeben“ schreibt den Text in Dateien."],
  language: ["Language", "Sprache"],
  en: ["English", "Englisch"],
  de: ["German", "Deutsch"],
  fr: ["French", "Französisch"],
  text: ["Description", "Beschreibung"],
  waiting: ["The description comes as soon as something is made.", "Die Beschreibung erscheint, sobald etwas berechnet ist."],
  read: ["Read aloud", "Vorlesen"],
  quiet: ["Stop reading", "Nicht weiterlesen"],
  noVoice: ["The browser has no voice for this language. A screen reader reads the text above.",
    "Der Browser hat keine Stimme für diese Sprache. Ein Screenreader liest den Text oben."],
  copy: ["Copy", "Kopieren"],
  copied: ["The description is in the clipboard.", "Die Beschreibung ist in der Zwischenablage."],
  asText: ["Save as text", "Als Text sichern"],
  asHtml: ["Save as HTML", "Als HTML sichern"],
  fresh: ["The description is another one now.", "Die Beschreibung ist jetzt eine andere."],
  failed: ["There is no description: {why}", "Es gibt keine Beschreibung: {why}"],
});
