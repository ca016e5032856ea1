/** How the surface is drawn, kept from one visit to the next where the browser allows it. */
import { recall, remember as keep } from "../preferences";
import { STEEPS } from "../terrain/shader";
import type { Looks } from "../terrain/terrain";

export interface Settings extends Looks {
  eyeDome: number;
  /** Width of what the magnifier shows, millimetres; 0 without one. */
  lensMm: number;
}

const KEPT = "view";

export const DEFAULTS: Settings = {
  look: "photo",
  cover: 1,
  steep: "grey",
  steepDeg: 80,
  azimuthDeg: 315,
  elevationDeg: 35,
  raking: 0.65,
  normals: 0,
  eyeDome: 0.3,
  lensMm: 0,
};

/** From to: what a number may be. */
export const BOUNDS: Partial<Record<keyof Settings, [number, number]>> = {
  cover: [0, 1],
  steepDeg: [45, 89],
  azimuthDeg: [0, 360],
  elevationDeg: [5, 90],
  raking: [0, 1],
  normals: [0, 8],
  eyeDome: [0, 1],
  lensMm: [0, 20],
};

/** What was kept, as far as it makes sense. */
export function checked(kept: unknown): Settings {
  const found: Record<string, unknown> = { ...DEFAULTS };
  if (typeof kept !== "object" || kept === null) return { ...DEFAULTS };
  for (const [name, value] of Object.entries(kept)) {
    const bounds = BOUNDS[name as keyof Settings];
    if (bounds && typeof value === "number" && value >= bounds[0] && value <= bounds[1]) found[name] = value;
  }
  const { look, steep } = kept as Partial<Settings>;
  if (typeof look === "string") found.look = look;
  if (typeof steep === "string" && Object.hasOwn(STEEPS, steep)) found.steep = steep;
  return found as unknown as Settings;
}

export function remembered(): Settings {
  try {
    return checked(JSON.parse(recall(KEPT, "null")));
  } catch {
    return { ...DEFAULTS }; // not ours
  }
}

export function remember(settings: Settings): void {
  keep(KEPT, JSON.stringify(settings));
}
