/** The renderer: the terrain is drawn once into a colour and depth target; a frame is a copy of that, and what moves. */
import {
  Camera,
  Color,
  DepthTexture,
  type Mesh,
  NearestFilter,
  type Object3D,
  Scene as Stage,
  UnsignedIntType,
  Vector3,
  WebGLRenderer,
  WebGLRenderTarget,
} from "three";
import { Eye } from "./camera";
import { attachCameraInput, type CameraAct } from "./camera_input";
import { EyeDome, fullScreenQuad } from "./eye_dome";
import type { Vec } from "../server/protocol";
import { type Edge, FreePart } from "./free_part";
import type { Scene } from "../surface/scene";
import { flatSurface, type Looks, Terrain } from "../terrain/terrain";

const REST_MS = 140;
/** Interval of surfaces, ms, below which they are drawn coarsely until the last one stays, as while a height is dragged. */
const FOLLOWING_MS = 800;
/** Time for which the first surface is drawn coarsely, ms: its touch is being computed meanwhile. */
const FIRST_MS = 1200;
/** Drawing time from which a terrain is drawn coarser while the camera moves, ms. */
const SLOW_MS = 22;
/** Drawing time from which a terrain is drawn at CSS resolution, ms. */
const VERY_SLOW_MS = 80;
const FINEST_RATIO = 2;
const PATTERN_PX = 11;

/** Why nothing is drawn: no WebGL 2, or its context was lost. */
export type Trouble = "" | "missing" | "lost";

export class View {
  readonly eye = new Eye();
  readonly camera = this.eye.camera;
  /** Objects drawn again only when `dirty`. */
  readonly fixed = new Stage();
  /** Objects drawn over it in every frame. */
  readonly moving = new Stage();
  terrain: Terrain | null = null;
  dirty = true;
  trouble: Trouble = "";
  /** Called when `trouble` changes. */
  troubled: (trouble: Trouble) => void = () => {};
  /** Called when the camera has come to rest. */
  rested: () => void = () => {};
  /** Called after a key moved the camera. */
  acted: (act: CameraAct) => void = () => {};
  /** Strength of the eye-dome shading, 0 to 1. */
  eyeDome = 0;
  private renderer: WebGLRenderer | null;
  private dome = new EyeDome();
  private drawn: WebGLRenderTarget | null = null;
  private shaded: WebGLRenderTarget | null = null;
  private copied = { colours: { value: null as unknown }, depths: { value: null as unknown } };
  private copy: Mesh = fullScreenQuad(
    `precision highp float; precision highp sampler2D; uniform sampler2D colours, depths; out vec4 colour;
void main() { ivec2 p = ivec2(gl_FragCoord.xy); colour = texelFetch(colours, p, 0); gl_FragDepth = texelFetch(depths, p, 0).r; }`,
    this.copied,
  );
  private stage = new Stage();
  private none = new Camera();
  private pixel = new Uint8Array(4);
  /** Terrain of `prepare`, which keeps compiled shaders until a surface uses them. */
  private prepared: Terrain | null = null;
  private resting = 0;
  /** Time before which the camera does not count as at rest, milliseconds of the page. */
  private restsMs = 0;
  private putMs = -Infinity;
  /** Time to draw all of the terrain, ms; infinite until measured. */
  private takesMs = Infinity;
  /** Pixels drawn per CSS pixel, per side. */
  private ratio = 1;
  private scene: Scene | null = null;
  private free: FreePart;

  constructor(private canvas: HTMLCanvasElement) {
    this.renderer = rendererOf(canvas);
    if (!this.renderer) this.trouble = "missing";
    this.eye.ground = (x, y) => this.scene?.height(x, y) ?? NaN;
    this.eye.onChange = () => this.onMove();
    attachCameraInput(canvas, this.eye, (x, y) => this.scene?.pick(...this.ray(x, y)) ?? this.onGround(x, y), (act) => this.acted(act));
    canvas.addEventListener("webglcontextlost", (event) => this.onContextLost(event));
    canvas.addEventListener("webglcontextrestored", () => this.onContextRestored());
    new ResizeObserver(() => this.size()).observe(canvas);
    this.free = new FreePart(canvas, (covered) => this.eye.cover(covered));
    this.size();
  }

  /** Compile the shaders of any surface while there is none yet: that takes a fifth of a second in software. */
  prepare(looks: Looks): void {
    const { renderer, drawn } = this;
    if (!renderer || !drawn || this.trouble || this.terrain || this.prepared) return;
    this.prepared = new Terrain(flatSurface(), looks);
    renderer.setRenderTarget(drawn);
    renderer.render(this.prepared.group, this.camera);
    this.dirty = true;
  }

  /** Show the surface clear of an element at this edge of the canvas. */
  keepFree(element: Element, edge: Edge): void {
    this.free.keep(element, edge);
  }

  /** Draw another surface; one of a different size is shown whole. */
  put(scene: Scene, looks: Looks): void {
    const before = this.scene?.meta;
    this.scene = scene;
    if (before?.rows !== scene.meta.rows || before.columns !== scene.meta.columns) this.takesMs = Infinity;
    if (this.renderer) {
      this.terrain?.dispose();
      this.fixed.clear();
      this.terrain = new Terrain(scene, looks, this.takesMs > SLOW_MS);
      this.fixed.add(this.terrain.group);
    }
    if (String(before?.extent_m) !== String(scene.meta.extent_m)) this.frame(...scene.meta.extent_m);
    const now = performance.now();
    this.restsMs = now + (!before ? FIRST_MS : now - this.putMs < FOLLOWING_MS ? FOLLOWING_MS : REST_MS);
    this.onMove();
    this.putMs = now;
  }

  /** Set the background, as a CSS colour. */
  set ground(colour: string) {
    this.fixed.background = new Color(colour).convertLinearToSRGB(); // targets hold screen colours
    this.dirty = true;
  }

  /** Add an object that moves; its owner sets visibility and position before each frame. */
  overlay(object: Object3D): void {
    this.moving.add(object);
  }

  /** Show the whole of a surface of this size. */
  frame(width_m: number, length_m: number): void {
    this.eye.frame(width_m, length_m, this.scene?.meta.height_m);
  }

  /** Show a region of this width from the camera's present side. */
  focus(centre: Vec, width_m: number): void {
    this.eye.focus(centre, width_m);
  }

  /** Zoom in by this share of the distance; out if negative. */
  zoom(share: number): void {
    this.eye.zoom(1 - share);
  }

  /** Return origin and direction of the ray through a place of the window. */
  ray(clientX: number, clientY: number): [Vec, Vec] {
    const { left, top, width, height } = this.canvas.getBoundingClientRect();
    const through = new Vector3(((clientX - left) / width) * 2 - 1, 1 - ((clientY - top) / height) * 2, 0.5);
    const from = this.camera.position;
    const way = through.unproject(this.camera).sub(from).normalize();
    return [from.toArray(), way.toArray()];
  }

  /** Return where a point of the workspace is on the canvas, CSS pixels from its upper left corner. */
  toScreen(point: Vec): [number, number] {
    const { x, y } = new Vector3(...point).project(this.camera);
    return [((x + 1) / 2) * this.canvas.clientWidth, ((1 - y) / 2) * this.canvas.clientHeight];
  }

  /** Draw a frame; wait for its pixels if it is timed. */
  draw(wait: boolean): void {
    const { renderer, drawn } = this;
    const flies = this.eye.advance(performance.now());
    const again = this.dirty;
    this.dirty = flies;
    if (!renderer || !drawn || this.trouble) return;
    if (again) this.drawFixed(renderer, drawn);
    this.stage.clear();
    this.stage.add(this.copy);
    renderer.setRenderTarget(null);
    renderer.render(this.stage, this.none);
    renderer.render(this.moving, this.camera);
    if (wait) this.wait(renderer);
  }

  private drawFixed(renderer: WebGLRenderer, drawn: WebGLRenderTarget): void {
    const measured = this.terrain === null || this.terrain.moving || this.takesMs < Infinity;
    const begun = performance.now();
    if (this.terrain) this.terrain.period = PATTERN_PX * this.pixel_m();
    renderer.setRenderTarget(drawn);
    renderer.clear();
    renderer.render(this.fixed, this.camera);
    if (this.terrain) this.dropPrepared();
    let colours = drawn.texture;
    if (this.eyeDome > 0 && this.shaded) {
      this.stage.clear();
      this.stage.add(this.dome.shade(drawn.texture, drawn.depthTexture!, this.camera, this.eyeDome, this.ratio));
      renderer.setRenderTarget(this.shaded);
      renderer.render(this.stage, this.none);
      colours = this.shaded.texture;
    }
    this.copied.colours.value = colours;
    if (measured) return;
    renderer.setRenderTarget(drawn);
    this.wait(renderer);
    this.takesMs = performance.now() - begun;
    if (this.takesMs <= VERY_SLOW_MS || this.ratio === 1) return;
    this.size();
    this.drawFixed(renderer, this.drawn!);
  }

  private dropPrepared(): void {
    this.prepared?.dispose();
    this.prepared = null;
  }

  /** Return the width of a pixel at the camera's target, metres. */
  pixel_m(): number {
    const { fov } = this.camera;
    return (2 * this.eye.pose.distance * Math.tan((fov * Math.PI) / 360)) / Math.max(1, this.canvas.clientHeight);
  }

  private onGround(clientX: number, clientY: number): Vec | null {
    const [o, d] = this.ray(clientX, clientY);
    const t = (this.eye.pose.target[2] - o[2]) / d[2];
    return t > 0 ? [o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]] : null;
  }

  private onMove(): void {
    const restMs = Math.max(REST_MS, this.restsMs - performance.now()); // a layout that settles moves the camera
    this.dirty = true;
    if (this.terrain && this.takesMs > SLOW_MS) this.terrain.moving = true;
    clearTimeout(this.resting);
    this.resting = window.setTimeout(() => this.onRest(), restMs);
  }

  private onRest(): void {
    if (this.terrain) this.terrain.moving = false;
    this.dirty = true;
    this.rested();
  }

  private wait(renderer: WebGLRenderer): void {
    const gl = renderer.getContext();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, this.pixel);
  }

  private onContextLost(event: Event): void {
    event.preventDefault(); // the context may be restored
    this.trouble = "lost";
    this.troubled("lost");
  }

  private onContextRestored(): void {
    this.trouble = "";
    this.size();
    this.troubled("");
  }

  private size(): void {
    const width = Math.max(1, this.canvas.clientWidth);
    const height = Math.max(1, this.canvas.clientHeight);
    this.eye.resize(width, height);
    if (!this.renderer) return;
    const slow = this.takesMs > VERY_SLOW_MS && this.takesMs < Infinity;
    this.ratio = slow ? 1 : Math.min(Math.max(devicePixelRatio, 1), FINEST_RATIO);
    const [across, along] = [Math.round(this.ratio * width), Math.round(this.ratio * height)];
    this.renderer.setSize(across, along, false);
    for (const each of [this.drawn, this.shaded]) each?.dispose();
    const filters = { minFilter: NearestFilter, magFilter: NearestFilter } as const;
    this.drawn = new WebGLRenderTarget(across, along, { ...filters });
    this.drawn.depthTexture = new DepthTexture(across, along, UnsignedIntType);
    this.shaded = new WebGLRenderTarget(across, along, { ...filters, depthBuffer: false });
    this.copied.depths.value = this.drawn.depthTexture;
    this.dirty = true;
  }
}

function rendererOf(canvas: HTMLCanvasElement): WebGLRenderer | null {
  const context = canvas.getContext("webgl2", { alpha: false, antialias: false, stencil: false });
  if (!context) return null;
  const renderer = new WebGLRenderer({ canvas, context, antialias: false });
  renderer.autoClear = false;
  return renderer;
}
