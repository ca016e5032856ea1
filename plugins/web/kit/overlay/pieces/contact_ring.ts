/** The contact: a ring on the surface; solid while the contact sticks, broken while it moves. */
import { Group, Mesh, MeshBasicMaterial, RingGeometry, Vector3 } from "three";
import { mergeGeometries } from "three/addons/utils/BufferGeometryUtils.js";
import type { View } from "../../view/view";
import { COLOURS } from "../colours";
import type { Reading } from "../../contact/reading";
import { metresPerPixel, type Piece, type Sight } from "../piece";
import type { Settings } from "../settings";

const RADIUS_PX = 17;
const PIECES = 8;
const UP = new Vector3(0, 0, 1);

export class ContactRing implements Piece {
  private group = new Group();
  private holds: Mesh[];
  private moves: Mesh[];
  private normal = new Vector3();

  constructor(view: View) {
    const arcs = (inner: number, outer: number) =>
      mergeGeometries(
        Array.from({ length: PIECES }, (_, i) => new RingGeometry(inner, outer, 8, 1, (2 * Math.PI * i) / PIECES, Math.PI / PIECES)),
      );
    const paint = (color: number, opacity: number) =>
      new MeshBasicMaterial({ color, opacity, side: 2, depthTest: false, depthWrite: false, transparent: true });
    const rim = paint(COLOURS.rim, 0.7);
    const force = paint(COLOURS.force, 1);
    this.holds = [new Mesh(new RingGeometry(0.8, 1.1, 48), rim), new Mesh(new RingGeometry(0.87, 1.03, 48), force)];
    this.moves = [new Mesh(arcs(0.8, 1.1), rim), new Mesh(arcs(0.87, 1.03), force)];
    for (const [order, each] of [...this.holds, ...this.moves].entries()) {
      each.renderOrder = 10 + (order % 2);
      this.group.add(each);
    }
    view.overlay(this.group);
  }

  put(live: Reading | null, { show }: Settings, sight: Sight): void {
    this.group.visible = live !== null && live.touching && show.ring;
    if (!live || !this.group.visible) return;
    const moving = live.grip === "slips" || live.grip === "glides";
    for (const each of this.holds) each.visible = !moving;
    for (const each of this.moves) each.visible = moving;
    this.group.position.set(...live.contact);
    this.group.quaternion.setFromUnitVectors(UP, this.normal.set(...live.normal));
    this.group.scale.setScalar(RADIUS_PX * metresPerPixel(sight, live.contact));
  }
}
