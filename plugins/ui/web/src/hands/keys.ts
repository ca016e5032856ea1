/** The keyboard: arrows move the hand, space puts it down, the page keys press. */
import type { Hand } from "../hand";

const STEP_M = 0.001;
const PRESS_STEP_M = 0.0002;
const WAYS: Record<string, [number, number]> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, 1],
  ArrowDown: [0, -1],
};

export function keys(hand: Hand): void {
  hand.page.canvas.addEventListener("keydown", (event) => {
    if (!act(hand, event.key)) return;
    event.preventDefault();
  });
}

/** Whether the key is one of the hand's. */
function act(hand: Hand, key: string): boolean {
  const scene = hand.page.scene;
  if (!scene) return false;
  const at = hand.at ?? scene.on(0, 0);
  const way = WAYS[key];
  if (way) hand.move(scene.on(at[0] + way[0] * STEP_M, at[1] + way[1] * STEP_M), hand.down);
  else if (key === " ") hand.move(at, !hand.down);
  else if (key === "PageDown") hand.press(PRESS_STEP_M);
  else if (key === "PageUp") hand.press(-PRESS_STEP_M);
  else return false;
  return true;
}
