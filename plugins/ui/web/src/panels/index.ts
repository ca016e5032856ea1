/** All panels, in the order in which they stand. */
import type { Panel } from "../panel";
import { log } from "./log";
import { mapping } from "./mapping";
import { methods } from "./methods";
import { overlay } from "./overlay";
import { ruler } from "./ruler";
import { view } from "./view";

export const panels: Panel[] = [methods, view, overlay, ruler, mapping, log];
