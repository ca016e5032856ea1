/** Trace of the contact in the last seconds: broad and bright where the force was great. */
import { BufferGeometry, DataTexture, FloatType, Mesh, RGBAFormat, ShaderMaterial, Vector2 } from "three";
import type { State, Vec } from "../../server/protocol";
import type { View } from "../../view/view";
import type { Reading } from "../../contact/reading";
import type { Piece, Sight } from "../piece";
import { SECONDS, type Settings } from "../settings";
import { STRIDE, TraceSamples } from "./trace_samples";
import { length, minus } from "../../contact/vectors";

const HZ = 60;
const GREAT_N = 4;
/** Distance between two states from which the trace is interrupted: the hand was put down elsewhere. */
const LEAP_M = 0.02;
/** Vertices between two samples: two triangles. */
const VERTICES = 6;

/** Vertex shader that reads samples from a texture by vertex number, so that lines need no instances. */
const vertexShader = `
uniform sampler2D samples; uniform vec2 canvas; uniform float now, seconds; uniform int first, slots;
varying float force, age;
void main() {
  int slot = (first + gl_VertexID / ${VERTICES}) % slots, corner = gl_VertexID % ${VERTICES};
  vec4 from = texelFetch(samples, ivec2(0, slot), 0), to = texelFetch(samples, ivec2(0, slot + 1), 0);
  float began = texelFetch(samples, ivec2(1, slot), 0).x;
  vec2 ended = texelFetch(samples, ivec2(1, slot + 1), 0).xy;
  vec4 a = projectionMatrix * modelViewMatrix * vec4(from.xyz, 1.), b = projectionMatrix * modelViewMatrix * vec4(to.xyz, 1.);
  if (ended.y < .5 || ended.x <= began || now - began > seconds || a.w <= 0. || b.w <= 0.) {
    gl_Position = vec4(2., 2., 2., 1.);
    return;
  }
  vec2 way = (b.xy / b.w - a.xy / a.w) * canvas;
  way = length(way) > 1e-4 ? normalize(way) : vec2(1., 0.);
  bool far = corner == 2 || corner == 3 || corner == 5;
  float side = corner == 1 || corner == 4 || corner == 5 ? 1. : -1.;
  force = clamp((far ? to.w : from.w) / ${GREAT_N.toFixed(1)}, 0., 1.);
  age = clamp((now - (far ? ended.x : began)) / seconds, 0., 1.);
  gl_Position = far ? b : a;
  gl_Position.xy += vec2(-way.y, way.x) * side * (.6 + 3.4 * force) / canvas * 2. * gl_Position.w;
  gl_Position.z -= 4e-4 * gl_Position.w;
}`;
const fragmentShader = `
varying float force, age;
void main() { gl_FragColor = vec4(mix(vec3(.75, .9, 1.), vec3(1., .62, .1), force), (1. - age) * (.45 + .55 * force)); }`;

export class Trace implements Piece {
  private trail = new TraceSamples(SECONDS.most * HZ + HZ);
  private samples = new DataTexture(this.trail.data, STRIDE / 4, this.trail.slots + 1, RGBAFormat, FloatType);
  private geometry = new BufferGeometry();
  private uniforms = {
    samples: { value: this.samples },
    canvas: { value: new Vector2(1, 1) },
    now: { value: 0 },
    seconds: { value: SECONDS.first as number },
    first: { value: 0 },
    slots: { value: this.trail.slots },
  };
  private mesh: Mesh;
  private last: State | null = null;
  /** Time of the last movement. */
  private movedMs = -Infinity;
  private at: Vec = [0, 0, 0];

  constructor(view: View) {
    const { uniforms } = this;
    const paint = { vertexShader, fragmentShader, uniforms, transparent: true, depthWrite: false, side: 2 } as const;
    this.mesh = new Mesh(this.geometry, new ShaderMaterial(paint));
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 5;
    view.overlay(this.mesh);
  }

  /** Clear the trace: another surface is shown. */
  clear(): void {
    this.trail.clear();
    this.samples.needsUpdate = true;
  }

  put(live: Reading | null, { show, seconds }: Settings, sight: Sight): void {
    if (live) this.add(live);
    else this.trail.lift();
    const now = performance.now() / 1000;
    const shown = this.trail.since(now - seconds);
    this.mesh.visible = show.trace && shown > 1;
    this.uniforms.canvas.value.set(sight.width, sight.height);
    this.uniforms.now.value = now;
    this.uniforms.seconds.value = seconds;
    this.uniforms.first.value = (this.trail.newest + this.trail.slots + 1 - shown) % this.trail.slots;
    this.geometry.setDrawRange(0, VERTICES * Math.max(0, shown - 1));
  }

  /** Return whether part of the trace has yet to fade. */
  fades(seconds: number): boolean {
    return this.mesh.visible && performance.now() - this.movedMs < 1000 * seconds;
  }

  /** Add a reading; a frame may show the same state again from another camera. */
  private add({ state, contact, hand, touching, newtons }: Reading): void {
    if (state === this.last) return;
    this.last = state;
    const nowMs = performance.now();
    const at = touching ? contact : hand;
    const moved = length(minus(at, this.at));
    if (moved > LEAP_M) this.trail.lift();
    if (moved > 0) this.movedMs = nowMs;
    this.at = at;
    this.trail.add(at[0], at[1], at[2], touching ? newtons : 0, nowMs / 1000);
    this.samples.needsUpdate = true;
  }
}
