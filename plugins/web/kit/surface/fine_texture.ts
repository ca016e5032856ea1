/** Fine texture of a square, as force laws use it, fetched from the server. */
import type { Server } from "../page";
import { bulk } from "../server/connection";
import type { Scene } from "./scene";
import type { FinePatch } from "../terrain/terrain";

export async function finePatch(
  net: Server, scene: Scene, [x, y]: [number, number], side_m: number, pixels: number,
): Promise<FinePatch> {
  const told = { digest: scene.meta.digest, x_m: x, y_m: y, side_m, pixels };
  const { file } = await net.ask<{ file: string }>("texture_patch", told);
  const heights = await bulk(`/scene/${scene.meta.digest}/${file}`).then((answer) => answer.arrayBuffer());
  return { x_m: x, y_m: y, side_m, pixels, heights: new Float32Array(heights) };
}

/** Return whether any material has a texture. */
export function hasTexture(scene: Scene): boolean {
  return scene.meta.labels > 0 && scene.meta.materials.some(({ roughness_m }) => roughness_m > 0);
}
