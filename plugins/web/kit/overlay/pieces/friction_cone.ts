/** The friction cone of the material under the contact: atan(mu) wide, as high as the normal part of the force.
 *
 * The arrow ends in the plane of the rims: within the solid rim, of static friction, while the contact sticks, and at
 * the dashed one, of dynamic friction, while it slips. */
import { BufferAttribute, BufferGeometry, ConeGeometry, Group, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, Vector3 } from "three";
import type { View } from "../../view/view";
import { COLOURS } from "../colours";
import type { Reading } from "../../contact/reading";
import type { Piece } from "../piece";
import type { Settings } from "../settings";

const UP = new Vector3(0, 0, 1);
const AROUND = 48;
const SIDES = 8;

/** Return lines of a cone of height 1 and radius 1 with its apex at the origin: every step-th piece of the rim. */
function lines(step: number, sides: number): BufferGeometry {
  const at = (i: number): number[] => [Math.cos((2 * Math.PI * i) / AROUND), Math.sin((2 * Math.PI * i) / AROUND), 1];
  const ends: number[] = [];
  for (let i = 0; i < AROUND; i += step) ends.push(...at(i), ...at(i + 1));
  for (let i = 0; i < sides; i++) ends.push(0, 0, 0, ...at((i * AROUND) / sides));
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(ends), 3));
  return geometry;
}

export class FrictionCone implements Piece {
  private group = new Group();
  private fixed = new Group();
  private sliding: LineSegments;
  private normal = new Vector3();

  constructor(view: View) {
    const light = { color: COLOURS.cone, transparent: true, depthWrite: false };
    const side = new ConeGeometry(1, 1, AROUND, 1, true).rotateX(-Math.PI / 2).translate(0, 0, 0.5);
    this.fixed.add(
      new LineSegments(lines(1, SIDES), new LineBasicMaterial({ ...light, opacity: 0.9 })),
      new Mesh(side, new MeshBasicMaterial({ ...light, opacity: 0.16, side: 2 })),
    );
    this.sliding = new LineSegments(lines(2, 0), new LineBasicMaterial({ ...light }));
    this.group.add(this.fixed, this.sliding);
    view.overlay(this.group);
  }

  put(live: Reading | null, { show, metresPerNewton }: Settings): void {
    const { static_friction, dynamic_friction } = live?.material ?? { static_friction: 0, dynamic_friction: 0 };
    this.group.visible = live !== null && live.touching && show.cone && static_friction > 0 && live.normalN > 0;
    if (!live || !this.group.visible) return;
    const high = live.normalN * metresPerNewton;
    this.group.position.set(...live.contact);
    this.group.quaternion.setFromUnitVectors(UP, this.normal.set(...live.normal));
    this.fixed.scale.set(high * static_friction, high * static_friction, high);
    this.sliding.visible = dynamic_friction > 0;
    this.sliding.scale.set(high * dynamic_friction, high * dynamic_friction, high);
  }
}
