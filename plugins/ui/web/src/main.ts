/** The page: its parts are put together here. */
import "./app.css";
import { Announcer, regions } from "./speech/announcer";
import { frame } from "./frame/regions";
import { Frames } from "./view/frames";
import { Hand } from "./hand/hand";
import { Hub } from "./hub";
import { Instrument } from "./sound/synthesizer";
import { leisure } from "./server/idle";
import { measure, measuring } from "./instrumentation";
import { Narrator } from "./speech/narrator";
import { Net } from "./server/connection";
import { notice } from "./frame/graphics_notice";
import { Overlay } from "./overlay/overlay";
import type { Page } from "./page";
import { build } from "./panels/panel";
import { panels } from "./panels";
import { dataCursor } from "./contact/data_cursor";
import { listen } from "./shortcuts";
import { stroke } from "./sound/sonification";
import { Sound } from "./sound/sound";
import { Speech } from "./speech/speech";
import { splits } from "./frame/splitters";
import { Status } from "./frame/status";
import { loadScene } from "./surface/loading";
import { remembered } from "./view/settings";
import { Themes } from "./frame/themes";
import { View } from "./view/view";
import { language } from "./words/words";

document.documentElement.lang = language;
const element = <T extends HTMLElement>(id: string): T => document.getElementById(id) as T;

const canvas = element<HTMLCanvasElement>("terrain");
const hub = new Hub();
const speech = new Speech(hub);
const shown = regions(element("said"), element("alerted"));
const announcer = new Announcer((said) => {
  shown(said);
  speech.speak(said);
});
const net = new Net(hub);
const view = new View(canvas);
const page: Page = {
  hub,
  net,
  view,
  overlay: new Overlay(view, canvas),
  canvas,
  scene: null,
  hand: null,
  document: null,
  replayed: null,
  sound: new Sound(hub, () => page.scene),
  speech,
  themes: new Themes(hub),
  leisure: leisure(hub),
  say: (text, how) => announcer.say(text, how),
  forget: (topic) => announcer.forget(topic),
};

measure(page);
hub.on("hello", ({ history, scene }) => {
  // After a connection that was lost, what was heard before is not heard again; and what is long over is not said.
  announcer.hushed = true;
  const all = [...history, ...(scene ? [{ ...scene, event: "scene" as const }] : [])].sort((a, b) => a.at_s - b.at_s);
  for (const each of all) if (each.at_s > net.heard_s) hub.tell(each.event, each as never);
  announcer.hushed = false;
});
hub.on("document", (said) => (page.document = said));
let newest = "";
hub.on("scene", async (meta) => {
  if (page.scene?.meta.digest === meta.digest && newest === meta.digest) return;
  newest = meta.digest;
  try {
    const loaded = await loadScene(meta);
    if (newest !== meta.digest) return; // another one was made meanwhile
    page.scene = loaded;
    hub.tell("shown", loaded);
  } catch (error) {
    hub.tell("error", { event: "error", at_s: Date.now() / 1000, text: (error as Error).message });
  }
});

frame(page);
splits();
listen(canvas);
new Status(page);
new Narrator(page);
page.hand = new Hand(page);
notice(page);
build(page, panels);
dataCursor(page);
new Frames(page);
requestAnimationFrame(() => setTimeout(() => view.prepare(remembered()))); // once the page itself is to be seen
if (measuring) Object.assign(window, { Instrument, stroke }); // what tests look into
