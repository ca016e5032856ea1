/** The fine textures of a square, as laws feel them: fetched from what makes them. */
import { bulk, type Net } from "../server/connection";
import type { Scene } from "./scene";
import type { FinePatch } from "../terrain/terrain";

export async function finePatch(
  net: Net, scene: Scene, [x, y]: [number, number], side_m: number, pixels: number,
): Promise<FinePatch> {
  const told = { digest: scene.meta.digest, x_m: x, y_m: y, side_m, pixels };
  const { file } = await net.ask<{ file: string }>("texture_patch", told);
  const heights = await bulk(`/scene/${scene.meta.digest}/${file}`).then((answer) => answer.arrayBuffer());
  return { x_m: x, y_m: y, side_m, pixels, heights: new Float32Array(heights) };
}

/** Whether any material has one. */
export function textured(scene: Scene): boolean {
  return scene.meta.labels > 0 && scene.meta.materials.some(({ roughness_m }) => roughness_m > 0);
}
