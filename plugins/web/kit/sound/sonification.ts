/** Sound of a stroke, from the material's own figures; numbers alone, no sound is made here. */
import type { Material } from "../server/messages";
import type { Vec } from "../server/protocol";

/** A voice of the synthesizer: frequency, level (root mean square, of full scale), and quality of a band of noise. */
export interface Voice {
  hz: number;
  level: number;
  q: number;
}

export interface Stroke {
  noise: Voice;
  tone: Voice;
  /** True for a creak: friction that sticks and slips. */
  creaks: boolean;
}

/** Greatest level before the volume. */
export const MAX_LEVEL = 0.25;
const BAND_HZ = { least: 50, most: 6000 };
/** A stroke at full level: 0.1 mm, 2 N, 0.1 m/s, 1 N of drag. */
const FULL = { roughness_m: 1e-4, force_n: 2, speed_m_per_s: 0.1, drag_n: 1 };
/** Exponent of loudness over power (Stevens). */
const EXPONENT = 0.6;
const SILENT: Voice = { hz: BAND_HZ.least, level: 0, q: 1 };

const clamp = (value: number, least: number, most: number): number => Math.min(most, Math.max(least, value));
const loudness = (share: number): number => MAX_LEVEL * clamp(share, 0, 1) ** EXPONENT;

/** Return grains met per second: none along the lines of a material, speed over grain across them. */
export function grains_hz(material: Material, velocity: Vec): number {
  const [vx, vy] = velocity;
  const angle = (material.direction_deg * Math.PI) / 180;
  const across = Math.abs(vy * Math.cos(angle) - vx * Math.sin(angle));
  const share = material.texture === "smooth" ? 0 : material.anisotropy;
  return (share * across + (1 - share) * Math.hypot(vx, vy)) / material.grain_m;
}

/** Return the sound of a stroke; silent at rest, without force, and on smooth materials. */
export function stroke(material: Material | null, force: Vec, velocity: Vec): Stroke {
  const silent = { noise: SILENT, tone: SILENT, creaks: false };
  const speed = Math.hypot(velocity[0], velocity[1]);
  const force_n = Math.hypot(...force);
  if (!material || !(speed > 0) || !(force_n > 0)) return silent;
  const rate = grains_hz(material, velocity);
  const hz = clamp(rate, BAND_HZ.least, BAND_HZ.most);
  const push = (force_n / FULL.force_n) * Math.min(1, speed / FULL.speed_m_per_s);
  const moved = rate > 0 ? push : 0;
  const rough = (material.roughness_m / FULL.roughness_m) * moved;
  const sticks = material.texture === "stick-slip" ? (material.static_friction - material.dynamic_friction) * moved : 0;
  const drags = (material.drag_n_s_per_m * speed) / FULL.drag_n;
  const periodic = material.texture === "periodic";
  const noises: Voice = periodic
    ? { hz, level: loudness(rough * (0.1 + 0.9 * material.irregularity)), q: 8 }
    : { hz, level: loudness(rough), q: 0.9 };
  return {
    noise: drags > rough ? { hz: 180, level: loudness(drags), q: 0.7 } : noises,
    tone: { hz, level: loudness(periodic ? rough : sticks), q: 1 },
    creaks: material.texture === "stick-slip",
  };
}

/** Return a tap: harder materials sound higher and shorter, faster contacts louder. */
export function tap(material: Material | null, velocity: Vec): { hz: number; level: number; seconds: number } {
  const hardness = Math.sqrt((material?.stiffness_n_per_m ?? 300) / 300);
  return {
    hz: clamp(140 * hardness, 60, 900),
    level: clamp(0.06 + 2 * Math.abs(velocity[2]), 0.06, MAX_LEVEL),
    seconds: clamp(0.09 / hardness, 0.03, 0.15),
  };
}

const LOWEST_HZ = 220;
const OCTAVES = 2;

/** Return the pitch of a height: two octaves from the lowest place to the highest. A flat surface has the lowest. */
export function pitch_hz(height_m: number, [low, high]: readonly [number, number]): number {
  const share = high > low ? clamp((height_m - low) / (high - low), 0, 1) : 0;
  return LOWEST_HZ * 2 ** (OCTAVES * share);
}

/** Return the level of the force's tone, relative to 8 N. */
export function force_level(force_n: number): number {
  return 0.5 * loudness(force_n / 8);
}

/** Return the stereo position: -1 at the left rim, 1 at the right. */
export function pan(x_m: number, width_m: number): number {
  return width_m > 0 ? clamp((2 * x_m) / width_m, -1, 1) : 0;
}

/** Return the gain that brings a band of noise to its level. Noise between -1 and 1 has 1/sqrt(3). */
export function makeup({ hz, q }: Voice, rate_hz: number): number {
  const band = (Math.PI / 2) * (hz / q);
  return Math.sqrt(3) / Math.sqrt(clamp(band / (rate_hz / 2), 1e-3, 1));
}
