/** A participant's page: questions with their answers, and a pad on which surfaces are felt and heard, without any picture.
 *
 * It has the hand, the sounds and the vibration of the page of `tangible ui`, but no terrain and no narration: names of
 * parts and materials, heights and forces would tell conditions apart. */
import "kit/style/tokens.css";
import "./study.css";
import { attachGamePad } from "kit/hand/game_pad";
import { Hand } from "kit/hand/hand";
import { attachKeyboard } from "kit/hand/keyboard";
import { findPartCentres } from "kit/hand/part_centres";
import { Hub } from "kit/hub";
import { Shaking } from "kit/shaking";
import { Connection } from "kit/server/connection";
import { isTouching } from "kit/server/protocol";
import { Sound, VOICES, type VoiceName } from "kit/sound/sound";
import type { Scene } from "kit/surface/scene";
import { attachPad } from "./pad";
import { Questions, type StudyEvents, type Told } from "./questions";
import { fetchSurface } from "./surfaces";
import { t } from "./words";

const element = <T extends HTMLElement>(id: string): T => document.getElementById(id) as T;
const now_s = (): number => Date.now() / 1000;

const hub = new Hub<StudyEvents>();
const net = new Connection(hub);
const pad = element("pad");
const said = element("said");
const sound = new Sound(hub, () => page.scene);
const page = {
  hub,
  net,
  scene: null as Scene | null,
  document: null,
  canvas: pad as HTMLCanvasElement, // only its keys are listened to
  say: (text: string | (() => string)): void => void (said.textContent = typeof text === "string" ? text : text()),
};
const hand = new Hand(page);
attachKeyboard(hand, page);
attachGamePad(hand);
attachPad(hand, pad, () => page.scene);
new Shaking(page, sound);
let touched = false;
hub.on("state", (state) => {
  if (!page.scene || isTouching(state) === touched) return;
  touched = !touched;
  page.say(t(touched ? "touching" : "lifted"));
});

let newest = 0;

/** Put a surface under the hand, or take it away. */
async function feel({ surface, sounds, lead }: Told): Promise<void> {
  newest = surface ?? 0;
  hand.release();
  page.scene = null;
  said.textContent = "";
  touched = false;
  pad.hidden = !surface;
  if (!surface) return;
  const scene = await fetchSurface(net, surface).catch(() => null); // the program is gone
  if (!scene || newest !== surface) return;
  for (const each of Object.keys(VOICES)) sound.let(each as VoiceName, sounds?.includes(each) ?? true);
  const [w, l] = scene.meta.extent_m;
  pad.style.aspectRatio = `${w} / ${l}`;
  page.scene = scene;
  hub.tell("shown", scene);
  const place = findPartCentres((x, y) => scene.label(x, y), scene.meta.extent_m).find(({ label }) => label === lead);
  if (place) hand.leadTo(...place.at);
  pad.focus();
}

/** Sounds begin with the participant's first key or tap: browsers allow none before. */
function wake(): void {
  for (const type of ["keydown", "pointerdown"]) document.removeEventListener(type, wake);
  if (!sound.on) void sound.toggle();
}
for (const type of ["keydown", "pointerdown"]) document.addEventListener(type, wake);

const questions = new Questions(
  { log: element("log"), answers: element("answers"), aloud: element<HTMLInputElement>("aloud") },
  net,
  (told) => void feel(told),
);
hub.on("hello", ({ history }) => {
  hub.tell("loop", { event: "loop", at_s: now_s(), running: true, why: "", own_hand: true });
  hub.tell("holding", { event: "holding", at_s: now_s(), holding: true, free: false });
  questions.takeAll(history as unknown as Told[]);
});
hub.on("said", (told) => questions.takeAll([told]));
hub.on("ended", () => net.leave());
hub.on("gone", () => questions.lose());
hub.on("state", ({ seq }) => net.drawn(seq)); // nothing is drawn that would take time
const stop = (): void => void net.stop().catch(() => undefined);
document.title = document.querySelector("h1")!.textContent = t("study");
element("answers").ariaLabel = t("answers");
pad.ariaLabel = t("pad");
for (const id of ["how", "stop", "leave"] as const) element(id).textContent = t(id);
element("aloud-words").textContent = t("aloud");
element("stop").addEventListener("click", stop);
element("leave").addEventListener("click", () => {
  stop();
  questions.leave();
});
document.addEventListener("keydown", ({ key }) => key === "Escape" && stop(), { capture: true });
