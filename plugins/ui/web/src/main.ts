/** The page: its parts are put together here. */
import "./app.css";
import { Announcer, regions } from "./announcer";
import { Cursors } from "./cursors";
import { frame } from "./frame";
import { Frames } from "./frames";
import { Hand } from "./hand";
import { Hub } from "./hub";
import { Narrator } from "./narrator";
import { Net } from "./net";
import type { Page } from "./page";
import { build } from "./panel";
import { panels } from "./panels";
import { Scene } from "./scene";
import { listen } from "./shortcuts";
import { Sound } from "./sound";
import { Speech } from "./speech";
import { splits } from "./splits";
import { Status } from "./status";
import { Themes } from "./themes";
import { View } from "./view";
import { language } from "./words/words";

document.documentElement.lang = language;
const element = <T extends HTMLElement>(id: string): T => document.getElementById(id) as T;
const asked = new URLSearchParams(location.search);
if (asked.has("measure")) document.body.classList.add("measure");

const canvas = element<HTMLCanvasElement>("terrain");
const hub = new Hub();
const speech = new Speech(hub);
const shown = regions(element("said"), element("alerted"));
const announcer = new Announcer((said) => {
  shown(said);
  speech.speak(said);
});
const net = new Net(hub);
const page: Page = {
  hub,
  net,
  view: new View(canvas),
  canvas,
  scene: null,
  document: null,
  replayed: null,
  sound: new Sound(hub, () => page.scene),
  speech,
  themes: new Themes(hub),
  say: (text, how) => announcer.say(text, how),
  forget: (topic) => announcer.forget(topic),
};

hub.on("hello", ({ history, scene }) => {
  // After a connection that was lost, what was heard before is not heard again; and what is long over is not said.
  announcer.hushed = true;
  for (const each of history) if (each.at_s > net.heard_s) hub.tell(each.event, each as never);
  announcer.hushed = false;
  if (scene) hub.tell("scene", scene);
});
hub.on("document", (said) => (page.document = said));
hub.on("scene", async (meta) => {
  if (page.scene?.meta.digest === meta.digest) return;
  const loaded = await Scene.load(meta);
  page.scene = loaded;
  page.view.put(loaded);
  hub.tell("shown", loaded);
});

frame(page);
splits();
listen(canvas);
new Status(page);
new Narrator(page);
new Hand(page);
new Cursors(page);
build(page, panels);
new Frames(page, asked.has("measure"));
