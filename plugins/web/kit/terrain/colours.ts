/** Colours and patterns, shared by drawing and legend. */

/** Viridis (Smith & van der Walt, CC0): lightness grows with the value, also in grey and with colour blindness. */
// prettier-ignore
const VIRIDIS = (
  "440154 470d60 48186a 482374 472d7b 453781 424086 3e4989 3b528b 375b8d 33638d 2f6b8e 2c728e 297a8e 26828e 23898e 21918c " +
  "1f988b 1fa088 22a785 28ae80 32b67a 3fbc73 4ec36b 5ec962 70cf57 84d44b 98d83e addc30 c2df23 d8e219 ece51b fde725"
).split(" ").map(rgb);

/** Eight colours that are distinct with any colour vision (Okabe & Ito), the darkest ones lightened. */
export const PALETTE = "e69f00 56b4e9 009e73 f0e442 4a86c8 d55e00 cc79a7 a6a6a6".split(" ").map(rgb);

/** Number of patterns over the colours, so that no kind depends on its colour alone. */
export const PATTERNS = 8;
const MARK = 0.5;

export type Colour = [number, number, number];

function rgb(hex: string): Colour {
  return [0, 2, 4].map((at) => parseInt(hex.slice(at, at + 2), 16)) as Colour;
}

/** Return the colour of a value, 0 the lowest and 1 the highest; 0 to 255 each. */
export function heat(share: number): Colour {
  const at = Math.min(Math.max(share, 0), 1) * (VIRIDIS.length - 1);
  const low = Math.min(Math.floor(at), VIRIDIS.length - 2);
  return VIRIDIS[low].map((part, k) => part + (at - low) * (VIRIDIS[low + 1][k] - part)) as Colour;
}

/** Return the colour map as 256 texels. */
export function heatTexels(): Uint8Array {
  return Uint8Array.from({ length: 256 * 4 }, (_, k) => (k % 4 === 3 ? 255 : Math.round(heat((k >> 2) / 255)[k % 4])));
}

/** Return colour and pattern of a kind: 64 combinations. */
export function styleOf(kind: number): { colour: Colour; pattern: number } {
  return { colour: PALETTE[kind % 8], pattern: (kind + Math.floor(kind / 8)) % PATTERNS };
}

/** Return whether the pattern marks a place; its period is 1. The counterpart of `marked` in the shader. */
export function isMarked(pattern: number, x: number, y: number): boolean {
  const part = (value: number): number => value - Math.floor(value);
  const [u, v] = [part(x), part(y)];
  return [
    false,
    v > 0.75,
    u > 0.75,
    part(x + y) > 0.75,
    part(x - y) > 0.75,
    Math.hypot(u - 0.5, v - 0.5) < 0.25,
    u > 0.8 || v > 0.8,
    u < 0.5 !== v < 0.5,
  ][pattern];
}

export function darken(colour: Colour): Colour {
  return colour.map((part) => MARK * part) as Colour;
}

const glsl = ([r, g, b]: Colour): string => `vec3(${[r, g, b].map((part) => (part / 255).toFixed(5)).join(", ")})`;

export const COLOURS_GLSL = `
const vec3 palette[8] = vec3[8](${PALETTE.map(glsl).join(", ")});
bool marked(int pattern, vec2 q) {
  vec2 f = fract(q);
  if (pattern == 1) return f.y > .75;
  if (pattern == 2) return f.x > .75;
  if (pattern == 3) return fract(q.x + q.y) > .75;
  if (pattern == 4) return fract(q.x - q.y) > .75;
  if (pattern == 5) return length(f - .5) < .25;
  if (pattern == 6) return f.x > .8 || f.y > .8;
  if (pattern == 7) return (f.x < .5) != (f.y < .5);
  return false;
}
vec3 styled(uint kind, vec2 q) {
  vec3 base = palette[kind % 8u];
  return marked(int((kind + kind / 8u) % ${PATTERNS}u), q) ? base * ${MARK.toFixed(2)} : base;
}
vec3 hatched(vec3 base, vec2 q) { return fract(q.x + q.y) > .5 ? base * .7 : base; }`;
