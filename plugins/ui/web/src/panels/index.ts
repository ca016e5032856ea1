/** All panels, in the order in which they stand. */
import type { Panel } from "../panel";
import { log } from "./log";
import { mapping } from "./mapping";
import { open } from "./open";
import { yaml } from "./yaml";
import { methods } from "./methods";
import { overlay } from "./overlay";
import { records } from "./records";
import { ruler } from "./ruler";
import { view } from "./view";

export const panels: Panel[] = [open, methods, yaml, view, overlay, ruler, mapping, records, log];
