/** Keys of the parts editor, written as in shortcuts.ts; none is also a letter of the whole page. */
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

/** Direction of each arrow key in the picture, right and down. */
const DIRECTIONS: Record<string, readonly [number, number]> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, -1],
  ArrowDown: [0, 1],
};

/** Action of a key. Moves of the crosshair: a pixel of the picture, a step, or far. */
export type Action =
  | { do: "escape" | "undo" | "redo" | "save" | "new part" | "list" | "narrower" | "wider" | "where" | "keys" }
  | { do: "pen" | "finish" | "nearer" | "farther" | "fit" | "nothing" }
  | { do: "use"; tool: Tool }
  | { do: "move"; x: number; y: number; pace: "pixel" | "step" | "far" };

/** Context of a key: in a text field, on the picture; whether letters act everywhere. */
export interface Context {
  typing: boolean;
  onPicture: boolean;
  letters: boolean;
}

const EVERYWHERE: Record<string, Action> = {
  Escape: { do: "escape" },
  "Ctrl+z": { do: "undo" },
  "Ctrl+Shift+z": { do: "redo" },
  "Ctrl+y": { do: "redo" },
  "Ctrl+s": { do: "save" },
};
const LETTERS: Record<string, Action> = {
  ...Object.fromEntries(Object.entries(TOOL_KEYS).map(([tool, key]) => [key, { do: "use", tool: tool as Tool }])),
  t: { do: "new part" },
  o: { do: "list" },
  "[": { do: "narrower" },
  "]": { do: "wider" },
  i: { do: "where" },
  "?": { do: "keys" },
  F1: { do: "keys" },
};
const ON_PICTURE: Record<string, Action> = {
  Enter: { do: "finish" },
  "+": { do: "nearer" },
  "-": { do: "farther" },
  "0": { do: "fit" },
};

/** Return what a key does; undefined if it is not the editor's. pressed: as shortcuts.ts names it. */
export function actionOf(pressed: string, event: Pick<KeyboardEvent, "key" | "shiftKey" | "ctrlKey" | "altKey" | "repeat">, where: Context): Action | undefined {
  const { typing, onPicture, letters } = where;
  if (typing && EVERYWHERE[pressed] && pressed.toLowerCase().endsWith("+z")) return undefined; // a field undoes its own letters
  if (EVERYWHERE[pressed]) return EVERYWHERE[pressed];
  if (!typing && (letters || onPicture) && LETTERS[pressed]) return LETTERS[pressed];
  return onPicture ? pictureAction(event) : undefined;
}

function pictureAction({ key, shiftKey, ctrlKey, altKey, repeat }: Pick<KeyboardEvent, "key" | "shiftKey" | "ctrlKey" | "altKey" | "repeat">): Action | undefined {
  const direction = DIRECTIONS[key];
  if (direction && !altKey) return { do: "move", x: direction[0], y: direction[1], pace: shiftKey ? "pixel" : ctrlKey ? "far" : "step" };
  if (key === " ") return { do: repeat ? "nothing" : "pen" };
  return ON_PICTURE[key];
}
