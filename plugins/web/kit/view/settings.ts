/** Settings of drawing, kept in the browser. */
import { recall, remember as keep } from "../preferences";
import { STEEPS } from "../terrain/shader";
import type { Looks } from "../terrain/terrain";

export interface Settings extends Looks {
  eyeDome: number;
  /** Width of the magnified square, millimetres; 0 without magnifier. */
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

/** Bounds of numbers. */
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

/** Return kept settings as far as they are valid. */
export function checkSettings(kept: unknown): Settings {
  const args: Record<string, unknown> = { ...DEFAULTS };
  if (typeof kept !== "object" || kept === null) return { ...DEFAULTS };
  for (const [name, value] of Object.entries(kept)) {
    const bounds = BOUNDS[name as keyof Settings];
    if (bounds && typeof value === "number" && value >= bounds[0] && value <= bounds[1]) args[name] = value;
  }
  const { look, steep } = kept as Partial<Settings>;
  if (typeof look === "string") args.look = look;
  if (typeof steep === "string" && Object.hasOwn(STEEPS, steep)) args.steep = steep;
  return args as unknown as Settings;
}

export function recallSettings(): Settings {
  try {
    return checkSettings(JSON.parse(recall(KEPT, "null")));
  } catch {
    return { ...DEFAULTS }; // a foreign value
  }
}

export function rememberSettings(settings: Settings): void {
  keep(KEPT, JSON.stringify(settings));
}
