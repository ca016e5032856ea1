/** The way of the contact in the last seconds: broad and bright where the force was great. */
import {
  BufferAttribute,
  DynamicDrawUsage,
  InstancedBufferGeometry,
  InstancedInterleavedBuffer,
  InterleavedBufferAttribute,
  Mesh,
  ShaderMaterial,
  Vector2,
} from "three";
import type { State, Vec } from "../protocol";
import type { View } from "../view";
import type { Live } from "./live";
import type { Piece, Sight } from "./piece";
import { SECONDS, type Settings } from "./settings";
import { STRIDE, Trail } from "./trail";
import { length, minus } from "./vectors";

const HZ = 60;
const GREAT_N = 4;
/** No hand moves that far between two states: it was put down elsewhere, or is being let go. */
const LEAP_M = 0.02;

const vertexShader = `
attribute vec4 from, to; attribute vec2 fromMore, toMore;
uniform vec2 canvas; uniform float now, seconds; varying float force, age;
void main() {
  vec4 a = projectionMatrix * modelViewMatrix * vec4(from.xyz, 1.), b = projectionMatrix * modelViewMatrix * vec4(to.xyz, 1.);
  bool whole = toMore.y > .5 && toMore.x > fromMore.x && now - fromMore.x < seconds && a.w > 0. && b.w > 0.;
  if (!whole) { gl_Position = vec4(2., 2., 2., 1.); return; }
  vec2 way = (b.xy / b.w - a.xy / a.w) * canvas;
  way = length(way) > 1e-4 ? normalize(way) : vec2(1., 0.);
  force = clamp((position.y > .5 ? to.w : from.w) / ${GREAT_N.toFixed(1)}, 0., 1.);
  age = (now - (position.y > .5 ? toMore.x : fromMore.x)) / seconds;
  float half_width = .6 + 3.4 * force;
  gl_Position = position.y > .5 ? b : a;
  gl_Position.xy += (vec2(-way.y, way.x) * position.x * half_width) / canvas * 2. * gl_Position.w;
  gl_Position.z -= 4e-4 * gl_Position.w;
}`;
const fragmentShader = `
varying float force, age;
void main() { gl_FragColor = vec4(mix(vec3(.75, .9, 1.), vec3(1., .62, .1), force), (1. - age) * (.45 + .55 * force)); }`;

export class Trace implements Piece {
  private trail = new Trail(SECONDS.most * HZ + HZ);
  private buffer = new InstancedInterleavedBuffer(this.trail.data, STRIDE);
  private geometry = new InstancedBufferGeometry();
  private uniforms = { canvas: { value: new Vector2(1, 1) }, now: { value: 0 }, seconds: { value: SECONDS.first as number } };
  private mesh: Mesh;
  private last: State | null = null;
  private lastMs = -Infinity;
  private at: Vec = [0, 0, 0];

  constructor(view: View) {
    this.buffer.setUsage(DynamicDrawUsage);
    for (const [name, slot] of [["from", 0], ["to", 1]] as const) {
      this.geometry.setAttribute(name, new InterleavedBufferAttribute(this.buffer, 4, slot * STRIDE));
      this.geometry.setAttribute(`${name}More`, new InterleavedBufferAttribute(this.buffer, 2, slot * STRIDE + 4));
    }
    this.geometry.setAttribute("position", new BufferAttribute(new Float32Array([-1, 0, 0, 1, 0, 0, -1, 1, 0, 1, 1, 0]), 3));
    this.geometry.setIndex([0, 1, 2, 2, 1, 3]);
    const { uniforms } = this;
    const paint = { vertexShader, fragmentShader, uniforms, transparent: true, depthWrite: false, side: 2 } as const;
    this.mesh = new Mesh(this.geometry, new ShaderMaterial(paint));
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 5;
    view.overlay(this.mesh);
  }

  /** Forget the way: another surface is shown. */
  clear(): void {
    this.trail.clear();
    this.buffer.needsUpdate = true;
  }

  put(live: Live | null, { show, seconds }: Settings, sight: Sight): void {
    if (live) this.add(live);
    else this.trail.lift();
    this.mesh.visible = show.trace && this.trail.added > 1;
    this.uniforms.canvas.value.set(sight.width, sight.height);
    this.uniforms.now.value = performance.now() / 1000;
    this.uniforms.seconds.value = seconds;
    this.geometry.instanceCount = Math.min(this.trail.added, this.trail.slots);
  }

  /** Whether some of it has yet to fade. */
  fades(seconds: number): boolean {
    return this.mesh.visible && performance.now() - this.lastMs < 1000 * seconds;
  }

  /** A frame may show a state again, from elsewhere. */
  private add({ state, contact, hand, touching, newtons }: Live): void {
    if (state === this.last) return;
    this.last = state;
    this.lastMs = performance.now();
    const at = touching ? contact : hand;
    if (length(minus(at, this.at)) > LEAP_M) this.trail.lift();
    this.at = at;
    this.trail.add(at[0], at[1], at[2], touching ? newtons : 0, this.lastMs / 1000);
    this.buffer.needsUpdate = true;
  }
}
