/** A page that was sent: one file with a picture to explore, without a program behind it and without a network. */
import "kit/style/tokens.css";
import "kit/style/ground.css";
import "kit/style/controls.css";
import "kit/style/preferences.css";
import "./send.css";
import { Themes, colour } from "kit/themes";
import { attachFingers } from "kit/hand/fingers";
import { attachGamePad } from "kit/hand/game_pad";
import { Hand } from "kit/hand/hand";
import { attachKeyboard } from "kit/hand/keyboard";
import { attachMouse } from "kit/hand/mouse";
import { Hub } from "kit/hub";
import { measure } from "kit/instrumentation";
import { Overlay } from "kit/overlay/overlay";
import type { Page } from "kit/page";
import { listen, on } from "kit/shortcuts";
import { Sound } from "kit/sound/sound";
import { Narrator } from "kit/speech/narrator";
import { voiceOf } from "kit/speech/voice";
import { Frames } from "kit/view/frames";
import { DEFAULTS } from "kit/view/settings";
import { View } from "kit/view/view";
import { language } from "kit/words/words";
import { describe, keyTable, partList, switches } from "./controls";
import { readData, unpack, type Packed } from "./data";
import { drawFlat } from "./flat_picture";
import { LocalServer } from "./local_server";
import { Shaking } from "kit/shaking";
import { ProxyLaw } from "./touch/law";
import { t } from "./words";

const UNSEEN = { device: false, arrow: false, cone: false, labels: false, limits: false };

const element = <T extends HTMLElement>(id: string): T => document.getElementById(id) as T;
const now_s = (): number => Date.now() / 1000;

async function open(data: Packed): Promise<void> {
  const { scene, spline, row } = await unpack(data);
  const canvas = element<HTMLCanvasElement>("terrain");
  const hub = new Hub();
  const { speech, announcer } = voiceOf(hub, element("said"), element("alerted"));
  const view = new View(canvas);
  const law = new ProxyLaw(spline, row);
  const sound = new Sound(hub, () => page.scene);
  const page: Page = {
    hub, view, canvas, speech, sound,
    net: new LocalServer(hub, law),
    overlay: new Overlay(view, canvas),
    scene: null, hand: null, narration: null, document: null, replayed: null,
    themes: new Themes(hub),
    idle: Promise.resolve(),
    say: (text, how) => announcer.say(text, how),
    forget: (topic) => announcer.forget(topic),
  };
  Object.assign(page.overlay.settings.show, UNSEEN); // these explain a force law, not a picture
  measure(page);
  listen(canvas);
  page.narration = new Narrator(page);
  const hand = (page.hand = new Hand(page));
  for (const attach of [attachMouse, attachFingers, attachKeyboard, attachGamePad]) attach(hand, page);
  const shaking = new Shaking(page, sound);
  on("stop", () => hand.stop());
  const ground = (): void => void (view.ground = colour("--ground"));
  hub.on("theme", ground);
  ground();
  drawFlat(page);
  new Frames(page);

  page.scene = scene;
  const looks = [...(scene.photo ? ["photo"] : []), "relief", "height", ...(scene.meta.labels > 1 ? ["segments"] : [])];
  hub.on("shown", () => {
    view.put(scene, { ...DEFAULTS, look: looks[0]! });
    if (matchMedia("(pointer: coarse)").matches) view.eye.top(); // for a finger, as wide as the screen
  });
  const digest = scene.meta.digest;
  hub.tell("described", { event: "described", at_s: now_s(), digest, says: data.says });
  hub.tell("loop", { event: "loop", at_s: now_s(), running: true, why: "", own_hand: true });
  hub.tell("holding", { event: "holding", at_s: now_s(), holding: true, free: false });
  hub.tell("shown", scene);
  switches(page, element("controls"), shaking, looks, (look) => {
    view.terrain?.show({ ...DEFAULTS, look }, null);
    view.dirty = true;
  });
  partList(page, element("parts"));
  Object.assign(window, { tangible: { page, law } }); // for tests and measurements
}

/** Put the page's own texts into its language. */
function greet({ meta }: Packed): void {
  document.documentElement.lang = language;
  element("skip").textContent = t("skip");
  element("how").textContent = t("how");
  element("terrain").ariaLabel = meta.name ? t("pictureOf", { title: meta.name }) : t("picture");
  keyTable(element<HTMLDetailsElement>("help"));
}

const data = readData();
greet(data);
describe(data, element("description"));
open(data).catch((error: Error) => (element("alerted").textContent = t("unreadable", { why: error.message })));
