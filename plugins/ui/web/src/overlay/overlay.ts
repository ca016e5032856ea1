/** All that is drawn over the surface and moves: its pieces, and the layer of words and handles over the canvas. */
import "./overlay.css";
import { DirectionalLight, HemisphereLight } from "three";
import type { State, Vec } from "../server/protocol";
import type { Scene } from "../surface/scene";
import type { View } from "../view/view";
import { ForceArrow } from "./pieces/force_arrow";
import { FrictionCone } from "./pieces/friction_cone";
import { DevicePoint } from "./pieces/device_point";
import { Labels } from "./pieces/contact_label";
import { NOBODY_M, Reading, type Live } from "../contact/reading";
import { Picking } from "./picking";
import type { Piece, Sight } from "./piece";
import { Proxy } from "./pieces/proxy";
import { Rest } from "../contact/rest";
import { ContactRing } from "./pieces/contact_ring";
import { ScaleBar } from "./pieces/scale_bar";
import { round, settings } from "./settings";
import { Trace } from "./pieces/trace";

/** Of the picture's width: how long a newton is at first. */
const NEWTON_SHARE = 1 / 12;
const NEWTON_M = 0.005;

interface Pinned {
  element: HTMLElement;
  at: () => Vec | null;
}

export class Overlay {
  readonly settings = settings();
  /** Over the canvas, as large as it; what is in it does not catch the mouse unless it says so. */
  readonly layer = document.createElement("div");
  /** What was drawn last; null while there is no state. */
  live: Live | null = null;
  /** Set where something of it changed that is not a state: the next frame draws it. */
  changed = false;
  readonly sight: Sight;
  /** Who has the mouse in the hand's place. */
  readonly picking: Picking;
  private scene: Scene | null = null;
  private reading = new Reading();
  private rest = new Rest();
  private trace: Trace;
  private pieces: Piece[];
  private pinned = new Set<Pinned>();

  constructor(
    private view: View,
    private canvas: HTMLCanvasElement,
  ) {
    this.layer.className = "overlay";
    canvas.after(this.layer);
    this.picking = new Picking(view, canvas, () => this.scene);
    this.sight = { camera: view.camera, width: 1, height: 1 };
    const sun = new DirectionalLight(0xffffff, 2);
    sun.position.set(-1, -1, 2);
    for (const each of [new HemisphereLight(0xffffff, 0x556070, 2), sun]) view.overlay(each);
    this.trace = new Trace(view);
    this.pieces = [
      this.trace, new ContactRing(view), new FrictionCone(view), new Proxy(view), new DevicePoint(view),
      new ForceArrow(view, "force"), new ForceArrow(view, "other"), new Labels(this.layer, view), new ScaleBar(this.layer, view),
    ];
    new ResizeObserver(() => this.size()).observe(canvas);
    this.size();
  }

  /** Another surface: where its size is another, so is the length of a newton; the trace of the one before is gone. */
  show(scene: Scene): void {
    const wide = scene.meta.extent_m[0];
    if (wide !== this.scene?.meta.extent_m[0]) this.settings.metresPerNewton = round(NEWTON_SHARE * wide) || NEWTON_M;
    this.scene = scene;
    this.trace.clear();
    this.changed = true;
  }

  /** Whether a frame is wanted: something changed, or there is a hand that is not at rest, or its trace has yet to fade. */
  wants(state: State | null): boolean {
    const seen = (this.live?.seen ?? false) || (state !== null && state.hand[2] < NOBODY_M);
    const stirs = seen && !(state !== null && this.rest.lasts(state));
    return this.changed || stirs || this.trace.fades(this.settings.seconds);
  }

  /** Everything where this state has it, before the frame is drawn. */
  put(state: State | null): void {
    this.changed = false;
    this.view.camera.updateMatrixWorld();
    if (!state) this.live = null;
    else if (state !== this.live?.state) this.live = this.reading.of(state, this.scene);
    const live = this.live?.seen ? this.live : null;
    for (const each of this.pieces) each.put(live, this.settings, this.sight);
    for (const each of this.pinned) this.pin(each);
    this.changed = this.pieces.some((each) => each.late);
  }

  /** Keep an element of the layer at a place of the workspace; hidden while that is null. The answer takes it away. */
  stay(element: HTMLElement, at: () => Vec | null): () => void {
    const pinned = { element, at };
    element.classList.add("pinned");
    this.layer.append(element);
    this.pinned.add(pinned);
    this.changed = true;
    return () => {
      element.remove();
      this.pinned.delete(pinned);
    };
  }

  private pin({ element, at }: Pinned): void {
    const place = at();
    element.hidden = place === null;
    if (!place) return;
    const [x, y] = this.view.toScreen(place);
    element.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
  }

  private size(): void {
    const { canvas, layer, sight } = this;
    sight.width = Math.max(1, canvas.clientWidth);
    sight.height = Math.max(1, canvas.clientHeight);
    Object.assign(layer.style, {
      left: `${canvas.offsetLeft}px`, top: `${canvas.offsetTop}px`, width: `${sight.width}px`, height: `${sight.height}px`,
    });
    this.changed = true;
  }
}
