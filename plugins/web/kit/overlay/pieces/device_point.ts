/** The device's point: a disc of constant size on the screen, visible through the surface. */
import { Group, Mesh, MeshBasicMaterial, SphereGeometry } from "three";
import type { View } from "../../view/view";
import { COLOURS } from "../colours";
import type { Reading } from "../../contact/reading";
import { metresPerPixel, type Piece, type Sight } from "../piece";
import type { Settings } from "../settings";

const RADIUS_PX = 6.5;
const RIM = 1.35;

export class DevicePoint implements Piece {
  private group = new Group();

  constructor(view: View) {
    const ball = new SphereGeometry(1, 24, 16);
    const seenThrough = { depthTest: false, depthWrite: false, transparent: true };
    const rim = new Mesh(ball, new MeshBasicMaterial({ color: COLOURS.rim, opacity: 0.75, ...seenThrough }));
    const disc = new Mesh(ball, new MeshBasicMaterial({ color: COLOURS.device, ...seenThrough }));
    rim.scale.setScalar(RIM);
    rim.renderOrder = 20;
    disc.renderOrder = 21;
    this.group.add(rim, disc);
    view.overlay(this.group);
  }

  put(live: Reading | null, { show }: Settings, sight: Sight): void {
    this.group.visible = live !== null && show.device;
    if (!live) return;
    this.group.position.set(...live.hand);
    this.group.scale.setScalar(RADIUS_PX * metresPerPixel(sight, live.hand));
  }
}
