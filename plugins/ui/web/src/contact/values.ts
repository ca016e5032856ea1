/** The values of the data cursor: as rows of words, as text, and as JSON. */
import type { Vec } from "../server/protocol";
import { t } from "../overlay/words";
import { LIMITS } from "./limits";
import type { Live, Place } from "./reading";

/** A name, and one value or three. */
export type Row = [name: string, ...values: string[]];

const NONE = "–";
const MM = 1000;

/** A number of fixed width after the point; never a minus before zero. */
export function fixed(value: number, digits: number): string {
  if (!Number.isFinite(value)) return NONE;
  const text = value.toFixed(digits);
  return Number(text) === 0 ? text.replace("-", "") : text.replace("-", "−");
}

const mm = (at: Vec | null): string[] => (at ? at.map((part) => fixed(MM * part, 2)) : [NONE, NONE, NONE]);

export function rows(live: Live | null, pointer: Place | null): Row[] {
  const held = live?.seen ? live : null;
  const found: Row[] = [
    [`${t("row_device")}, mm`, ...mm(held && held.hand)],
    [`${t("row_proxy")}, mm`, ...mm(held && held.proxy)],
    [`${t("row_contact")}, mm`, ...mm(held?.touching ? held.contact : null)],
    [`${t("row_pointer")}, mm`, ...mm(pointer && pointer.at)],
    [`${t("row_normal")}`, ...(held ?? pointer)?.normal.map((part) => fixed(part, 3)) ?? [NONE, NONE, NONE]],
    [`${t("row_force")}, N`, ...(held ? held.state.force.map((part) => fixed(part, 3)) : [NONE, NONE, NONE])],
    [t("row_magnitude"), held ? `${fixed(held.newtons, 3)} N` : NONE],
    [t("row_collision"), held ? (held.depthM > 0 || held.touching ? t("yes", { mm: fixed(MM * held.depthM, 3) }) : t("no")) : NONE],
    [t("row_surface"), `${fixed(MM * (held?.surfaceM ?? pointer?.at[2] ?? NaN), 2)} mm`],
    [t("row_material"), made(held ?? pointer)],
    [t("row_grip"), held ? `${t(held.grip)}, ${fixed(MM * held.speedMPerS, 0)} mm/s` : NONE],
    [t("row_limits"), held ? limitsOf(held).map((word) => t(word)).join(", ") || t("none") : NONE],
  ];
  if (held && held.otherN > 0) found.splice(7, 0, [t("row_other"), `${fixed(held.otherN, 3)} N`]);
  return found;
}

function made(at: Pick<Live, "material" | "part" | "name"> | null): string {
  if (!at || at.part === null) return NONE;
  if (at.name) return at.material ? `${at.name}, ${at.material.name}` : at.name;
  return at.material ? t("part", { name: at.material.name, number: at.part }) : t("noMaterial", { number: at.part });
}

const limitsOf = (live: Live) => LIMITS.filter(({ bit }) => live.state.flags & bit).map(({ word }) => word);

export const asText = (found: Row[]): string => found.map(([name, ...values]) => `${name}\t${values.join("\t")}`).join("\n");

/** Metres, newtons, metres per second. */
export function asJson(live: Live | null, pointer: Place | null): string {
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
