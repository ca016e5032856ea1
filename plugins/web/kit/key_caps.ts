/** Keys as elements. */
import { t } from "./words/key_words";

/** Return the element of a key as it is printed on a keyboard; key: as in shortcuts.ts. */
export function caps(key: string): HTMLElement {
  const element = document.createElement("kbd");
  element.textContent = key
    .split(/(?<=.)\+/)
    .map((part) => (part in NAMES ? t(NAMES[part]) : part.length === 1 ? part.toUpperCase() : part))
    .join(" + ");
  return element;
}

const NAMES: Record<string, Parameters<typeof t>[0]> = {
  " ": "Space",
  Escape: "Escape",
  Shift: "Shift",
  Ctrl: "Ctrl",
  Alt: "Alt",
  ArrowLeft: "ArrowLeft",
  ArrowRight: "ArrowRight",
  ArrowUp: "ArrowUp",
  ArrowDown: "ArrowDown",
  PageUp: "PageUp",
  PageDown: "PageDown",
  Enter: "Enter",
  Home: "Home",
  End: "End",
};
