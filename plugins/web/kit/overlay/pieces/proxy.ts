/** The proxy, if the law has one: a diamond, and a line to the hand. */
import { BufferAttribute, BufferGeometry, Group, Line, LineBasicMaterial, Mesh, MeshBasicMaterial, OctahedronGeometry } from "three";
import type { View } from "../../view/view";
import { COLOURS } from "../colours";
import type { Reading } from "../../contact/reading";
import { metresPerPixel, type Piece, type Sight } from "../piece";
import type { Settings } from "../settings";

const RADIUS_PX = 7;
const RIM = 1.4;

export class Proxy implements Piece {
  private group = new Group();
  private ends = new BufferAttribute(new Float32Array(6), 3);
  private line: Line;

  constructor(view: View) {
    const body = new OctahedronGeometry(1);
    const seenThrough = { depthTest: false, depthWrite: false, transparent: true };
    const rim = new Mesh(body, new MeshBasicMaterial({ color: COLOURS.rim, opacity: 0.75, ...seenThrough }));
    const diamond = new Mesh(body, new MeshBasicMaterial({ color: COLOURS.proxy, ...seenThrough }));
    rim.scale.setScalar(RIM);
    rim.renderOrder = 17;
    diamond.renderOrder = 18;
    this.group.add(rim, diamond);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", this.ends);
    this.line = new Line(geometry, new LineBasicMaterial({ color: COLOURS.frame, ...seenThrough }));
    this.line.frustumCulled = false;
    this.line.renderOrder = 16;
    view.overlay(this.group);
    view.overlay(this.line);
  }

  put(live: Reading | null, { show }: Settings, sight: Sight): void {
    const at = live?.proxy ?? null;
    this.group.visible = this.line.visible = at !== null && show.proxy;
    if (!live || !at) return;
    this.group.position.set(...at);
    this.group.scale.setScalar(RADIUS_PX * metresPerPixel(sight, at));
    this.ends.set([...live.hand, ...at]);
    this.ends.needsUpdate = true;
  }
}
