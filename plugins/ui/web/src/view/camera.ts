/** Where one looks from: around a place on the surface, by mouse, fingers and keys. */
import { PerspectiveCamera, Vector3 } from "three";
import type { Vec } from "../server/protocol";

const FIELD_DEG = 36;
const FLIGHT_MS = 260;
const FLATTEST = 1.48;
const STEEPEST = 0.002;
const HOME = { azimuth: 0, polar: 0.86 };
const MARGIN = 0.94;
const NEAR_GROUND = 0.3;
const KEY_TURN = 0.12;
const KEY_SHARE = 0.06;
const TURN_PER_PIXEL = 0.008;

/** Around which place, from how far, and from where: the azimuth is that of the eye, 0 from the near side. */
export interface Pose {
  target: Vec;
  distance: number;
  azimuth: number;
  polar: number;
}

export class Eye {
  readonly camera = new PerspectiveCamera(FIELD_DEG, 1, 0.001, 1);
  pose: Pose = { target: [0, 0, 0], distance: 0.2, ...HOME };
  /** Called whenever it looks another way. */
  changed: () => void = () => {};
  /** Height of what is under a place; NaN where nothing is. */
  ground: (x: number, y: number) => number = () => NaN;
  private size: [number, number] = [0.08, 0.06];
  private span: [number, number] = [0, 0];
  private flight: { from: Pose; to: Pose; begunMs: number } | null = null;

  constructor() {
    this.camera.up.set(0, 0, 1);
    this.place();
  }

  /** The whole of a surface of this size, from the near side. */
  frame(width_m: number, length_m: number, height_m: [number, number] = [0, 0]): void {
    this.size = [width_m, length_m];
    this.span = height_m;
    this.pose = this.whole(HOME.polar);
    this.flight = null;
    this.place();
  }

  home(): void {
    this.fly(this.whole(HOME.polar));
  }

  /** From above, the far side up. */
  top(): void {
    this.fly(this.whole(STEEPEST));
  }

  focus(target: Vec, width_m: number): void {
    const distance = (1.15 * width_m) / (2 * Math.tan(this.halfField()) * Math.min(this.camera.aspect, 1.4));
    this.fly({ ...this.pose, target, distance: this.bounded(distance) });
  }

  orbit(azimuth: number, polar: number): void {
    const { pose } = this;
    this.go({
      ...pose,
      azimuth: pose.azimuth + azimuth,
      polar: Math.min(Math.max(pose.polar + polar, STEEPEST), FLATTEST),
    });
  }

  /** By parts of what is seen of the height, to the right and up; what is seen moves the other way. */
  pan(right: number, up: number): void {
    const { azimuth, distance, target } = this.pose;
    const [sine, cosine] = [Math.sin(azimuth), Math.cos(azimuth)];
    const seen = 2 * distance * Math.tan(this.halfField());
    const [w, l] = this.size;
    const [x, y] = [target[0] + seen * (right * cosine - up * sine), target[1] + seen * (right * sine + up * cosine)];
    const within = (value: number, side: number): number => Math.min(Math.max(value, -0.6 * side), 0.6 * side);
    this.go({ ...this.pose, target: [within(x, w), within(y, l), target[2]] });
  }

  /** The distance times this; the place `about` stays where it is on the screen. */
  zoom(times: number, about: Vec | null = null): void {
    const { distance, target } = this.pose;
    const next = this.bounded(distance * times);
    const share = next / distance;
    const kept = about ?? target;
    const moved = target.map((part, k) => kept[k] + (part - kept[k]) * share) as Vec;
    this.go({ ...this.pose, distance: next, target: moved });
  }

  /** Whether it flies on: to be called once a frame. */
  advance(nowMs: number): boolean {
    if (!this.flight) return false;
    const { from, to, begunMs } = this.flight;
    const part = Math.min((nowMs - begunMs) / FLIGHT_MS, 1);
    const share = part * part * (3 - 2 * part);
    const mix = (a: number, b: number): number => a + (b - a) * share;
    this.pose = {
      target: from.target.map((each, k) => mix(each, to.target[k])) as Vec,
      distance: from.distance * (to.distance / from.distance) ** share,
      azimuth: mix(from.azimuth, to.azimuth),
      polar: mix(from.polar, to.polar),
    };
    if (part === 1) this.flight = null;
    this.place();
    return true;
  }

  resize(width: number, height: number): void {
    const atHome = this.pose.azimuth === HOME.azimuth && this.pose.polar === HOME.polar && !this.flight;
    const whole = atHome && Math.abs(this.pose.distance / this.whole(HOME.polar).distance - 1) < 1e-6;
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (whole) this.pose = this.whole(HOME.polar);
    this.place();
  }

  private go(pose: Pose): void {
    this.flight = null;
    this.pose = { ...pose, target: this.grounded(pose) };
    this.place();
  }

  /** The nearer one looks, the nearer to the ground is what one looks at, so that nobody dives under it. */
  private grounded({ target, distance }: Pose): Vec {
    const [x, y, z] = target;
    const ground = this.ground(x, y);
    const within = Math.min(Math.max(z, ground - NEAR_GROUND * distance), ground + NEAR_GROUND * distance);
    return [x, y, Number.isNaN(within) ? z : within];
  }

  private fly(to: Pose): void {
    if (matchMedia("(prefers-reduced-motion: reduce)").matches) return this.go(to);
    const turns = Math.round((this.pose.azimuth - to.azimuth) / (2 * Math.PI));
    const from = { ...this.pose, azimuth: this.pose.azimuth - turns * 2 * Math.PI };
    this.flight = { from, to, begunMs: performance.now() };
    this.changed();
  }

  /** So far away that all corners are seen. */
  private whole(polar: number): Pose {
    const [w, l] = this.size;
    const [low, high] = this.span;
    const pose = (distance: number): Pose => ({ target: [0, 0, (low + high) / 2], distance, azimuth: HOME.azimuth, polar });
    let [near, far] = [0.05 * (w + l), 20 * (w + l)];
    for (let k = 0; k < 40; k++) {
      const middle = Math.sqrt(near * far);
      this.put(pose(middle));
      const corners = [-w / 2, w / 2].flatMap((x) => [-l / 2, l / 2].flatMap((y) => [low, high].map((z) => [x, y, z] as Vec)));
      const seen = corners.every((each) => this.sees(each));
      [near, far] = seen ? [near, middle] : [middle, far];
    }
    this.put(this.pose);
    return pose(far);
  }

  private sees(point: Vec): boolean {
    const { x, y, z } = new Vector3(...point).project(this.camera);
    return Math.abs(x) < MARGIN && Math.abs(y) < MARGIN && z < 1;
  }

  private bounded(distance: number): number {
    const size = Math.max(...this.size);
    return Math.min(Math.max(distance, 0.02 * size), 20 * size);
  }

  private halfField(): number {
    return (FIELD_DEG * Math.PI) / 360;
  }

  private place(): void {
    this.put(this.pose);
    this.changed();
  }

  private put({ target, distance, azimuth, polar }: Pose): void {
    const { camera } = this;
    const flat = distance * Math.sin(polar);
    camera.position.set(
      target[0] + flat * Math.sin(azimuth),
      target[1] - flat * Math.cos(azimuth),
      target[2] + distance * Math.cos(polar),
    );
    camera.near = 0.05 * distance;
    camera.far = distance + 6 * Math.max(...this.size);
    camera.updateProjectionMatrix();
    camera.lookAt(...target);
    camera.updateMatrixWorld();
  }
}

/** The keys of the camera, as they are pressed on the terrain. */
export const CAMERA_KEYS = [
  { keys: ["Ctrl", "Shift", "← → ↑ ↓"], does: "orbit" },
  { keys: ["Alt", "← → ↑ ↓"], does: "pan" },
  { keys: ["+", "−"], does: "zoom" },
  { keys: ["Ctrl", "Home"], does: "home" },
  { keys: ["Ctrl", "End"], does: "top" },
] as const;

const WAYS: Record<string, [number, number]> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, 1],
  ArrowDown: [0, -1],
};

/** Whether the key is one of the camera's: none that is the hand's (shortcuts.ts). */
export function key(eye: Eye, event: KeyboardEvent): boolean {
  const way = WAYS[event.key];
  const { ctrlKey, shiftKey, altKey } = event;
  if (event.metaKey) return false;
  if (way && ctrlKey && shiftKey && !altKey) eye.orbit(way[0] * KEY_TURN, -way[1] * KEY_TURN);
  else if (way && altKey && !ctrlKey && !shiftKey) eye.pan(way[0] * KEY_SHARE, way[1] * KEY_SHARE);
  else if (altKey) return false;
  else if (event.key === "Home" && ctrlKey) eye.home();
  else if (event.key === "End" && ctrlKey) eye.top();
  else if (ctrlKey) return false;
  else if (event.key === "+") eye.zoom(0.85);
  else if (event.key === "-") eye.zoom(1 / 0.85);
  else return false;
  return true;
}

/**
 * Mouse, fingers, wheel and keys that are the camera's: they are taken before anything else on the canvas hears of them.
 * One finger and the plain left button are the hand's. When a second finger comes, the first one's hand is let go.
 */
export function steer(canvas: HTMLCanvasElement, eye: Eye, ground: (x: number, y: number) => Vec | null): void {
  const fingers = new Map<number, [number, number]>();
  let grip: { pointer: number; orbits: boolean; at: [number, number] } | null = null;
  let pinching = false;

  const take = (event: Event): void => {
    event.preventDefault();
    event.stopImmediatePropagation();
  };

  function down(event: PointerEvent): void {
    if (event.pointerType === "touch") return finger(event);
    const orbits = event.button === 1 || (event.button === 0 && event.altKey);
    const pans = event.button === 2 || (event.button === 0 && event.shiftKey);
    if (!orbits && !pans) return;
    grip = { pointer: event.pointerId, orbits, at: [event.clientX, event.clientY] };
    canvas.setPointerCapture(event.pointerId);
    canvas.focus({ preventScroll: true });
    take(event);
  }

  function finger(event: PointerEvent): void {
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    if (fingers.size < 2) return;
    if (!pinching)
      for (const pointerId of fingers.keys())
        if (pointerId !== event.pointerId) canvas.dispatchEvent(new PointerEvent("pointercancel", { pointerId, pointerType: "touch" }));
    pinching = true;
    take(event);
  }

  function move(event: PointerEvent): void {
    if (fingers.has(event.pointerId)) {
      if (pinching) pinch(event);
      fingers.set(event.pointerId, [event.clientX, event.clientY]);
      if (pinching) take(event);
    } else if (grip?.pointer === event.pointerId) {
      const [dx, dy] = [event.clientX - grip.at[0], event.clientY - grip.at[1]];
      grip.at = [event.clientX, event.clientY];
      if (grip.orbits) eye.orbit(-dx * TURN_PER_PIXEL, -dy * TURN_PER_PIXEL);
      else eye.pan(-dx / canvas.clientHeight, dy / canvas.clientHeight);
      take(event);
    }
  }

  /** Two fingers: apart is nearer, turned is turned, together is along. */
  function pinch(event: PointerEvent): void {
    const other = [...fingers].find(([id]) => id !== event.pointerId)?.[1];
    const was = fingers.get(event.pointerId)!;
    if (!other || fingers.size !== 2) return;
    const is: [number, number] = [event.clientX, event.clientY];
    const [before, after] = [was, is].map(([x, y]) => [x - other[0], y - other[1]]);
    const turn = Math.atan2(after[1], after[0]) - Math.atan2(before[1], before[0]);
    const middle = ground((is[0] + other[0]) / 2, (is[1] + other[1]) / 2);
    eye.zoom(Math.hypot(before[0], before[1]) / Math.max(Math.hypot(after[0], after[1]), 1), middle);
    eye.orbit(Math.atan2(Math.sin(turn), Math.cos(turn)), 0);
    eye.pan(-(is[0] - was[0]) / 2 / canvas.clientHeight, (is[1] - was[1]) / 2 / canvas.clientHeight);
  }

  function up(event: PointerEvent): void {
    if (!event.isTrusted) return; // our own, for the hand
    if (fingers.delete(event.pointerId)) {
      if (pinching) take(event);
      if (!fingers.size) pinching = false;
    } else if (grip?.pointer === event.pointerId) {
      grip = null;
      take(event);
    }
  }

  const first = { capture: true, passive: false };
  canvas.addEventListener("pointerdown", down, first);
  canvas.addEventListener("pointermove", move, first);
  canvas.addEventListener("pointerup", up, first);
  canvas.addEventListener("pointercancel", up, first);
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener(
    "wheel",
    (event) => {
      if (!event.ctrlKey) return; // the hand's depth
      eye.zoom(Math.exp(Math.min(Math.max(event.deltaY, -60), 60) * 0.004), ground(event.clientX, event.clientY));
      take(event);
    },
    first,
  );
  canvas.addEventListener("keydown", (event) => key(eye, event) && take(event), first);
}
