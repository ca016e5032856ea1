/** What moves over the terrain: the device's point, the contact, the force. */
import {
  ConeGeometry,
  CylinderGeometry,
  DirectionalLight,
  Group,
  HemisphereLight,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  Quaternion,
  SphereGeometry,
  TorusGeometry,
  Vector3,
} from "three";
import type { Page } from "./page";
import type { State, Vec } from "./protocol";

const UP = new Vector3(0, 1, 0);
const Z = new Vector3(0, 0, 1);
const NEWTONS = 4;
const plain = (color: number, more = {}): MeshLambertMaterial => new MeshLambertMaterial({ color, ...more });

export class Cursors {
  private hand = new Mesh(new SphereGeometry(1, 20, 14), plain(0xff5d8f, { transparent: true, opacity: 0.85, depthTest: false }));
  private proxy = new Mesh(new SphereGeometry(1, 24, 16), plain(0x35d0ff));
  private ring = new Mesh(new TorusGeometry(1, 0.09, 8, 40), new MeshBasicMaterial({ color: 0xffb020 }));
  private arrow = new Group();
  private shaft = new Mesh(new CylinderGeometry(1, 1, 1, 14).translate(0, 0.5, 0), plain(0xffb020));
  private head = new Mesh(new ConeGeometry(1, 1, 18).translate(0, 0.5, 0), plain(0xffb020));

  constructor(private page: Page) {
    const sun = new DirectionalLight(0xffffff, 2);
    sun.position.set(-1, -1, 2);
    this.arrow.add(this.shaft, this.head);
    for (const each of [new HemisphereLight(0xffffff, 0x556070, 2), sun, this.hand, this.proxy, this.ring, this.arrow])
      page.view.overlay(each);
    for (const each of [this.hand, this.proxy, this.ring, this.arrow]) each.visible = false;
    page.hub.on("state", (state) => this.put(state));
  }

  private put(state: State): void {
    const seen = state.hand[2] < 0.5;
    const touching = seen && (state.flags & 1) !== 0;
    const unit = (this.page.scene?.meta.extent_m[0] ?? 0.08) / 80;
    this.hand.visible = seen;
    this.proxy.visible = this.ring.visible = this.arrow.visible = touching;
    this.hand.position.set(...state.hand);
    this.hand.scale.setScalar(0.75 * unit);
    if (touching) this.touch(state, unit);
  }

  private touch(state: State, unit: number): void {
    const at = Number.isNaN(state.proxy[2]) ? state.hand : state.proxy;
    const newtons = Math.hypot(...state.force);
    const normal: Vec = this.page.scene?.normal(state.hand[0], state.hand[1]) ?? [0, 0, 1];
    for (const each of [this.proxy, this.ring, this.arrow]) each.position.set(...at);
    this.proxy.scale.setScalar(0.95 * unit);
    this.ring.scale.setScalar(2 * unit);
    this.ring.quaternion.setFromUnitVectors(Z, new Vector3(...normal));
    const length = (2 + 6 * Math.min(newtons, NEWTONS)) * unit;
    const way = new Vector3(...state.force).divideScalar(newtons || 1);
    this.arrow.visible = newtons > 1e-3;
    this.arrow.quaternion.copy(new Quaternion().setFromUnitVectors(UP, way));
    this.shaft.scale.set(0.38 * unit, length, 0.38 * unit);
    this.head.scale.set(unit, 2.4 * unit, unit);
    this.head.position.y = length;
  }
}
