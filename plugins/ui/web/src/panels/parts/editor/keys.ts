/** The editor's own keys, written as shortcuts.ts writes them; none is one that letters have on the whole page. */
import type { Tool } from "../controls/tools";

export const TOOL_KEYS: Record<Tool, string> = { select: "v", brush: "b", lasso: "l", propose: "p", split: "x", join: "j" };

export const KEYS = {
  keyTools: Object.values(TOOL_KEYS),
  keyFresh: ["t"],
  keyWidth: ["[", "]"],
  keyUndo: ["Ctrl+z", "Ctrl+Shift+z"],
  keySave: ["Ctrl+s"],
  keyWhere: ["i"],
  keyList: ["o"],
  keyPen: [" ", "Enter"],
  keyMove: ["ArrowLeft", "Shift+ArrowLeft", "Ctrl+ArrowLeft"],
  keyZoom: ["+", "-", "0"],
  keyWalk: ["ArrowDown", "ArrowUp"],
  keyHeight: ["ArrowLeft", "ArrowRight"],
  keyOrder: ["Alt+ArrowUp", "Alt+ArrowDown"],
  keyName: ["Enter"],
  keyEscape: ["Escape"],
} as const;

/** Where an arrow key goes. */
export const WAYS: Record<string, readonly [number, number]> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, -1],
  ArrowDown: [0, 1],
};
