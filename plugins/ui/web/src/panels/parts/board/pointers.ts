/** Mouse, fingers and pens on the board: one uses the tool, the wheel, the other buttons and two fingers move the picture. */
import type { Board } from "./board";
import type { Point } from "../pixels/labels";
import type { Pens } from "../controls/tools";

const NOTCH = 0.0015;
const LINE = 16;
/** A click that moves no farther than this is one. */
const STILL_PX = 5;

export interface Hears {
  moved: (at: Point, event: PointerEvent) => void;
  lifted: () => void;
}

export function pointers(board: Board, pens: Pens, hears: Hears): void {
  const { canvas } = board;
  const fingers = new Map<number, PointerEvent>();
  /** Where the picture is held; null while a tool is used. */
  let held: { x: number; y: number; far: number } | null = null;
  let first: PointerEvent | null = null;

  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    canvas.focus({ preventScroll: true });
    fingers.set(event.pointerId, event);
    first = event;
    if (fingers.size > 1 || event.button > 0) {
      pens.cancel();
      held = middle(fingers);
    } else pens.put(board.at(event));
    hears.moved(board.at(event), event);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (fingers.has(event.pointerId)) fingers.set(event.pointerId, event);
    if (!held && pens.down && pens.tool === "select" && first && away(first, event) > STILL_PX) {
      pens.cancel(); // the picture is dragged and not clicked
      held = middle(fingers);
    }
    if (held) drag(middle(fingers));
    else if (pens.down) for (const each of all(event)) pens.move(board.at(each));
    hears.moved(board.at(event), event);
  });
  canvas.addEventListener("pointerup", (event) => {
    fingers.delete(event.pointerId);
    if (held) held = fingers.size ? middle(fingers) : null;
    else void pens.lift().then(hears.lifted);
    hears.lifted();
  });
  canvas.addEventListener("pointercancel", (event) => {
    fingers.delete(event.pointerId);
    held = fingers.size ? middle(fingers) : null;
    pens.cancel();
    hears.lifted();
  });
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    const by = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? LINE * event.deltaY : event.deltaY;
    board.sight.nearer(Math.exp(-NOTCH * by), board.onBoard(event.clientX, event.clientY));
    board.look();
  }, { passive: false });

  function drag(now: { x: number; y: number; far: number }): void {
    const [x, y] = board.onBoard(now.x, now.y);
    const [x0, y0] = board.onBoard(held!.x, held!.y);
    board.sight.pan(x - x0, y - y0);
    if (held!.far && now.far) board.sight.nearer(now.far / held!.far, [x, y]);
    held = now;
    board.look();
  }
}

/** Between the fingers, and how far they are from one another. */
function middle(fingers: Map<number, PointerEvent>): { x: number; y: number; far: number } {
  const all = [...fingers.values()];
  const mean = (of: (each: PointerEvent) => number): number => all.reduce((sum, each) => sum + of(each), 0) / all.length;
  return { x: mean((each) => each.clientX), y: mean((each) => each.clientY), far: all[1] ? away(all[0]!, all[1]) : 0 };
}

const away = (a: PointerEvent, b: PointerEvent): number => Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);

/** All places since the last event, which a screen drawn 60 times a second passes over. */
function all(event: PointerEvent): PointerEvent[] {
  const found = event.getCoalescedEvents?.() ?? [];
  return found.length ? found : [event];
}
