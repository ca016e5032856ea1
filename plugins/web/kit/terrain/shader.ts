/** Shaders that colour and light a surface. */
import { COLOURS_GLSL } from "./colours";

/** Looks of the surface; a layer of the server's values is one more, `values`. */
export const LOOKS = { photo: 0, height: 1, materials: 2, segments: 3, relief: 4, slope: 5, values: 6 } as const;
export const STEEPS = { shown: 0, grey: 1, cut: 2 } as const;

/** Vertex shader: vertices are the cells' centres and a ring on the rim; the index determines the cell. */
export const VERTEX = `
precision highp float; precision highp sampler2D;
uniform mat4 modelViewMatrix, projectionMatrix; uniform sampler2D heights;
uniform vec4 place, extent;
out vec3 at;
void main() {
  ivec2 s = textureSize(heights, 0), g = ivec2(gl_VertexID % (s.x + 2), gl_VertexID / (s.x + 2)) - 1;
  float z = texelFetch(heights, clamp(g, ivec2(0), s - 1), 0).r;
  vec2 p = place.xy + (vec2(g) + .5) * place.zw * vec2(1., -1.);
  at = vec3(clamp(p, -.5 * extent.xy, .5 * extent.xy), z);
  gl_Position = projectionMatrix * modelViewMatrix * vec4(at, 1.);
}`;

export const FRAGMENT = `
precision highp float; precision highp sampler2D; precision highp usampler2D;
uniform sampler2D gradient, photo, values, heat, fine; uniform usampler2D labels, kinds;
uniform vec4 place, extent, photoPlace, hole, finePlace; uniform vec3 key; uniform vec2 span;
uniform float raking, steep, cover, period; uniform int look, cut; uniform bool labelled, pictured;
in vec3 at; out vec4 colour;
${COLOURS_GLSL}
vec3 linear(vec3 c) { return pow(c, vec3(2.2)); }
uint labelAt(vec2 cell) {
  ivec2 s = textureSize(labels, 0);
  return texelFetch(labels, clamp(ivec2(floor(cell)), ivec2(0), s - 1), 0).r;
}
uint kindOf(uint label) {
  int w = textureSize(kinds, 0).x;
  return texelFetch(kinds, ivec2(int(label) % w, int(label) / w), 0).r;
}
/** Slopes of the fine texture, where they are known. */
vec2 fineSlope() {
  ivec2 s = textureSize(fine, 0);
  vec2 q = ((at.xy - finePlace.xy) * vec2(1., -1.) / finePlace.z + .5) * vec2(s) - .5;
  if (finePlace.z <= 0. || min(q.x, q.y) < 1. || q.x > float(s.x - 3) || q.y > float(s.y - 3)) return vec2(0.);
  ivec2 c = ivec2(q); vec2 f = fract(q);
  float a = texelFetch(fine, c, 0).r, b = texelFetch(fine, c + ivec2(1, 0), 0).r;
  float d = texelFetch(fine, c + ivec2(0, 1), 0).r, e = texelFetch(fine, c + ivec2(1, 1), 0).r;
  return vec2(mix(b - a, e - d, f.y), -mix(d - a, e - b, f.x)) * float(s.x) / finePlace.z;
}
vec3 toned(float share) { return texture(heat, vec2((clamp(share, 0., 1.) * 255. + .5) / 256., .5)).rgb; }
void main() {
  if (at.x > hole.x && at.y > hole.y && at.x < hole.z && at.y < hole.w) discard;
  vec3 face = cross(dFdx(at), dFdy(at));
  bool wall = length(face.xy) > steep * abs(face.z);
  if (wall && cut == ${STEEPS.cut}) discard;
  vec2 cell = (at.xy - place.xy) * vec2(1., -1.) / place.zw;
  vec2 slope = texture(gradient, cell / vec2(textureSize(gradient, 0))).rg;
  vec2 uv = at.xy * vec2(1., -1.) / extent.xy + .5, q = at.xy / period;
  vec3 picture = pictured ? texture(photo, (at.xy - photoPlace.xy) * vec2(1., -1.) / photoPlace.zw).rgb : linear(vec3(.72));
  vec3 base = picture;
  bool layered = true;
  if (look == ${LOOKS.photo}) layered = false;
  else if (look == ${LOOKS.relief}) base = linear(vec3(.72));
  else if (look == ${LOOKS.height}) base = linear(toned((at.z - span.x) / max(span.y - span.x, 1e-12)));
  else if (look == ${LOOKS.slope}) base = linear(toned(degrees(atan(length(slope))) / 90.));
  else if (look == ${LOOKS.values}) {
    ivec2 s = textureSize(values, 0);
    float value = texelFetch(values, clamp(ivec2(uv * vec2(s)), ivec2(0), s - 1), 0).r;
    bool known = value == value;
    base = linear(known ? toned((value - span.x) / max(span.y - span.x, 1e-12)) : hatched(vec3(.45), q));
  } else if (labelled) {
    uint label = labelAt(cell);
    base = linear(styled(look == ${LOOKS.materials} ? kindOf(label) : label, q));
    vec2 e = fwidth(cell) * .7;
    bool rim = labelAt(cell + vec2(e.x, 0.)) != label || labelAt(cell - vec2(e.x, 0.)) != label
            || labelAt(cell + vec2(0., e.y)) != label || labelAt(cell - vec2(0., e.y)) != label;
    if (rim) base = vec3(.01);
  } else base = linear(hatched(vec3(.45), q));
  if (layered) base = mix(picture, base, cover);
  if (wall && cut == ${STEEPS.grey}) base = linear(hatched(vec3(.32), gl_FragCoord.xy / 8.));
  vec3 m = normalize(vec3(-slope - fineSlope(), 1.));
  float sky = .55 + .45 * m.z, rake = max(dot(m, key), 0.);
  vec3 light = mix(vec3(1.), sky * vec3(.42, .46, .55) + rake * vec3(1.25, 1.12, .95), raking);
  colour = vec4(pow(base * light, vec3(1. / 2.2)), 1.);
}`;
