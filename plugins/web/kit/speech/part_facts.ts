/** The parts of a surface from near to far: what lies higher is nearer. */
import { findPartCentres } from "../hand/part_centres";
import type { Scene } from "../surface/scene";

export interface PartFacts {
  label: number;
  /** A place well inside the part. */
  at: [number, number];
  /** The mean height, metres. */
  heightM: number;
}

export function partsFromNearToFar(scene: Scene): PartFacts[] {
  const { grid, labels } = scene.whole;
  if (!labels) return [];
  const sums = new Float64Array(scene.meta.labels);
  const counts = new Float64Array(scene.meta.labels);
  labels.forEach((label, cell) => {
    sums[label] += grid.heights[cell]!;
    counts[label]++;
  });
  return findPartCentres((x, y) => scene.label(x, y), scene.meta.extent_m)
    .map((part) => ({ ...part, heightM: sums[part.label]! / counts[part.label]! || 0 }))
    .sort((a, b) => b.heightM - a.heightM || a.label - b.label);
}
