/** Eye-dome shading: dark rims at depth edges, light ones on a dark ground, from the depth alone (Boucheny 2009). */
import { AlwaysDepth, GLSL3, Mesh, PlaneGeometry, RawShaderMaterial, type PerspectiveCamera, type Texture } from "three";

const REACH_PX = 1.6;
const STRENGTH = 60;

export const FULL_SCREEN = `
precision highp float; in vec3 position;
void main() { gl_Position = vec4(position.xy, 0., 1.); }`;

/** Return a quad over the whole target. */
export function fullScreenQuad(fragmentShader: string, uniforms: Record<string, { value: unknown }>): Mesh<PlaneGeometry, RawShaderMaterial> {
  const material = new RawShaderMaterial({
    glslVersion: GLSL3,
    depthFunc: AlwaysDepth,
    vertexShader: FULL_SCREEN,
    fragmentShader,
    uniforms,
  });
  const quad = new Mesh(new PlaneGeometry(2, 2), material);
  quad.frustumCulled = false;
  return quad;
}

export class EyeDome {
  private uniforms = { colours: { value: null as Texture | null }, depths: { value: null as Texture | null }, near: { value: 0 }, far: { value: 1 }, strength: { value: 0 }, reach: { value: REACH_PX } };
  readonly quad = fullScreenQuad(
    `precision highp float; precision highp sampler2D;
uniform sampler2D colours, depths; uniform float near, far, strength, reach; out vec4 colour;
float away(vec2 p) {
  ivec2 s = textureSize(depths, 0);
  float d = texelFetch(depths, clamp(ivec2(p), ivec2(0), s - 1), 0).r;
  return log2(near * far / (far - d * (far - near)));
}
void main() {
  vec2 p = gl_FragCoord.xy; float here = away(p), sum = 0.;
  for (int k = 0; k < 8; k++) {
    float a = float(k) * .785398;
    sum += max(0., here - away(p + reach * vec2(cos(a), sin(a))));
  }
  vec3 base = texelFetch(colours, ivec2(p), 0).rgb;
  bool darkGround = texelFetch(depths, ivec2(p), 0).r == 1. && dot(base, vec3(1.)) < 1.5;
  colour = vec4(mix(vec3(darkGround ? .7 : 0.), base, exp(-strength * sum / 8.)), 1.);
}`,
    this.uniforms,
  );

  /** Return the quad that shades a rendered image; strength 0 leaves it as it is. */
  shade(colours: Texture, depths: Texture, camera: PerspectiveCamera, strength: number, ratio: number): Mesh {
    const { uniforms } = this;
    uniforms.colours.value = colours;
    uniforms.depths.value = depths;
    uniforms.reach.value = REACH_PX * ratio;
    uniforms.near.value = camera.near;
    uniforms.far.value = camera.far;
    uniforms.strength.value = STRENGTH * strength;
    return this.quad;
  }
}
