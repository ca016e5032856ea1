import { words } from "./words";

/** The description of what is felt. */
export const t = words({
  about: ["What is felt, in words: for who reads it before, and for who does not feel it. The same text goes into an export as “text”.",
    "Was zu fühlen ist, in Worten: für alle, die es vorher lesen oder nicht fühlen. Derselbe Text kommt in eine Ausgabe als „text“."],
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
  asText: ["Download as text", "Als Text herunterladen"],
  asHtml: ["Download as HTML", "Als HTML herunterladen"],
  fresh: ["The description is another one now.", "Die Beschreibung ist jetzt eine andere."],
  failed: ["There is no description: {why}", "Es gibt keine Beschreibung: {why}"],
});
