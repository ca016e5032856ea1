/** The camera: it orbits a place on the surface. */
import { PerspectiveCamera, Vector3 } from "three";
import type { Vec } from "../server/protocol";
import type { Covered } from "./free_part";

const FIELD_DEG = 36;
const FLIGHT_MS = 260;
const FLATTEST = 1.48;
const STEEPEST = 0.002;
const HOME = { azimuth: 0, polar: 0.86 };
const MARGIN = 0.94;
const NEAR_GROUND = 0.3;

/** Pose: target, distance and angles; azimuth 0 is the near side. */
export interface Pose {
  target: Vec;
  distance: number;
  azimuth: number;
  polar: number;
}

export class Eye {
  readonly camera = new PerspectiveCamera(FIELD_DEG, 1, 0.001, 1);
  pose: Pose = { target: [0, 0, 0], distance: 0.2, ...HOME };
  /** Called when the view changes. */
  onChange: () => void = () => {};
  /** Returns the height of the surface at a place; NaN outside. */
  ground: (x: number, y: number) => number = () => NaN;
  private size: [number, number] = [0.08, 0.06];
  private span: [number, number] = [0, 0];
  private covered: Covered = { top: 0, right: 0, bottom: 0 };
  private flight: { from: Pose; to: Pose; begunMs: number } | null = null;

  constructor() {
    this.camera.up.set(0, 0, 1);
    this.place();
  }

  /** Show the whole of a surface of this size from the near side. */
  frame(width_m: number, length_m: number, height_m: [number, number] = [0, 0]): void {
    this.size = [width_m, length_m];
    this.span = height_m;
    this.pose = this.whole(HOME.polar);
    this.flight = null;
    this.place();
  }

  home(): void {
    this.flyTo(this.whole(HOME.polar));
  }

  /** Show the whole surface from above, the far side up. */
  top(): void {
    this.flyTo(this.whole(STEEPEST));
  }

  focus(target: Vec, width_m: number): void {
    const distance = (1.15 * width_m) / (2 * Math.tan(this.halfField()) * Math.min(this.camera.aspect, 1.4));
    this.flyTo({ ...this.pose, target, distance: this.clampDistance(distance) });
  }

  orbit(azimuth: number, polar: number): void {
    const { pose } = this;
    this.jumpTo({
      ...pose,
      azimuth: pose.azimuth + azimuth,
      polar: Math.min(Math.max(pose.polar + polar, STEEPEST), FLATTEST),
    });
  }

  /** Pan by shares of the visible height, to the right and up. */
  pan(right: number, up: number): void {
    const { azimuth, distance, target } = this.pose;
    const [sine, cosine] = [Math.sin(azimuth), Math.cos(azimuth)];
    const seen = 2 * distance * Math.tan(this.halfField());
    const [w, l] = this.size;
    const [x, y] = [target[0] + seen * (right * cosine - up * sine), target[1] + seen * (right * sine + up * cosine)];
    const within = (value: number, side: number): number => Math.min(Math.max(value, -0.6 * side), 0.6 * side);
    this.jumpTo({ ...this.pose, target: [within(x, w), within(y, l), target[2]] });
  }

  /** Scale the distance; the place `about` stays on the screen. */
  zoom(times: number, about: Vec | null = null): void {
    const { distance, target } = this.pose;
    const next = this.clampDistance(distance * times);
    const share = next / distance;
    const kept = about ?? target;
    const moved = target.map((part, k) => kept[k] + (part - kept[k]) * share) as Vec;
    this.jumpTo({ ...this.pose, distance: next, target: moved });
  }

  /** Advance a flight; return whether one is under way. Call once per frame. */
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
    this.project(width / height, this.covered);
  }

  /** Look at the target in the middle of what is free of the canvas, and show the whole surface there. */
  cover(covered: Covered): void {
    this.project(this.camera.aspect, covered);
  }

  /** Change the projection; a surface that is shown whole stays whole. */
  private project(aspect: number, covered: Covered): void {
    const atHome = this.pose.azimuth === HOME.azimuth && this.pose.polar === HOME.polar && !this.flight;
    const wholePose = atHome && Math.abs(this.pose.distance / this.whole(HOME.polar).distance - 1) < 1e-6;
    this.covered = covered;
    const { top, right, bottom } = covered;
    this.camera.setViewOffset(aspect, 1, (aspect * right) / 2, (bottom - top) / 2, aspect, 1); // sets the aspect too
    if (wholePose) this.pose = this.whole(HOME.polar);
    this.place();
  }

  private jumpTo(pose: Pose): void {
    this.flight = null;
    this.pose = { ...pose, target: this.keepNearGround(pose) };
    this.place();
  }

  /** Keep the target near the ground, the nearer the camera is, so that it does not dive under it. */
  private keepNearGround({ target, distance }: Pose): Vec {
    const [x, y, z] = target;
    const ground = this.ground(x, y);
    const within = Math.min(Math.max(z, ground - NEAR_GROUND * distance), ground + NEAR_GROUND * distance);
    return [x, y, Number.isNaN(within) ? z : within];
  }

  private flyTo(to: Pose): void {
    if (matchMedia("(prefers-reduced-motion: reduce)").matches) return this.jumpTo(to);
    const turns = Math.round((this.pose.azimuth - to.azimuth) / (2 * Math.PI));
    const from = { ...this.pose, azimuth: this.pose.azimuth - turns * 2 * Math.PI };
    this.flight = { from, to, begunMs: performance.now() };
    this.onChange();
  }

  /** Return the pose that shows all corners. */
  private whole(polar: number): Pose {
    const [w, l] = this.size;
    const [low, high] = this.span;
    const pose = (distance: number): Pose => ({ target: [0, 0, (low + high) / 2], distance, azimuth: HOME.azimuth, polar });
    let [near, far] = [0.05 * (w + l), 20 * (w + l)];
    for (let k = 0; k < 40; k++) {
      const middle = Math.sqrt(near * far);
      this.setCamera(pose(middle));
      const corners = [-w / 2, w / 2].flatMap((x) => [-l / 2, l / 2].flatMap((y) => [low, high].map((z) => [x, y, z] as Vec)));
      const seen = corners.every((each) => this.sees(each));
      [near, far] = seen ? [near, middle] : [middle, far];
    }
    this.setCamera(this.pose);
    return pose(far);
  }

  private sees(point: Vec): boolean {
    const { x, y, z } = new Vector3(...point).project(this.camera);
    const { top, right, bottom } = this.covered;
    return Math.abs(x + right) < MARGIN * (1 - right) && Math.abs(y + top - bottom) < MARGIN * (1 - top - bottom) && z < 1;
  }

  private clampDistance(distance: number): number {
    const size = Math.max(...this.size);
    return Math.min(Math.max(distance, 0.02 * size), 20 * size);
  }

  private halfField(): number {
    return (FIELD_DEG * Math.PI) / 360;
  }

  private place(): void {
    this.setCamera(this.pose);
    this.onChange();
  }

  private setCamera({ target, distance, azimuth, polar }: Pose): void {
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
