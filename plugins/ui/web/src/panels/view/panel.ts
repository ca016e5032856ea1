/** Settings of the view: light, steep walls, magnifier and camera. The strip below the surface has what it shows. */
import "./view.css";
import { fieldset, labelled, make, slider } from "kit/elements";
import { CAMERA_KEYS, type CameraAct } from "kit/view/camera_input";
import { Magnifier } from "kit/view/magnifier";
import type { Page } from "kit/page";
import type { Panel } from "../panel";
import { COARSEST, DENSITIES } from "kit/terrain/needles";
import { Refiner } from "kit/surface/refinement";
import { STEEPS } from "kit/terrain/shader";
import { BOUNDS, type Settings } from "kit/view/settings";
import { looksOf, Look } from "kit/view/look";
import { lookChoice } from "kit/view/look_choice";
import { colour } from "kit/themes";
import { t } from "kit/view/words";

type Word = Parameters<typeof t>[0];
const LENSES_MM = [0, 5, 10, 20];

function build(page: Page, root: HTMLElement): void {
  const showing = new Look(page);
  const lens = new Magnifier(page, showing.settings);
  new Refiner(page);
  const set = (changes: Partial<Settings>): void => {
    showing.set(changes);
    lens.change();
  };
  const controls = controlsOf(showing.settings, set);
  const cover = controls.control("cover", "cover", 0.05, percent);
  lookChoice(page, showing, (look) => set({ look }));
  page.hub.on("look", ({ look }) => (cover.hidden = look === "photo" || !page.scene?.meta.photo));
  root.append(cover, ...controls.boxes, camera(page));
  page.hub.on("shown", () => showing.begin());
  page.hub.on("look at", ({ look }) => page.scene && looksOf(page.scene.meta).includes(look) && set({ look }));
  const grounded = (): void => void (page.view.ground = colour("--ground"));
  page.hub.on("theme", grounded);
  grounded();
}

type Slider = (name: keyof Settings, word: Word, step: number, say: (value: number) => string) => HTMLElement;
const percent = (value: number): string => `${Math.round(100 * value)} %`;
const degrees = (value: number): string => `${value}°`;

function controlsOf(settings: Settings, set: (changes: Partial<Settings>) => void) {
  const control: Slider = (name, word, step, say) => {
    const input = document.createElement("input");
    const value = document.createElement("output");
    input.type = "range";
    input.id = `view-${name}`;
    [input.min, input.max] = BOUNDS[name]!.map(String);
    input.step = String(step);
    input.value = String(settings[name]);
    const said = (): void => {
      value.textContent = say(input.valueAsNumber);
      input.ariaValueText = value.textContent;
    };
    input.oninput = () => {
      said();
      set({ [name]: input.valueAsNumber });
    };
    said();
    return slider(t(word), input, value);
  };
  const light = fieldset(t("light"));
  const hint = make("small", { textContent: t("eyeDomeSays") });
  light.append(
    control("raking", "raking", 0.05, percent),
    control("azimuthDeg", "azimuth", 5, degrees),
    control("elevationDeg", "elevation", 5, degrees),
    control("eyeDome", "eyeDome", 0.05, percent),
    hint,
  );
  const curtains = fieldset(t("curtains"));
  for (const steep of Object.keys(STEEPS) as (keyof typeof STEEPS)[])
    curtains.append(radio("steep", steep, steep, () => set({ steep }), settings.steep === steep));
  curtains.append(control("steepDeg", "steeper", 1, degrees));
  const normals = control("normals", "normals", 1, density);
  return { control, boxes: [light, curtains, normals, magnifier(settings, set)] };
}

function density(value: number): string {
  if (value === 0) return t("none");
  return value >= DENSITIES ? t("everyCell") : t("across", { count: COARSEST * 2 ** value });
}

function magnifier(settings: Settings, set: (changes: Partial<Settings>) => void): HTMLElement {
  const label = document.createElement("label");
  const choice = make("select", { id: "lens-choice" });
  for (const mm of LENSES_MM) choice.append(new Option(mm ? `${mm} mm` : t("off"), String(mm), false, mm === settings.lensMm));
  choice.onchange = () => set({ lensMm: Number(choice.value) });
  label.append(t("lens"), choice);
  return label;
}

/** Return buttons and keys of the camera. */
function camera(page: Page): HTMLElement {
  const box = fieldset(t("camera"));
  const buttons = make("div", { className: "buttons" });
  const { eye } = page.view;
  const does: [Word, CameraAct, () => void][] = [
    ["home", "home", () => eye.home()],
    ["top", "top", () => eye.top()],
    ["nearer", "zoom", () => eye.zoom(0.7)],
    ["farther", "zoom", () => eye.zoom(1 / 0.7)],
  ];
  for (const [word, act, move] of does) {
    const button = make("button", { type: "button", textContent: t(word) });
    button.onclick = () => {
      move();
      page.view.acted(act);
    };
    buttons.append(button);
  }
  box.append(buttons, keys());
  return box;
}

function keys(): HTMLElement {
  const box = document.createElement("details");
  const heading = make("summary", { textContent: t("keys") });
  const table = document.createElement("table");
  const first = table.createTHead().insertRow();
  for (const word of ["todo", "keyboard", "mouse"] as const) {
    const cell = make("th", { scope: "col", textContent: t(word) });
    first.append(cell);
  }
  const body = table.createTBody();
  for (const { keys, does } of CAMERA_KEYS) {
    const row = body.insertRow();
    row.insertCell().textContent = t(does);
    const cell = row.insertCell();
    for (const each of keys) {
      const key = make("kbd", { textContent: each });
      cell.append(key, " ");
    }
    row.insertCell().textContent = t(`${does}Mouse`);
  }
  const hint = make("small", { textContent: t("keysSay") });
  box.append(heading, table, hint);
  return box;
}

function radio(name: string, value: string, word: Word, chosen: () => void, checked = false): HTMLElement {
  const input = make("input", { type: "radio", name, value, checked, onchange: chosen });
  return labelled(input, t(word));
}

export const view: Panel = { id: "view", title: t("title"), task: "advanced", open: true, build };
