/** The picture without WebGL: from above, on a plain canvas, with a ring where the hand is. */
import { colour } from "kit/themes";
import type { Page } from "kit/page";
import { isHeld } from "kit/server/protocol";
import type { Scene } from "kit/surface/scene";

const RING_PX = 12;

/** Draw the picture flat if nothing else can. */
export function drawFlat(page: Pick<Page, "hub" | "net" | "view" | "canvas" | "scene">): void {
  const { canvas, hub, net, view } = page;
  const pen = view.trouble === "missing" ? canvas.getContext("2d") : null;
  if (!pen) return;
  let picture: CanvasImageSource | null = null;
  const paint = (): void => {
    [canvas.width, canvas.height] = [canvas.clientWidth, canvas.clientHeight];
    const { scene } = page;
    if (!scene || !picture) return;
    const [w, l] = scene.meta.extent_m;
    const level = scene.meta.height_m[0];
    const [left, far] = view.toScreen([-w / 2, l / 2, level]);
    const [right, near] = view.toScreen([w / 2, -l / 2, level]);
    pen.drawImage(picture, left, far, right - left, near - far);
    const state = net.latest;
    if (!state || !isHeld(state)) return;
    pen.beginPath();
    pen.arc(...view.toScreen(state.hand), RING_PX, 0, 2 * Math.PI);
    pen.lineWidth = 4;
    pen.strokeStyle = colour("--hand");
    pen.stroke();
  };
  hub.on("shown", (scene) => {
    picture = scene.photo ?? greyOf(scene);
    view.eye.top();
  });
  hub.on("drawn", paint);
  view.rested = paint;
  new ResizeObserver(paint).observe(canvas);
}

/** Return the heights in grey, high ones light. */
function greyOf({ whole, meta }: Scene): HTMLCanvasElement {
  const { heights, rows, columns } = whole.grid;
  const [low, high] = meta.height_m;
  const picture = Object.assign(document.createElement("canvas"), { width: columns, height: rows });
  const pixels = new ImageData(columns, rows);
  heights.forEach((each, k) => pixels.data.set([...Array<number>(3).fill((255 * (each - low)) / (high - low || 1)), 255], 4 * k));
  picture.getContext("2d")!.putImageData(pixels, 0, 0);
  return picture;
}
