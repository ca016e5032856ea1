/** Table of all keys of the page: the help panel shows it, a test looks for conflicts.
 *
 * To add one: a line in SHORTCUTS, its text in panels/help/shortcut_words.ts under the same name, and `on("its name",
 * () => ...)` where it acts. Keys that a part handles itself, like the hand's arrows, have a line too, with `own`, so
 * that they are shown and collide with none; that part does not call `on`.
 *
 * `where`: "page", wherever the focus is (function keys and such alone, or with Ctrl or Alt); "surface", while the
 * surface has the focus; "letter", wherever no text is typed: a person can switch these off (settings panel), and then
 * they act on the surface alone, because speech input types letters. */
import { recall, remember } from "./preferences";

interface Shortcut {
  /** Keys as in KeyboardEvent.key, letters in lower case, with Shift+, Ctrl+, Alt+ before. Signs are written without Shift. */
  keys: string[];
  where: "page" | "surface" | "letter";
  /** True if a part handles the key itself. */
  own?: true;
}

export const SHORTCUTS = {
  stop: { keys: ["Escape"], where: "page" },
  "next region": { keys: ["F6"], where: "page" },
  "previous region": { keys: ["Shift+F6"], where: "page" },
  help: { keys: ["?", "F1"], where: "letter" },
  palette: { keys: ["Ctrl+k", "Meta+k"], where: "page" },
  "move hand": { keys: ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown"], where: "surface", own: true },
  "move finely": {
    keys: ["Shift+ArrowLeft", "Shift+ArrowRight", "Shift+ArrowUp", "Shift+ArrowDown"], where: "surface", own: true,
  },
  "move coarsely": {
    keys: ["Ctrl+ArrowLeft", "Ctrl+ArrowRight", "Ctrl+ArrowUp", "Ctrl+ArrowDown"], where: "surface", own: true,
  },
  "to the middle": { keys: ["Home"], where: "surface", own: true },
  "next part": { keys: ["n"], where: "surface", own: true },
  "previous part": { keys: ["Shift+n"], where: "surface", own: true },
  "in space": { keys: ["f"], where: "surface", own: true },
  "press or lift": { keys: [" "], where: "surface", own: true },
  deeper: { keys: ["PageDown"], where: "surface", own: true },
  "less deep": { keys: ["PageUp"], where: "surface", own: true },
  "turn view": {
    keys: ["Ctrl+Shift+ArrowLeft", "Ctrl+Shift+ArrowRight", "Ctrl+Shift+ArrowUp", "Ctrl+Shift+ArrowDown"],
    where: "surface", own: true,
  },
  "shift view": {
    keys: ["Alt+ArrowLeft", "Alt+ArrowRight", "Alt+ArrowUp", "Alt+ArrowDown"], where: "surface", own: true,
  },
  nearer: { keys: ["+"], where: "surface", own: true },
  farther: { keys: ["-"], where: "surface", own: true },
  "view at first": { keys: ["Ctrl+Home"], where: "surface", own: true },
  "view from above": { keys: ["Ctrl+End"], where: "surface", own: true },
  where: { keys: ["w"], where: "letter" },
  describe: { keys: ["d"], where: "letter" },
  "describe moves": { keys: ["Shift+d"], where: "letter" },
  tour: { keys: ["g"], where: "letter" },
  sound: { keys: ["s"], where: "letter" },
  aloud: { keys: ["a"], where: "letter" },
  "hear heights": { keys: ["h"], where: "letter" },
  "measure here": { keys: ["m"], where: "letter" },
  "remove ruler": { keys: ["Shift+m"], where: "letter" },
  mark: { keys: ["k"], where: "letter" },
  enlarge: { keys: ["z"], where: "letter" },
  "whole picture": { keys: ["Shift+z"], where: "letter" },
  "copy values": { keys: ["c"], where: "letter" },
  "copy values as JSON": { keys: ["Shift+c"], where: "letter" },
} as const satisfies Record<string, Shortcut>;

export type Name = keyof typeof SHORTCUTS;

const KEPT = "letters";
const actions = new Map<Name, () => void>();
const byKey = new Map<string, Name>();
for (const [name, { keys }] of Object.entries<Shortcut>(SHORTCUTS)) for (const key of keys) byKey.set(key, name as Name);

/** The setting that single letters act wherever the focus is. */
export const letters = {
  get everywhere(): boolean {
    return recall(KEPT, true);
  },
  set everywhere(on: boolean) {
    remember(KEPT, on);
  },
};

/** Set the action of a shortcut. */
export function on(name: Name, act: () => void): void {
  actions.set(name, act);
}

/** Do what a shortcut does; one that a part handles itself is pressed on the surface, which gets the focus. */
export function run(name: Name, surface: HTMLElement): void {
  const { keys, own }: Shortcut = SHORTCUTS[name];
  if (!own) return actions.get(name)?.();
  const parts = keys[0]!.split(/(?<=.)\+/);
  const held = (key: string): boolean => parts.slice(0, -1).includes(key);
  const about = { key: parts.at(-1)!, ctrlKey: held("Ctrl"), shiftKey: held("Shift"), altKey: held("Alt"), bubbles: true, cancelable: true };
  surface.focus();
  for (const type of ["keydown", "keyup"]) surface.dispatchEvent(new KeyboardEvent(type, about));
}

/** Listen to the keys of the page; call once. The stop key acts before any part can take it, and stays available to them;
 * a list that it closes has `data-own-escape`. */
export function listen(surface: HTMLElement): void {
  document.addEventListener("keydown", (event) => {
    if (shortcutOf(event) === "stop" && !(event.target as Element).closest?.("[data-own-escape]")) actions.get("stop")?.();
  }, { capture: true });
  document.addEventListener("keydown", (event) => {
    const name = shortcutOf(event);
    const act = name && actions.get(name);
    if (!act || name === "stop" || event.isComposing || event.defaultPrevented) return;
    if (!actsAt(SHORTCUTS[name].where, event.target as Element, surface)) return;
    event.preventDefault();
    if (!event.repeat) act();
  });
}

function shortcutOf(event: KeyboardEvent): Name | undefined {
  return byKey.get(keyName(event));
}

/** Return a key with its modifiers as the table writes it. */
export function keyName({ key, shiftKey, ctrlKey, altKey, metaKey }: KeyboardEvent): string {
  const named = key.length > 1;
  const small = key.toLowerCase();
  const letter = small !== key.toUpperCase();
  const held = [ctrlKey && "Ctrl+", altKey && "Alt+", metaKey && "Meta+", shiftKey && (named || letter) && "Shift+"];
  return held.filter(Boolean).join("") + (named ? key : small);
}

/** Elements in which letters type or choose. */
const TYPED = "input:not([type=checkbox], [type=radio], [type=range], [type=file]), select, textarea, [contenteditable]";

function actsAt(where: Shortcut["where"], target: Element, surface: HTMLElement): boolean {
  if (where === "page" || target === surface) return true;
  return where === "letter" && letters.everywhere && !target.matches(TYPED);
}
