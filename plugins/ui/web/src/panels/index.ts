/** All panels, in the order in which they stand. */
import type { Panel } from "../panel";
import { help } from "./help";
import { log } from "./log";
import { methods } from "./methods";
import { settings } from "./settings";
import { sound } from "./sound";
import { view } from "./view";

export const panels: Panel[] = [methods, view, sound, settings, help, log];
