/** A force as an arrow from the contact; its length follows the scale. */
import {
  BackSide,
  BoxGeometry,
  type BufferGeometry,
  ConeGeometry,
  CylinderGeometry,
  Group,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  Vector3,
} from "three";
import { mergeGeometries } from "three/addons/utils/BufferGeometryUtils.js";
import type { Vec } from "../../server/protocol";
import type { View } from "../../view/view";
import { COLOURS } from "../colours";
import type { Reading } from "../../contact/reading";
import { metresPerPixel, type Piece, type Sight } from "../piece";
import { length } from "../../contact/vectors";
import type { Settings } from "../settings";

const UP = new Vector3(0, 1, 0);
const MIN_N = 1e-3;
const SHAFT_PX = 2.6;
const HEAD_PX = { radius: 7.5, length: 19 };
/** Greatest share of the head in a short arrow. */
const MAX_HEAD = 0.6;
const DASHES = 5;
/** Width of the dark hull, whose back faces make the arrow visible on any ground. */
const RIM_PX = 1.3;

/** Shapes: the active force is round and solid, the other law's square and dashed, so that colour is not needed. */
const SHAPES: Record<"force" | "other", () => [shaft: BufferGeometry, head: BufferGeometry]> = {
  force: () => [new CylinderGeometry(1, 1, 1, 16).translate(0, 0.5, 0), new ConeGeometry(1, 1, 24).translate(0, 0.5, 0)],
  other: () => {
    const dash = (i: number) => new BoxGeometry(1.6, 0.6 / DASHES, 1.6).translate(0, (i + 0.5) / DASHES, 0);
    return [mergeGeometries(Array.from({ length: DASHES }, (_, i) => dash(i))), new ConeGeometry(1, 1, 4).translate(0, 0.5, 0)];
  },
};

export class ForceArrow implements Piece {
  private group = new Group();
  private shaft: Mesh;
  private head: Mesh;
  private rims: [shaft: Mesh, head: Mesh];
  private way = new Vector3();

  constructor(view: View, private which: "force" | "other") {
    const paint = new MeshLambertMaterial({ color: COLOURS[which], emissive: COLOURS[which], emissiveIntensity: 0.35 });
    const [shaft, head] = SHAPES[which]();
    this.shaft = new Mesh(shaft, paint);
    this.head = new Mesh(head, paint);
    const dark = new MeshBasicMaterial({ color: COLOURS.rim, side: BackSide });
    this.rims = [new Mesh(shaft, dark), new Mesh(head, dark)];
    this.group.add(this.shaft, this.head, ...this.rims);
    view.overlay(this.group);
  }

  put(live: Reading | null, { show, metresPerNewton }: Settings, sight: Sight): void {
    const force: Vec = live?.state[this.which] ?? [0, 0, 0];
    const newtons = length(force);
    this.group.visible = live !== null && show.arrow && newtons > MIN_N;
    if (!live || !this.group.visible) return;
    const metres = newtons * metresPerNewton;
    const pixel = metresPerPixel(sight, live.contact);
    const head = Math.min(HEAD_PX.length * pixel, MAX_HEAD * metres);
    const thin = head / (HEAD_PX.length * pixel);
    this.group.position.set(...live.contact);
    this.group.quaternion.setFromUnitVectors(UP, this.way.set(...force).divideScalar(newtons));
    const [narrow, broad, rim] = [SHAFT_PX * pixel * thin, HEAD_PX.radius * pixel * thin, RIM_PX * pixel * thin];
    this.shaft.scale.set(narrow, metres - head, narrow);
    this.head.scale.set(broad, head, broad);
    this.head.position.y = metres - head;
    this.rims[0].scale.set(narrow + rim, metres - head, narrow + rim);
    this.rims[1].scale.set(broad + 1.5 * rim, head + 2 * rim, broad + 1.5 * rim);
    this.rims[1].position.y = metres - head - rim;
  }
}

/** Return the tip of a force's arrow. */
export function tip(live: Reading, force: Vec, metresPerNewton: number): Vec {
  const [x, y, z] = live.contact;
  return [x + force[0] * metresPerNewton, y + force[1] * metresPerNewton, z + force[2] * metresPerNewton];
}
