/** The built-in panels, in their order. */
import { devices } from "./devices/panel";
import { hand } from "./hand/panel";
import { help } from "./help/panel";
import { laws } from "./laws/panel";
import { lazy } from "./lazy";
import { log } from "./log/panel";
import { mapping } from "./mapping/panel";
import { materials } from "./materials/panel";
import { methods } from "./methods/panel";
import { open } from "./open/panel";
import { overlay } from "./overlay/panel";
import type { Panel } from "./panel";
import { parts } from "./parts/panel";
import { preflight } from "./preflight/panel";
import { recordings } from "./recordings/panel";
import { ruler } from "./ruler/panel";
import { settings } from "./settings/panel";
import { sound } from "./sound/panel";
import { stages } from "./stages/panel";
import { view } from "./view/panel";
import { t } from "./words";
import { yaml } from "./yaml/panel";
import "./description/description.css";
import "./export/export.css";
import "./legibility/legibility.css";

/** Left: the pipeline. */
const LEFT: Panel[] = [
  open, methods, stages, parts, materials, preflight,
  lazy({ id: "legible", title: t("legible"), place: "left", open: false }, () => import("./legibility/panel")),
  lazy({ id: "description", title: t("description"), place: "left", open: false }, () => import("./description/panel")),
  lazy({ id: "export", title: t("export"), place: "left", open: false }, () => import("./export/panel")),
  yaml,
];
/** Right: view, sound and touch; settings and help last. */
const RIGHT: Panel[] = [view, overlay, ruler, mapping, hand, devices, sound, laws, recordings, settings, help];
const BOTTOM: Panel[] = [log];

export const panels: Panel[] = [...LEFT, ...RIGHT, ...BOTTOM];
