/** All panels, in the order in which they stand. */
import type { Panel } from "../panel";
import { description } from "./description";
import { devices } from "./devices";
import { handOn } from "./export";
import { hand } from "./hand";
import { help } from "./help";
import { laws } from "./laws";
import { legible } from "./legible";
import { log } from "./log";
import { mapping } from "./mapping";
import { materials } from "./materials";
import { methods } from "./methods";
import { open } from "./open";
import { overlay } from "./overlay";
import { parts } from "./parts";
import { preflight } from "./preflight";
import { records } from "./records";
import { ruler } from "./ruler";
import { settings } from "./settings";
import { sound } from "./sound";
import { stages } from "./stages";
import { view } from "./view";
import { yaml } from "./yaml";

/** Left: what is made. Right: what is seen, heard and felt, settings and help last. Bottom: the log. */
export const panels: Panel[] = [
  open, methods, stages, parts, materials, preflight, legible, description, handOn, yaml,
  view, overlay, ruler, mapping, hand, devices, sound, laws, records, settings, help,
  log,
];
