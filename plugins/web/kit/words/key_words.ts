import { words } from "./words";

/** Keys as they are printed on keyboards. */
export const t = words({
  Space: ["Space", "Leertaste", "Espace"],
  Escape: ["Esc", "Esc", "Échap"],
  Shift: ["Shift", "Umschalt", "Maj"],
  Ctrl: ["Ctrl", "Strg", "Ctrl"],
  Alt: ["Alt", "Alt", "Alt"],
  ArrowLeft: ["Left", "Links", "Gauche"],
  ArrowRight: ["Right", "Rechts", "Droite"],
  ArrowUp: ["Up", "Hoch", "Haut"],
  ArrowDown: ["Down", "Runter", "Bas"],
  PageUp: ["Page up", "Bild hoch", "Page haut"],
  PageDown: ["Page down", "Bild runter", "Page bas"],
  Enter: ["Enter", "Eingabe", "Entrée"],
  Home: ["Home", "Pos 1", "Début"],
  End: ["End", "Ende", "Fin"],
});
