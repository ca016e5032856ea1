/** Placement of the picture under the hand; the counterpart of tangible_core/mapping/placement.py and options.py. */
import type { Vec } from "../../server/protocol";

/** The `mapping` block of a document with all defaults. */
export interface Mapping {
  scale: number | null;
  /** Centre x and y, width, length. */
  region_m: [number, number, number, number] | null;
  rotation_deg: number;
  offset_m: Vec;
}

/** Placement: the picture's point s lies under the hand at h = o + k R (s - c). */
export interface Placement {
  scale: number;
  cos: number;
  sin: number;
  centre: [number, number];
  offset: Vec;
}

const MIN_SCALE = 1e-3;
const MAX_SCALE = 1e3;
const FARTHEST_M = 10;
export const IDENTITY: Mapping = { scale: null, region_m: null, rotation_deg: 0, offset_m: [0, 0, 0] };

/** Return cosine and sine; exact for quarter turns. */
export function cosAndSin(degrees: number): [number, number] {
  const quarters = degrees / 90;
  if (!Number.isInteger(quarters)) return [Math.cos((degrees * Math.PI) / 180), Math.sin((degrees * Math.PI) / 180)];
  const exact: [number, number][] = [[1, 0], [0, 1], [-1, 0], [0, -1]];
  return exact[((quarters % 4) + 4) % 4];
}

export function placement(mapping: Mapping, workspace: Vec): Placement {
  const [cos, sin] = cosAndSin(mapping.rotation_deg);
  const [x, y, width, length] = mapping.region_m ?? [0, 0, 0, 0];
  let scale = mapping.scale ?? 1;
  if (mapping.region_m && mapping.scale === null) {
    const across = Math.abs(cos) * width + Math.abs(sin) * length;
    const along = Math.abs(sin) * width + Math.abs(cos) * length;
    scale = Math.min(workspace[0] / across, workspace[1] / along);
  }
  return { scale, cos, sin, centre: [x, y], offset: mapping.offset_m };
}

/** Return the place of the picture under a place of the hand. */
export function toPicture(to: Placement, hand: Vec): Vec {
  const [x, y, z] = [hand[0] - to.offset[0], hand[1] - to.offset[1], hand[2] - to.offset[2]];
  return [
    to.centre[0] + (to.cos * x + to.sin * y) / to.scale,
    to.centre[1] + (to.cos * y - to.sin * x) / to.scale,
    z / to.scale,
  ];
}

/** The device's reach in the picture: a rectangle. */
export interface Reach {
  centre: [number, number];
  /** Size along its own sides. */
  size: [number, number];
  /** Angle, counter-clockwise seen from above; the opposite of the picture's turn under the hand. */
  turnDeg: number;
}

export function reachOf(mapping: Mapping, workspace: Vec): Reach {
  const to = placement(mapping, workspace);
  const [x, y] = toPicture(to, [0, 0, 0]);
  return {
    centre: [x, y],
    size: [workspace[0] / to.scale, workspace[1] / to.scale],
    turnDeg: -mapping.rotation_deg,
  };
}

/** Return the corners of a rectangle, counter-clockwise from the near left one. */
export function corners({ centre, size, turnDeg }: Reach): [number, number][] {
  const [cos, sin] = cosAndSin(turnDeg);
  return [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([u, v]) => {
    const [x, y] = [(u * size[0]) / 2, (v * size[1]) / 2];
    return [centre[0] + cos * x - sin * y, centre[1] + sin * x + cos * y];
  });
}

/** Return the mapping with its rectangle moved to another centre, enlarged by a factor, and turned.
 *
 * A region moves and grows with it. Without one, the offset moves the picture. */
export function movePlacement(mapping: Mapping, workspace: Vec, centre: [number, number], larger: number, turnDeg: number): Mapping {
  const before = placement(mapping, workspace);
  const old = reachOf(mapping, workspace);
  const region = mapping.region_m && growRegion(mapping.region_m, old.centre, centre, larger);
  const rotation_deg = roundTo(wrapDegrees(-turnDeg), 2);
  const scale = region && mapping.scale === null ? null : roundTo(within(before.scale / larger), 5);
  const asked = { scale, region_m: region, rotation_deg, offset_m: mapping.offset_m };
  const to = placement(asked, workspace);
  const [x, y] = [to.centre[0] - centre[0], to.centre[1] - centre[1]];
  const offset = [to.scale * (to.cos * x - to.sin * y), to.scale * (to.sin * x + to.cos * y)].map(clampOffset);
  return { ...asked, offset_m: [offset[0], offset[1], mapping.offset_m[2]] };
}

function growRegion(
  [x, y, width, length]: [number, number, number, number], from: [number, number], to: [number, number], larger: number,
): [number, number, number, number] {
  return [x + to[0] - from[0], y + to[1] - from[1], width * larger, length * larger].map((part) => roundTo(part, 5)) as [
    number, number, number, number,
  ];
}

/** Return the mapping of a region, as large as the device's workspace. */
export function zoomTo(mapping: Mapping, x: number, y: number, width: number, length: number): Mapping {
  const region_m = [x, y, width, length].map((part) => roundTo(part, 5)) as [number, number, number, number];
  return { ...mapping, scale: null, region_m, offset_m: [0, 0, mapping.offset_m[2]] };
}

/** Return the mapping of the whole picture; a turn stays. */
export function wholePicture(mapping: Mapping): Mapping {
  return { ...mapping, scale: null, region_m: null, offset_m: [0, 0, mapping.offset_m[2]] };
}

const within = (scale: number): number => Math.min(MAX_SCALE, Math.max(MIN_SCALE, scale));
const clampOffset = (part: number): number => roundTo(Math.min(FARTHEST_M, Math.max(-FARTHEST_M, part)), 5);
const wrapDegrees = (degrees: number): number => degrees - 360 * Math.round(degrees / 360);

/** Round to some digits after the point, or to three significant ones if the value is smaller. */
function roundTo(value: number, digits: number): number {
  const fixed = Number(value.toFixed(digits));
  return Math.abs(value) < 10 ** (2 - digits) ? Number(value.toPrecision(3)) : fixed + 0;
}
