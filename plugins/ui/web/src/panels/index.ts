/** All panels, in the order in which they stand. */
import type { Panel } from "../panel";
import { log } from "./log";
import { materials } from "./materials";
import { methods } from "./methods";
import { preflight } from "./preflight";
import { stages } from "./stages";
import { view } from "./view";

export const panels: Panel[] = [methods, stages, materials, preflight, view, log];
