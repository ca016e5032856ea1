/** All panels, in the order in which they stand. */
import type { Panel } from "../panel";
import { help } from "./help";
import { log } from "./log";
import { methods } from "./methods";
import { open } from "./open";
import { records } from "./records";
import { settings } from "./settings";
import { sound } from "./sound";
import { view } from "./view";
import { yaml } from "./yaml";

/** Left: what is made. Right: what is seen, heard and felt, settings and help last. Bottom: the log. */
export const panels: Panel[] = [open, methods, yaml, view, sound, records, settings, help, log];
