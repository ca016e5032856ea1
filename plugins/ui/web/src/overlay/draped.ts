/** A line that lies on the surface. */
import { BufferAttribute, BufferGeometry, Line, LineBasicMaterial, LineDashedMaterial } from "three";
import type { Scene } from "../scene";
import type { View } from "../view";

/** Places between two corners. */
const PIECES = 64;

export class Draped {
  private places: BufferAttribute;
  readonly line: Line;

  /** sides: how many straight pieces, seen from above, it has. */
  constructor(view: View, private sides: number, color: number, dashed = false) {
    this.places = new BufferAttribute(new Float32Array(3 * (sides * PIECES + 1)), 3);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", this.places);
    const look = { color, depthTest: false, depthWrite: false, transparent: true };
    this.line = new Line(geometry, dashed ? new LineDashedMaterial({ ...look, dashSize: 0.001, gapSize: 0.0007 }) : new LineBasicMaterial(look));
    this.line.frustumCulled = false;
    this.line.visible = false;
    this.line.renderOrder = 8;
    view.overlay(this.line);
  }

  /** Through these corners, one more than there are sides; beyond the rim it goes on at the rim's height. */
  put(scene: Scene, through: readonly (readonly [number, number, ...number[]])[]): void {
    for (let side = 0, o = 0; side < this.sides; side++) {
      const [from, to] = [through[side], through[side + 1]];
      for (let i = side ? 1 : 0; i <= PIECES; i++, o++) {
        const x = from[0] + (i / PIECES) * (to[0] - from[0]);
        const y = from[1] + (i / PIECES) * (to[1] - from[1]);
        this.places.setXYZ(o, x, y, scene.on(x, y)[2]);
      }
    }
    this.places.needsUpdate = true;
    if (this.line.material instanceof LineDashedMaterial) this.line.computeLineDistances();
  }
}
