/** A line draped over the surface: light with a dark rim, visible on any picture. */
import { Line2 } from "three/addons/lines/Line2.js";
import { LineGeometry } from "three/addons/lines/LineGeometry.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import type { Scene } from "../../surface/scene";
import type { Page } from "../../page";
import { COLOURS } from "../colours";

/** Straight pieces of the whole line; each costs a draw in software. */
const PIECES = 96;
const DASHES = 30;
const WIDTH_PX = { rim: 4, line: 2 };

export class DrapedLine {
  private rim: Line2;
  private line: Line2;
  private places: Float32Array;
  /** Pieces per side. */
  private pieces: number;

  /** Create a line of some straight sides, seen from above. */
  constructor(view: Pick<Page["view"], "overlay">, private sides: number, color: number, dashed = false) {
    this.pieces = Math.round(PIECES / sides);
    this.places = new Float32Array(3 * (sides * this.pieces + 1));
    const look = { depthTest: false, depthWrite: false, transparent: true };
    const addLine = (material: LineMaterial, order: number): Line2 => {
      const line = new Line2(new LineGeometry(), material);
      line.frustumCulled = line.visible = false;
      line.renderOrder = order;
      view.overlay(line);
      return line;
    };
    this.rim = addLine(new LineMaterial({ ...look, color: COLOURS.rim, opacity: 0.75, linewidth: WIDTH_PX.rim }), 6);
    this.line = addLine(new LineMaterial({ ...look, color, linewidth: WIDTH_PX.line, dashed }), 7);
  }

  set visible(on: boolean) {
    this.rim.visible = this.line.visible = on;
  }

  /** Lay the line through corners, one more than there are sides; outside the surface it continues at the rim's height. */
  put(scene: Scene, through: readonly (readonly [number, number, ...number[]])[]): void {
    let wayM = 0;
    for (let side = 0, o = 0; side < this.sides; side++) {
      const [from, to] = [through[side], through[side + 1]];
      wayM += Math.hypot(to[0] - from[0], to[1] - from[1]);
      for (let i = side ? 1 : 0; i <= this.pieces; i++, o += 3) {
        const x = from[0] + (i / this.pieces) * (to[0] - from[0]);
        const y = from[1] + (i / this.pieces) * (to[1] - from[1]);
        this.places.set([x, y, scene.on(x, y)[2]], o);
      }
    }
    for (const each of [this.rim, this.line]) each.geometry.setPositions(this.places);
    this.line.computeLineDistances();
    this.line.material.dashSize = this.line.material.gapSize = wayM / (2 * DASHES) || 1;
  }
}
