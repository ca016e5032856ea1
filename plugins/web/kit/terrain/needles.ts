/** Normals as needles, computed from the heights on the graphics card, so that many cost little. */
import { BufferGeometry, GLSL3, LineSegments, RawShaderMaterial, Vector2 } from "three";
import type { Sheet, Uniforms } from "./sheet";

/** Steps of the density: each doubles the number per side; 0 none, the last every cell. */
export const DENSITIES = 8;
export const COARSEST = 5;

const vertexShader = `
precision highp float; precision highp sampler2D;
uniform mat4 modelViewMatrix, projectionMatrix; uniform sampler2D heights, gradient;
uniform vec4 place; uniform vec2 count; uniform float length_m;
out float share;
void main() {
  int id = gl_VertexID / 2, n = int(count.x);
  ivec2 s = textureSize(heights, 0), c = ivec2((vec2(id % n, id / n) + .5) * vec2(s) / count);
  vec3 foot = vec3(place.xy + (vec2(c) + .5) * place.zw * vec2(1., -1.), texelFetch(heights, c, 0).r);
  vec3 normal = normalize(vec3(-texelFetch(gradient, c, 0).rg, 1.));
  share = float(gl_VertexID % 2);
  gl_Position = projectionMatrix * modelViewMatrix * vec4(foot + share * length_m * normal, 1.);
  gl_Position.z -= 2e-4 * gl_Position.w;
}`;
const fragmentShader = `
precision highp float; in float share; out vec4 colour;
void main() { colour = vec4(mix(vec3(.05, .12, .07), vec3(.62, 1., .66), share), 1.); }`;

export class Needles {
  readonly lines: LineSegments<BufferGeometry, RawShaderMaterial>;
  private count = new Vector2(1, 1);
  private length: { value: number } = { value: 0 };

  constructor(private sheet: Sheet) {
    const { heights, gradient, place } = sheet.own;
    const uniforms: Uniforms = { heights, gradient, place, count: { value: this.count }, length_m: this.length };
    const material = new RawShaderMaterial({ glslVersion: GLSL3, vertexShader, fragmentShader, uniforms });
    this.lines = new LineSegments(new BufferGeometry(), material);
    this.lines.frustumCulled = false;
    this.lines.visible = false;
  }

  /** Set the density: 0 none, DENSITIES one per cell. */
  set density(density: number) {
    const { rows, columns, place } = this.sheet.part.grid;
    const wide = density >= DENSITIES ? columns : Math.min(columns, COARSEST * 2 ** density);
    const long = Math.min(rows, Math.max(1, Math.round((wide * rows * place.dy) / (columns * place.dx))));
    this.count.set(wide, density >= DENSITIES ? rows : long);
    this.length.value = Math.max((0.6 * columns * place.dx) / wide, 0.004 * columns * place.dx);
    this.lines.geometry.setDrawRange(0, 2 * this.count.x * this.count.y);
    this.lines.visible = density > 0;
  }

  dispose(): void {
    this.lines.geometry.dispose();
    this.lines.material.dispose();
  }
}
