/** Layers: the terrain is drawn once into a colour and depth target; a frame is a copy of that, and what moves. */
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
import { Eye, steer } from "./camera";
import { EyeDome, screen } from "./eye_dome";
import type { Vec } from "../server/protocol";
import type { Scene } from "../surface/scene";
import { flat, type Looks, Terrain } from "../terrain/terrain";

const REST_MS = 140;
/** Surfaces that follow each other sooner, as while a height is dragged, are drawn coarsely until the last one stays. */
const FOLLOWING_MS = 800;
/** So is the first surface meanwhile: what is felt of it is being made, and to draw all of it takes as much. */
const FIRST_MS = 1200;
/** A terrain that takes longer is drawn coarser while the camera moves. */
const SLOW_MS = 22;
/** One that takes as long is drawn with a pixel of the page, however fine the screen is. */
const VERY_SLOW_MS = 80;
const FINEST_RATIO = 2;
const PATTERN_PX = 11;

/** Why nothing is drawn: there is no WebGL, or it was taken away. */
export type Trouble = "" | "missing" | "lost";

export class View {
  readonly eye = new Eye();
  readonly camera = this.eye.camera;
  /** What is drawn again only when `dirty`. */
  readonly fixed = new Stage();
  /** What is drawn over it in every frame. */
  readonly moving = new Stage();
  terrain: Terrain | null = null;
  dirty = true;
  trouble: Trouble = "";
  /** Called when that changes. */
  troubled: (trouble: Trouble) => void = () => {};
  /** Called when the camera has come to rest. */
  rested: () => void = () => {};
  /** 0 none to 1. */
  eyeDome = 0;
  private renderer: WebGLRenderer | null;
  private dome = new EyeDome();
  private drawn: WebGLRenderTarget | null = null;
  private shaded: WebGLRenderTarget | null = null;
  private copied = { colours: { value: null as unknown }, depths: { value: null as unknown } };
  private copy: Mesh = screen(
    `precision highp float; precision highp sampler2D; uniform sampler2D colours, depths; out vec4 colour;
void main() { ivec2 p = ivec2(gl_FragCoord.xy); colour = texelFetch(colours, p, 0); gl_FragDepth = texelFetch(depths, p, 0).r; }`,
    this.copied,
  );
  private stage = new Stage();
  private none = new Camera();
  private pixel = new Uint8Array(4);
  /** Keeps what `prepare` compiled until a surface uses it. */
  private prepared: Terrain | null = null;
  private resting = 0;
  private putMs = -Infinity;
  /** To draw all of the terrain; infinite until that was measured. */
  private takesMs = Infinity;
  /** Pixels that are drawn for one of the page, to the side. */
  private ratio = 1;
  private scene: Scene | null = null;

  constructor(private canvas: HTMLCanvasElement) {
    this.renderer = rendererOf(canvas);
    if (!this.renderer) this.trouble = "missing";
    this.eye.ground = (x, y) => this.scene?.height(x, y) ?? NaN;
    this.eye.changed = () => this.moved();
    steer(canvas, this.eye, (x, y) => this.scene?.pick(...this.ray(x, y)) ?? this.onGround(x, y));
    canvas.addEventListener("webglcontextlost", (event) => this.lost(event));
    canvas.addEventListener("webglcontextrestored", () => this.restored());
    new ResizeObserver(() => this.size()).observe(canvas);
    this.size();
  }

  /** Compile what any surface is drawn with, while there is none yet: that takes a fifth of a second in software. */
  prepare(looks: Looks): void {
    const { renderer, drawn } = this;
    if (!renderer || !drawn || this.trouble || this.terrain || this.prepared) return;
    this.prepared = new Terrain(flat(), looks);
    renderer.setRenderTarget(drawn);
    renderer.render(this.prepared.group, this.camera);
    this.dirty = true;
  }

  /** Draw this surface from now on; where the size is another one, the whole of it is looked at. */
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
    this.moved(!before ? FIRST_MS : now - this.putMs < FOLLOWING_MS ? FOLLOWING_MS : REST_MS);
    this.putMs = now;
  }

  /** What lies behind the surface, as styles say a colour. */
  set ground(colour: string) {
    this.fixed.background = new Color(colour).convertLinearToSRGB(); // targets hold what the screen shows
    this.dirty = true;
  }

  /** Something that moves; the caller sets `visible` and position before the frame is drawn. */
  overlay(object: Object3D): void {
    this.moving.add(object);
  }

  /** Look at the whole of a surface of this size. */
  frame(width_m: number, length_m: number): void {
    this.eye.frame(width_m, length_m, this.scene?.meta.height_m);
  }

  /** Look at a region this wide, from the side from which the camera looks. */
  focus(centre: Vec, width_m: number): void {
    this.eye.focus(centre, width_m);
  }

  /** Nearer by this share of the way, or farther. */
  zoom(share: number): void {
    this.eye.zoom(1 - share);
  }

  /** From the eye through a place of the window: where from, and which way. */
  ray(clientX: number, clientY: number): [Vec, Vec] {
    const { left, top, width, height } = this.canvas.getBoundingClientRect();
    const through = new Vector3(((clientX - left) / width) * 2 - 1, 1 - ((clientY - top) / height) * 2, 0.5);
    const from = this.camera.position;
    const way = through.unproject(this.camera).sub(from).normalize();
    return [from.toArray(), way.toArray()];
  }

  /** Where a point of the workspace is on the canvas, in its CSS pixels from its upper left corner. */
  toScreen(point: Vec): [number, number] {
    const { x, y } = new Vector3(...point).project(this.camera);
    return [((x + 1) / 2) * this.canvas.clientWidth, ((1 - y) / 2) * this.canvas.clientHeight];
  }

  /** Draw a frame; wait until it is drawn where that is to be measured. */
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
    if (this.terrain) this.unprepare();
    let colours = drawn.texture;
    if (this.eyeDome > 0 && this.shaded) {
      this.stage.clear();
      this.stage.add(this.dome.of(drawn.texture, drawn.depthTexture!, this.camera, this.eyeDome, this.ratio));
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

  private unprepare(): void {
    this.prepared?.dispose();
    this.prepared = null;
  }

  /** Width of a pixel at the place that is looked at. */
  pixel_m(): number {
    const { fov } = this.camera;
    return (2 * this.eye.pose.distance * Math.tan((fov * Math.PI) / 360)) / Math.max(1, this.canvas.clientHeight);
  }

  private onGround(clientX: number, clientY: number): Vec | null {
    const [o, d] = this.ray(clientX, clientY);
    const t = (this.eye.pose.target[2] - o[2]) / d[2];
    return t > 0 ? [o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]] : null;
  }

  private moved(restMs = REST_MS): void {
    this.dirty = true;
    if (this.terrain && this.takesMs > SLOW_MS) this.terrain.moving = true;
    clearTimeout(this.resting);
    this.resting = window.setTimeout(() => this.rest(), restMs);
  }

  private rest(): void {
    if (this.terrain) this.terrain.moving = false;
    this.dirty = true;
    this.rested();
  }

  private wait(renderer: WebGLRenderer): void {
    const gl = renderer.getContext();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, this.pixel);
  }

  private lost(event: Event): void {
    event.preventDefault(); // it may come back
    this.trouble = "lost";
    this.troubled("lost");
  }

  private restored(): void {
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
