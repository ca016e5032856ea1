/** The built-in panels, in their order. */
import { devices } from "./devices/panel";
import { found } from "./found/panel";
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
import { save } from "./save/panel";
import { settings } from "./settings/panel";
import { signs } from "./signs/panel";
import { sound } from "./sound/panel";
import { stages } from "./stages/panel";
import { view } from "./view/panel";
import { t } from "./words";
import { yaml } from "./yaml/panel";
import "./description/description.css";
import "./export/export.css";
import "./legibility/legibility.css";

/** The tasks, in which what is needed first stands first. */
const PICTURE: Panel[] = [
  open,
  found,
  lazy({ id: "networks", title: t("networks"), task: "picture", open: false }, () => import("./networks/panel")),
];
const PARTS: Panel[] = [parts, materials];
const FEEL: Panel[] = [hand, sound, devices, laws, recordings, signs];
const HAND_ON: Panel[] = [
  lazy({ id: "legible", title: t("legible"), task: "hand-on", open: false }, () => import("./legibility/panel")),
  lazy({ id: "description", title: t("description"), task: "hand-on", open: false }, () => import("./description/panel")),
  lazy({ id: "export", title: t("export"), task: "hand-on", open: true }, () => import("./export/panel")),
  save,
];
/** All settings. */
const ADVANCED: Panel[] = [methods, stages, preflight, view, overlay, ruler, mapping, yaml];
/** Below the panels of every task. */
const ANY: Panel[] = [settings, help];

export const panels: Panel[] = [...PICTURE, ...PARTS, ...FEEL, ...HAND_ON, ...ADVANCED, ...ANY, log];
