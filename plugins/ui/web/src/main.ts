/** Composition of the page: creates its parts and connects them. */
import "kit/style/tokens.css";
import "kit/style/ground.css";
import "./style/frame.css";
import "./style/surface.css";
import "./style/tasks.css";
import "./style/wide.css";
import "./style/panels.css";
import "kit/style/controls.css";
import "kit/style/preferences.css";
import { buildRegions } from "./frame/regions";
import { buildTasks } from "./frame/tasks";
import { Frames } from "kit/view/frames";
import { attachFingers } from "kit/hand/fingers";
import { attachGamePad } from "kit/hand/game_pad";
import { Hand } from "kit/hand/hand";
import { attachKeyboard } from "kit/hand/keyboard";
import { attachMouse } from "kit/hand/mouse";
import { Hub } from "kit/hub";
import { Instrument } from "kit/sound/synthesizer";
import { whenIdle } from "kit/server/idle";
import { measure, measuring } from "kit/instrumentation";
import { Narrator } from "kit/speech/narrator";
import { Connection } from "kit/server/connection";
import { showGraphicsTrouble } from "./frame/graphics_notice";
import { Overlay } from "kit/overlay/overlay";
import type { Page } from "kit/page";
import type { PluginPanel } from "kit/server/messages";
import { build } from "./panels/panel";
import { reportWrongFile } from "./notices/wrong_file";
import { showOpening } from "./start/opening";
import { warnOfNoDepth } from "./notices/no_depth";
import { offerToMake } from "./notices/pending";
import { panels } from "./panels";
import { findCommands } from "./palette/opener";
import { pluginPanel } from "./panels/plugins";
import { dataCursor } from "kit/contact/data_cursor";
import { listen } from "kit/shortcuts";
import { showHint } from "./start/hint";
import { stroke } from "kit/sound/sonification";
import { Sound } from "kit/sound/sound";
import { voiceOf } from "kit/speech/voice";
import { buildSplitters } from "./frame/splitters";
import { Status } from "./frame/status";
import { loadScene } from "kit/surface/loading";
import { recallSettings } from "kit/view/settings";
import { Themes } from "kit/themes";
import { View } from "kit/view/view";
import { language } from "kit/words/words";

document.documentElement.lang = language;
const element = <T extends HTMLElement>(id: string): T => document.getElementById(id) as T;

const canvas = element<HTMLCanvasElement>("terrain");
const hub = new Hub();
const { speech, announcer } = voiceOf(hub, element("said"), element("alerted"));
const net = new Connection(hub);
const view = new View(canvas);
const page: Page = {
  hub,
  net,
  view,
  overlay: new Overlay(view, canvas),
  canvas,
  scene: null,
  hand: null,
  narration: null,
  document: null,
  replayed: null,
  sound: new Sound(hub, () => page.scene),
  speech,
  themes: new Themes(hub),
  idle: whenIdle(hub),
  say: (text, how) => announcer.say(text, how),
  forget: (topic) => announcer.forget(topic),
};

measure(page);
hub.on("hello", ({ history, scene }) => {
  // after a lost connection, known messages are not announced again, and old ones not at all
  announcer.muted = true;
  const all = [...history, ...(scene ? [{ ...scene, event: "scene" as const }] : [])].sort((a, b) => a.at_s - b.at_s);
  for (const each of all) if (each.at_s > net.heard_s) hub.tell(each.event, each as never);
  announcer.muted = false;
});
const plugins = new Set<string>();
hub.on("maker", async () => {
  const brought = await net.ask<PluginPanel[]>("panels").catch(() => []);
  const fresh = brought.filter(({ name }) => !plugins.has(name)); // the worker may start again
  for (const { name } of fresh) plugins.add(name);
  build(page, fresh.map((each) => pluginPanel(each)));
});
hub.on("document", (said) => (page.document = said));
let newest = "";
hub.on("scene", async (meta) => {
  if (page.scene?.meta.digest === meta.digest && newest === meta.digest) return;
  newest = meta.digest;
  try {
    const loaded = await loadScene(meta);
    if (newest !== meta.digest) return; // a newer surface was computed meanwhile
    page.scene = loaded;
    hub.tell("shown", loaded);
  } catch (error) {
    hub.tell("error", { event: "error", at_s: Date.now() / 1000, text: (error as Error).message });
  }
});

buildTasks();
buildRegions(page);
buildSplitters();
listen(canvas);
new Status(page);
page.narration = new Narrator(page);
const hand = (page.hand = new Hand(page));
for (const attach of [attachMouse, attachFingers, attachKeyboard, attachGamePad]) attach(hand, page);
showGraphicsTrouble(page);
build(page, panels);
dataCursor(page);
warnOfNoDepth(page);
reportWrongFile(page);
offerToMake(page);
showHint(page);
findCommands(page);
showOpening(page);
hub.on("hello", ({ empty }) => empty && void import("./start/start").then(({ start }) => start(page)));
new Frames(page);
requestAnimationFrame(() => setTimeout(() => view.prepare(recallSettings()))); // after the first paint
if (measuring) Object.assign(window, { Instrument, stroke }); // for tests
