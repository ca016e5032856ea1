/** Values of the data cursor: as rows of words, as text, and as JSON. */
import type { Vec } from "../server/protocol";
import { t } from "../overlay/words";
import { materialWord } from "../words/material_words";
import { shownNumber } from "../words/part_words";
import { notation } from "../words/words";
import { LIMITS } from "./limits";
import type { Reading, SurfacePlace } from "./reading";

/** A row: a name, and one value or three. */
export type Row = [name: string, ...values: string[]];

const NONE = "–";
const MM = 1000;

/** Return a number with fixed digits; never a minus before zero. */
export function formatFixed(value: number, digits: number): string {
  if (!Number.isFinite(value)) return NONE;
  const text = notation(value.toFixed(digits));
  return Number(value.toFixed(digits)) === 0 ? text.replace("-", "") : text.replace("-", "−");
}

const mm = (at: Vec | null): string[] => (at ? at.map((part) => formatFixed(MM * part, 2)) : [NONE, NONE, NONE]);

export function rows(live: Reading | null, pointer: SurfacePlace | null): Row[] {
  const held = live?.seen ? live : null;
  const table: Row[] = [
    [`${t("row_device")}, mm`, ...mm(held && held.hand)],
    [`${t("row_proxy")}, mm`, ...mm(held && held.proxy)],
    [`${t("row_contact")}, mm`, ...mm(held?.touching ? held.contact : null)],
    [`${t("row_pointer")}, mm`, ...mm(pointer && pointer.at)],
    [`${t("row_normal")}`, ...(held ?? pointer)?.normal.map((part) => formatFixed(part, 3)) ?? [NONE, NONE, NONE]],
    [`${t("row_force")}, N`, ...(held ? held.state.force.map((part) => formatFixed(part, 3)) : [NONE, NONE, NONE])],
    [t("row_magnitude"), held ? `${formatFixed(held.newtons, 3)} N` : NONE],
    [t("row_collision"), held ? (held.depthM > 0 || held.touching ? t("yes", { mm: formatFixed(MM * held.depthM, 3) }) : t("no")) : NONE],
    [t("row_surface"), `${formatFixed(MM * (held?.surfaceM ?? pointer?.at[2] ?? NaN), 2)} mm`],
    [t("row_material"), materialName(held ?? pointer)],
    [t("row_grip"), held ? `${t(held.grip)}, ${formatFixed(MM * held.speedMPerS, 0)} mm/s` : NONE],
    [t("row_limits"), held ? limitsOf(held).map((word) => t(word)).join(", ") || t("none") : NONE],
  ];
  if (held && held.otherN > 0) table.splice(7, 0, [t("row_other"), `${formatFixed(held.otherN, 3)} N`]);
  return table;
}

/** Return force, material and height: what a person asks first. */
export function shortRows(live: Reading | null, pointer: SurfacePlace | null): Row[] {
  const held = live?.seen ? live : null;
  const at = held ?? pointer;
  const height = held?.surfaceM ?? pointer?.at[2] ?? NaN;
  return [
    [t("row_force"), held ? `${formatFixed(held.newtons, 2)} N` : NONE],
    [t("row_material"), at?.material ? materialWord(at.material.name) : NONE],
    [t("row_height"), Number.isFinite(height) ? `${formatFixed(MM * height, 1)} mm` : NONE],
  ];
}

function materialName(at: Pick<Reading, "material" | "part" | "name"> | null): string {
  if (!at || at.part === null) return NONE;
  const material = at.material && materialWord(at.material.name);
  if (at.name) return material ? `${at.name}, ${material}` : at.name;
  const number = shownNumber(at.part);
  return material ? t("part", { name: material, number }) : t("noMaterial", { number });
}

const limitsOf = (live: Reading) => LIMITS.filter(({ bit }) => live.state.flags & bit).map(({ word }) => word);

export const asText = (table: Row[]): string => table.map(([name, ...values]) => `${name}\t${values.join("\t")}`).join("\n");

/** Return the values as JSON, in metres, newtons, metres per second. */
export function asJson(live: Reading | null, pointer: SurfacePlace | null): string {
  const held = live?.seen ? live : null;
  const place = pointer && { at_m: pointer.at, normal: pointer.normal, material: pointer.material?.name ?? null, part: pointer.part, part_name: pointer.name || null };
  const device = held && {
    position_m: held.hand,
    proxy_m: held.proxy,
    contact_m: held.touching ? held.contact : null,
    velocity_m_per_s: held.state.velocity,
    surface_m: finite(held.surfaceM),
    depth_m: held.depthM,
    touching: held.touching,
    normal: held.normal,
    force_n: held.state.force,
    magnitude_n: held.newtons,
    other_force_n: held.otherN > 0 ? held.state.other : null,
    material: held.material?.name ?? null,
    part: held.part,
    part_name: held.name || null,
    contact: held.grip,
    limits: LIMITS.filter(({ bit }) => held.state.flags & bit).map(({ name }) => name),
    at_ms: held.state.sampleMs,
  };
  return JSON.stringify({ device, pointer: place }, null, 2);
}

const finite = (value: number): number | null => (Number.isFinite(value) ? value : null);
