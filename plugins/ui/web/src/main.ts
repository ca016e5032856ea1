/** The page: its parts are put together here. */
import "./app.css";
import { frame } from "./frame";
import { Frames } from "./frames";
import { Hand } from "./hand";
import { Hub } from "./hub";
import { Net } from "./net";
import { Overlay } from "./overlay/overlay";
import type { Page } from "./page";
import { build } from "./panel";
import { panels } from "./panels";
import { dataCursor } from "./panels/cursor";
import { Scene } from "./scene";
import { listen } from "./shortcuts";
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
const speech = new Speech(element("said"));
const view = new View(canvas);
const page: Page = {
  hub,
  net: new Net(hub),
  view,
  overlay: new Overlay(view, canvas),
  canvas,
  scene: null,
  document: null,
  replayed: null,
  say: (text) => speech.say(text),
};

hub.on("hello", ({ history, scene }) => {
  for (const each of history) hub.tell(each.event, each as never);
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

frame(page, new Themes(hub));
splits();
listen(canvas);
new Status(page);
new Hand(page);
build(page, panels);
dataCursor(page);
new Frames(page, asked.has("measure"));
