/** All panels, in the order in which they stand. */
import type { Panel } from "../panel";
import { devices } from "./devices";
import { hand } from "./hand";
import { log } from "./log";
import { open } from "./open";
import { yaml } from "./yaml";
import { methods } from "./methods";
import { records } from "./records";
import { view } from "./view";

export const panels: Panel[] = [open, methods, yaml, view, hand, devices, records, log];
