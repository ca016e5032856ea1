/** Interfaces by which the parts of the page know one another; main.ts puts the parts behind them.
 *
 * A part takes as few of these as it uses, `Pick<Page, "hub" | "scene">`; a panel takes them all. No part imports the
 * class of another for its type: a test fails for a circle of imports. */
import type { Object3D, PerspectiveCamera } from "three";
import type { Reading } from "./contact/reading";
import type { Theme } from "./themes";
import type { HandState } from "./hand/state";
import type { Hub } from "./hub";
import type { Settings as OverlaySettings } from "./overlay/settings";
import type { Document } from "./server/messages";
import type { State, Vec } from "./server/protocol";
import type { VoiceName } from "./sound/sound";
import type { Announcement, Text } from "./speech/announcer";
import type { Layer } from "./surface/loading";
import type { Part, Scene } from "./surface/scene";
import type { FinePatch, Looks } from "./terrain/terrain";
import type { CameraAct } from "./view/camera_input";
import type { Edge } from "./view/free_part";
import type { Trouble } from "./view/view";

/** The program behind the page. */
export interface Server {
  /** The newest state of the force loop; null while there is none. */
  readonly latest: State | null;
  /** Send a request; rejects with the server's text if it is refused. */
  ask<T>(name: string, args?: Record<string, unknown>): Promise<T>;
  /** Take all force away, over the websocket and, if it hangs, by HTTP. */
  stop(): Promise<void>;
  /** Switch forces on again. */
  feel(): Promise<void>;
}

/** The hand's connection to the server. */
export interface Pointer {
  /** Send where the hand is wanted, metres, and which buttons are down. */
  point(hand: Vec, buttons: number): void;
  /** Let the device go: no force. */
  release(): void;
}

/** The camera: a way from the screen to the surface and back. */
export interface Sight {
  readonly camera: PerspectiveCamera;
  readonly eye: { readonly pose: { target: Vec }; home(): void; top(): void; zoom(factor: number): void };
  /** Return origin and direction of the ray through a place of the window. */
  ray(clientX: number, clientY: number): [Vec, Vec];
  /** Return where a point of the workspace is on the canvas, CSS pixels from its upper left corner. */
  toScreen(point: Vec): [number, number];
  /** Return the width of a pixel at the camera's target, metres. */
  pixel_m(): number;
  /** Show the whole of a surface of this size, metres. */
  frame(width_m: number, length_m: number): void;
  /** Show a region of this width, metres, from the camera's present side. */
  focus(centre: Vec, width_m: number): void;
  /** Zoom in by this share of the distance; negative zooms out. */
  zoom(share: number): void;
  /** Show the surface clear of an element at this edge of the canvas. */
  keepFree(element: Element, edge: Edge): void;
}

/** The renderer: what stands still is drawn only when `dirty`, what moves in each frame. */
export interface Renderer {
  dirty: boolean;
  /** Strength of the eye-dome shading, 0 to 1. */
  eyeDome: number;
  /** Background, as a CSS colour. */
  set ground(colour: string);
  readonly terrain: {
    show(looks: Looks, layer: Layer | null): void;
    refine(part: Part | null, picture?: ImageBitmap | null, place?: [number, number, number, number]): void;
    refineTexture(patch: FinePatch | null): void;
  } | null;
  readonly trouble: Trouble;
  /** Called when `trouble` changes. */
  troubled: (trouble: Trouble) => void;
  /** Called when the camera has come to rest. */
  rested: () => void;
  /** Called after a key moved the camera. */
  acted: (act: CameraAct) => void;
  /** Replace the surface that is drawn. */
  put(scene: Scene, looks: Looks): void;
  /** Add an object that moves; its owner sets visibility and position before each frame. */
  overlay(object: Object3D): void;
  /** Draw a frame; wait for its pixels if they are to be timed. */
  draw(wait: boolean): void;
}

/** A tool that takes the pointer from the hand: its main button then means places on the surface. */
export interface PointerTool {
  begin(at: Vec): void;
  drag?(at: Vec): void;
  end?(at: Vec): void;
  /** Called when another tool takes the pointer, or this one is put away. */
  left?(): void;
}

/** The layer over the surface: the contact, labels and tools. */
export interface Overlay {
  readonly settings: OverlaySettings;
  /** The latest reading of a state; null while there is no state. */
  readonly live: Reading | null;
  /** Set to have the next frame draw the overlay again. */
  changed: boolean;
  readonly picking: { readonly busy: PointerTool | null; take(tool: PointerTool | null): void };
  /** Use another surface. */
  show(scene: Scene): void;
  /** Return whether this state needs a new frame. */
  wants(state: State | null): boolean;
  /** Move everything to where this state has it. */
  put(state: State | null): void;
  /** Pin an element to a point of the workspace, hidden while that is null; return a function that removes it. */
  stay(element: HTMLElement, at: () => Vec | null): () => void;
}

/** The page's own hand. */
export interface PageHand extends HandState {
  /** Penetration when it presses, metres. */
  pressM: number;
  /** Make this tab's hand the active one. */
  take(): void;
  /** Move freely in space, or over the surface. */
  free(on: boolean): void;
  /** Lift the hand and move it over a place of the surface. */
  leadTo(x: number, y: number): void;
}

/** The narration of what lies under the hand. */
export interface Narration {
  /** Whether moves are described: in the air too, with rises and falls. */
  moves: boolean;
  readonly touring: boolean;
  /** Begin or end a tour of the parts. */
  toggleTour(): void;
}

export interface Sound {
  readonly on: boolean;
  /** Present loudness, root mean square of full scale. */
  readonly level: number;
  /** 0 to 1. */
  volume: number;
  toggle(): Promise<void>;
  has(voice: VoiceName): boolean;
  let(voice: VoiceName, on: boolean): void;
  /** Play the heights of a row from left to right, as pitches. */
  sweep(scene: Scene, y: number): Promise<void>;
}

export interface Speech {
  readonly voice: SpeechSynthesisVoice | null;
  aloud: boolean;
  rate: number;
  readonly reading: boolean;
  /** Read lines in a language; false if the browser has no voice for it. `ended`: called when reading ends. */
  read(lines: string[], language: string, ended: () => void): boolean;
  /** Stop reading. */
  hush(): void;
}

export interface Themes {
  readonly chosen: Theme;
  choose(theme: Theme): void;
}

export interface Page {
  readonly hub: Hub;
  readonly net: Server & Pointer & { drawn(seq: number): void; readonly sentMs: Map<number, number> };
  readonly view: Sight & Renderer;
  readonly overlay: Overlay;
  readonly canvas: HTMLCanvasElement;
  /** The surface on the screen; null before the first. */
  scene: Scene | null;
  /** This page's hand; null until the page is built. */
  hand: PageHand | null;
  /** The narration; null until the page is built. */
  narration: Narration | null;
  /** The pipeline file on the screen. */
  document: Document | null;
  /** The tick of a recording that is shown in place of the loop's; null while the loop's is shown. */
  replayed: State | null;
  readonly sound: Sound;
  readonly speech: Speech;
  readonly themes: Themes;
  /** Resolved once the server has time for low-priority requests (server/idle.ts). */
  readonly idle: Promise<void>;
  /** Announce a text in a live region, and aloud if speech is on (speech/announcer.ts). */
  say(text: Text, options?: Announcement): void;
  /** Allow a topic's last text to be announced again. */
  forget(topic: string): void;
}
