/** All panels, in the order in which they stand. */
import type { Panel } from "./panel";
import { description } from "./description";
import { devices } from "./devices/panel";
import { handOn } from "./export";
import { hand } from "./hand/panel";
import { help } from "./help/panel";
import { laws } from "./laws/panel";
import { legible } from "./legible";
import { log } from "./log/panel";
import { mapping } from "./mapping/panel";
import { materials } from "./materials/panel";
import { methods } from "./methods/panel";
import { open } from "./open/panel";
import { overlay } from "./overlay/panel";
import { parts } from "./parts/panel";
import { preflight } from "./preflight/panel";
import { records } from "./recordings/panel";
import { ruler } from "./ruler/panel";
import { settings } from "./settings/panel";
import { sound } from "./sound/panel";
import { stages } from "./stages/panel";
import { view } from "./view/panel";
import { yaml } from "./yaml/panel";

/** Left: what is made. Right: what is seen, heard and felt, settings and help last. Bottom: the log. */
export const panels: Panel[] = [
  open, methods, stages, parts, materials, preflight, legible, description, handOn, yaml,
  view, overlay, ruler, mapping, hand, devices, sound, laws, records, settings, help,
  log,
];
