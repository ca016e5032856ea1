/** The surface as it is drawn: a grid whose heights are a texture, lit by a raking light, curtains cut. */
import {
  BufferAttribute,
  BufferGeometry,
  DataTexture,
  FloatType,
  GLSL3,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  NearestFilter,
  RawShaderMaterial,
  RedFormat,
  RedIntegerFormat,
  SRGBColorSpace,
  Texture,
  UnsignedShortType,
  Vector2,
  Vector3,
  LinearMipmapLinearFilter,
} from "three";
import type { Scene } from "./scene";

export type Look = "photo" | "height" | "materials" | "relief";
export const LOOKS: Look[] = ["photo", "height", "materials", "relief"];

const vertexShader = `
precision highp float; precision highp sampler2D;
uniform mat4 modelViewMatrix, projectionMatrix; uniform sampler2D heights; uniform vec2 extent;
out vec2 uv; out float z; out vec3 n;
float at(ivec2 p, ivec2 s) { return texelFetch(heights, clamp(p, ivec2(0), s - 1), 0).r; }
void main() {
  ivec2 s = textureSize(heights, 0), p = ivec2(gl_VertexID % s.x, gl_VertexID / s.x);
  vec2 pitch = extent / vec2(s); z = at(p, s);
  n = vec3((at(p - ivec2(1, 0), s) - at(p + ivec2(1, 0), s)) / (2. * pitch.x), (at(p + ivec2(0, 1), s) - at(p - ivec2(0, 1), s)) / (2. * pitch.y), 1.);
  uv = (vec2(p) + .5) / vec2(s);
  gl_Position = projectionMatrix * modelViewMatrix * vec4((uv.x - .5) * extent.x, (.5 - uv.y) * extent.y, z, 1.);
}`;
const fragmentShader = `
precision highp float; precision highp usampler2D;
uniform sampler2D photo; uniform usampler2D labels; uniform vec3 key; uniform vec2 span; uniform float raking, steep, cut; uniform int look;
in vec2 uv; in float z; in vec3 n; out vec4 colour;
vec3 heat(float t) { return clamp(vec3(.28, .01, .33) + t * (vec3(-.6, 1.5, .75) + t * (vec3(1.6, -.9, -2.2) + t * vec3(-.3, .3, 1.2))), 0., 1.); }
vec3 hue(float h) { return clamp(abs(fract(h + vec3(0., .667, .333)) * 6. - 3.) - 1., 0., 1.); }
void main() {
  float slope = length(n.xy);
  if (slope > steep && cut > 1.5) discard;
  vec3 m = normalize(n), base = texture(photo, uv).rgb;
  if (look == 1) base = heat((z - span.x) / max(span.y - span.x, 1e-9));
  if (look == 2) base = mix(base, .25 + .6 * hue(fract(float(texelFetch(labels, ivec2(uv * vec2(textureSize(labels, 0))), 0).r) * .381966)), .75);
  if (look == 3) base = vec3(.55);
  if (slope > steep && cut > .5) base = vec3(.16) * (step(.5, fract((gl_FragCoord.x + gl_FragCoord.y) / 8.)) * .5 + .75);
  float sky = .55 + .45 * m.z, rake = max(dot(m, key), 0.);
  vec3 light = mix(vec3(1.), sky * vec3(.42, .46, .55) + rake * vec3(1.25, 1.12, .95), raking);
  colour = vec4(base * light, 1.);
}`;

export class Terrain {
  readonly mesh: Mesh<BufferGeometry, RawShaderMaterial>;
  readonly normals: LineSegments;

  constructor(scene: Scene) {
    const { rows, columns, extent_m, height_m } = scene.meta;
    const index = new Uint32Array((rows - 1) * (columns - 1) * 6);
    for (let j = 0, o = 0; j < rows - 1; j++)
      for (let i = 0; i < columns - 1; i++) {
        const a = j * columns + i,
          c = a + columns;
        index[o++] = a;
        index[o++] = c;
        index[o++] = a + 1;
        index[o++] = a + 1;
        index[o++] = c;
        index[o++] = c + 1;
      }
    const geometry = new BufferGeometry();
    geometry.setIndex(new BufferAttribute(index, 1));
    const heights = new DataTexture(scene.heights, columns, rows, RedFormat, FloatType);
    heights.minFilter = heights.magFilter = NearestFilter;
    heights.needsUpdate = true;
    const labels = new DataTexture(scene.labels, columns, rows, RedIntegerFormat, UnsignedShortType);
    labels.internalFormat = "R16UI";
    labels.unpackAlignment = 2;
    labels.minFilter = labels.magFilter = NearestFilter;
    labels.needsUpdate = true;
    const photo = new Texture(scene.photo ?? new ImageData(1, 1));
    photo.flipY = false;
    photo.colorSpace = SRGBColorSpace;
    photo.generateMipmaps = true;
    photo.minFilter = LinearMipmapLinearFilter;
    photo.needsUpdate = true;
    const material = new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader,
      fragmentShader,
      side: 2,
      uniforms: {
        heights: { value: heights },
        labels: { value: labels },
        photo: { value: photo },
        extent: { value: new Vector2(...extent_m) },
        span: { value: new Vector2(...height_m) },
        key: { value: new Vector3(0, 0, 1) },
        raking: { value: 1 },
        steep: { value: 6 },
        cut: { value: 1 },
        look: { value: 0 },
      },
    });
    this.mesh = new Mesh(geometry, material);
    this.mesh.frustumCulled = false;
    this.normals = normals(scene);
    this.light(315, 25);
  }

  light(azimuth: number, elevation: number) {
    const a = (azimuth * Math.PI) / 180,
      e = (elevation * Math.PI) / 180;
    this.set("key", new Vector3(Math.sin(a) * Math.cos(e), Math.cos(a) * Math.cos(e), Math.sin(e)));
  }
  look(name: Look) {
    this.set("look", LOOKS.indexOf(name));
  }
  set(name: string, value: unknown) {
    this.mesh.material.uniforms[name].value = value;
  }
  dispose() {
    const u = this.mesh.material.uniforms;
    for (const k of ["heights", "labels", "photo"]) u[k].value.dispose();
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
    this.normals.geometry.dispose();
  }
}

function normals(scene: Scene): LineSegments {
  const {
      rows,
      columns,
      extent_m: [w, l],
    } = scene.meta,
    step = Math.max(1, (columns / 48) | 0),
    length = 0.03 * w,
    ends: number[] = [];
  for (let j = step >> 1; j < rows; j += step)
    for (let i = step >> 1; i < columns; i += step) {
      const x = ((i + 0.5) / columns - 0.5) * w,
        y = (0.5 - (j + 0.5) / rows) * l,
        z = scene.height(x, y),
        n = scene.normal(x, y);
      ends.push(x, y, z, x + n[0] * length, y + n[1] * length, z + n[2] * length);
    }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(ends), 3));
  const lines = new LineSegments(geometry, new LineBasicMaterial({ color: 0x8ce99a }));
  lines.visible = false;
  return lines;
}
