/** Eye-dome shading: what lies before something else gets a dark rim, by the depth alone (Boucheny 2009). */
import { AlwaysDepth, GLSL3, Mesh, PlaneGeometry, RawShaderMaterial, type PerspectiveCamera, type Texture } from "three";

const REACH_PX = 1.6;
const STRENGTH = 60;

export const FULL_SCREEN = `
precision highp float; in vec3 position;
void main() { gl_Position = vec4(position.xy, 0., 1.); }`;

/** Something drawn over the whole of what is drawn on. */
export function screen(fragmentShader: string, uniforms: Record<string, { value: unknown }>): Mesh<PlaneGeometry, RawShaderMaterial> {
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
  readonly quad = screen(
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
  colour = vec4(texelFetch(colours, ivec2(p), 0).rgb * exp(-strength * sum / 8.), 1.);
}`,
    this.uniforms,
  );

  /** Shade what was drawn from this camera; strength 0 leaves it as it is. */
  of(colours: Texture, depths: Texture, camera: PerspectiveCamera, strength: number, ratio: number): Mesh {
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
