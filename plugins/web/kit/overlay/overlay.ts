/** The overlay: moving pieces over the surface, and the layer of texts and handles over the canvas. */
import "./overlay.css";
import { DirectionalLight, HemisphereLight } from "three";
import { NOBODY_M, type State, type Vec } from "../server/protocol";
import type { Scene } from "../surface/scene";
import type { View } from "../view/view";
import { ForceArrow } from "./pieces/force_arrow";
import { FrictionCone } from "./pieces/friction_cone";
import { DevicePoint } from "./pieces/device_point";
import { ContactLabel } from "./pieces/contact_label";
import { type Reading, StateReader } from "../contact/reading";
import { Picking } from "./picking";
import type { Piece, Sight } from "./piece";
import { Proxy } from "./pieces/proxy";
import { Rest } from "../contact/rest";
import { ContactRing } from "./pieces/contact_ring";
import { ScaleBar } from "./pieces/scale_bar";
import { roundDown125, settings } from "./settings";
import { Trace } from "./pieces/trace";

/** First length of a newton, as a share of the picture's width. */
const NEWTON_SHARE = 1 / 12;
const NEWTON_M = 0.005;

interface Pinned {
  element: HTMLElement;
  at: () => Vec | null;
}

export class Overlay {
  readonly settings = settings();
  /** Layer over the canvas, of its size; its elements let the mouse through unless they ask for it. */
  readonly layer = document.createElement("div");
  /** The latest reading; null while there is no state. */
  live: Reading | null = null;
  /** Set when something besides the state changed: the next frame draws it. */
  changed = false;
  readonly sight: Sight;
  /** The tool that takes the mouse from the hand. */
  readonly picking: Picking;
  private scene: Scene | null = null;
  private reading = new StateReader();
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
      new ForceArrow(view, "force"), new ForceArrow(view, "other"), new ContactLabel(this.layer, view), new ScaleBar(this.layer, view),
    ];
    new ResizeObserver(() => this.size()).observe(canvas);
    this.size();
  }

  /** Use another surface: a different size changes the length of a newton; the trace is cleared. */
  show(scene: Scene): void {
    const wide = scene.meta.extent_m[0];
    if (wide !== this.scene?.meta.extent_m[0]) this.settings.metresPerNewton = roundDown125(NEWTON_SHARE * wide) || NEWTON_M;
    this.scene = scene;
    this.trace.clear();
    this.changed = true;
  }

  /** Return whether a frame is needed: a change, a hand that is not at rest, or a trace that has yet to fade. */
  wants(state: State | null): boolean {
    const seen = (this.live?.seen ?? false) || (state !== null && state.hand[2] < NOBODY_M);
    const stirs = seen && !(state !== null && this.rest.isAtRest(state));
    return this.changed || stirs || this.trace.fades(this.settings.seconds);
  }

  /** Move everything to this state, before the frame is drawn. */
  put(state: State | null): void {
    this.changed = false;
    this.view.camera.updateMatrixWorld();
    if (!state) this.live = null;
    else if (state !== this.live?.state) this.live = this.reading.read(state, this.scene);
    const live = this.live?.seen ? this.live : null;
    for (const each of this.pieces) each.put(live, this.settings, this.sight);
    for (const each of this.pinned) this.pin(each);
    this.changed = this.pieces.some((each) => each.late);
  }

  /** Pin an element to a point of the workspace, hidden while that is null; return a function that removes it. */
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
