/** Layers: the terrain is drawn once into a colour and depth target; a frame is a copy of that, and what moves. */
import {
  AlwaysDepth,
  Camera,
  Color,
  DepthTexture,
  HalfFloatType,
  Mesh,
  NearestFilter,
  type Object3D,
  PerspectiveCamera,
  PlaneGeometry,
  Scene as Stage,
  ShaderMaterial,
  UnsignedIntType,
  Vector3,
  WebGLRenderer,
  WebGLRenderTarget,
  MOUSE,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { Vec } from "./protocol";
import type { Scene } from "./scene";
import { Terrain } from "./terrain";

const Z = new Vector3(0, 0, 1);

export class View {
  readonly camera = new PerspectiveCamera(36, 1, 0.002, 2);
  readonly controls: OrbitControls;
  terrain: Terrain | null = null;
  dirty = true;
  private renderer: WebGLRenderer;
  /** What is drawn again only when `dirty`. */
  readonly fixed = new Stage();
  /** What is drawn over it in every frame. */
  readonly moving = new Stage();
  private copy = new Stage();
  private none = new Camera();
  private target = new WebGLRenderTarget(1, 1);
  private blit = new ShaderMaterial({
    depthFunc: AlwaysDepth,
    uniforms: { c: { value: null }, d: { value: null } },
    vertexShader: "varying vec2 v; void main() { v = uv; gl_Position = vec4(position.xy, 0., 1.); }",
    fragmentShader:
      "uniform sampler2D c, d; varying vec2 v; void main() { gl_FragColor = texture2D(c, v); gl_FragDepth = texture2D(d, v).r;\n#include <colorspace_fragment>\n}",
  });
  private pixel = new Uint8Array(4);

  constructor(private canvas: HTMLCanvasElement) {
    this.renderer = new WebGLRenderer({ canvas, antialias: false, powerPreference: "high-performance" });
    this.renderer.autoClear = false;
    this.camera.up.copy(Z);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.mouseButtons = { LEFT: null, MIDDLE: MOUSE.ROTATE, RIGHT: MOUSE.PAN } as any;
    this.controls.enableZoom = false; // the wheel is the hand's depth; Ctrl+wheel zooms, see hand.ts
    this.controls.addEventListener("change", () => (this.dirty = true));
    this.fixed.background = new Color(0x10161f);
    const quad = new Mesh(new PlaneGeometry(2, 2), this.blit);
    quad.frustumCulled = false;
    this.copy.add(quad);
    new ResizeObserver(() => this.size()).observe(canvas);
    this.size();
  }

  put(scene: Scene) {
    if (this.terrain) {
      this.fixed.remove(this.terrain.mesh, this.terrain.normals);
      this.terrain.dispose();
    }
    this.terrain = new Terrain(scene);
    this.fixed.add(this.terrain.mesh, this.terrain.normals);
    this.frame(...scene.meta.extent_m);
  }

  /** Something that moves; the caller sets `visible` and position before the frame is drawn. */
  overlay(object: Object3D): void {
    this.moving.add(object);
  }

  /** Look at a whole surface of this size. */
  frame(width_m: number, length_m: number): void {
    this.camera.position.set(0, -1.15 * length_m - 0.35 * width_m, 1.05 * width_m);
    this.controls.target.set(0, 0.06 * length_m, 0);
    this.controls.update();
    this.dirty = true;
  }

  /** Look at a region this wide from where the camera is, as far as it needs. */
  focus(centre: Vec, width_m: number): void {
    const way = this.camera.position.clone().sub(this.controls.target).normalize();
    this.controls.target.set(...centre);
    this.camera.position.copy(this.controls.target).addScaledVector(way, 1.6 * width_m);
    this.controls.update();
    this.dirty = true;
  }

  /** Nearer by this share of the way, or farther. */
  zoom(share: number): void {
    this.camera.position.lerp(this.controls.target, share);
    this.controls.update();
    this.dirty = true;
  }

  ray(clientX: number, clientY: number): [Vec, Vec] {
    const r = this.canvas.getBoundingClientRect();
    const v = new Vector3(
      ((clientX - r.left) / r.width) * 2 - 1,
      1 - ((clientY - r.top) / r.height) * 2,
      0.5,
    ).unproject(this.camera);
    const o = this.camera.position;
    v.sub(o).normalize();
    return [
      [o.x, o.y, o.z],
      [v.x, v.y, v.z],
    ];
  }

  /** Where a point of the workspace is on the canvas, in its CSS pixels from its upper left corner. */
  toScreen(point: Vec): [number, number] {
    const { x, y } = new Vector3(...point).project(this.camera);
    return [((x + 1) / 2) * this.canvas.clientWidth, ((1 - y) / 2) * this.canvas.clientHeight];
  }

  /** Draw a frame; wait until it is drawn where that is to be measured. */
  draw(wait: boolean): void {
    if (this.dirty) {
      this.renderer.setRenderTarget(this.target);
      this.renderer.clear();
      this.renderer.render(this.fixed, this.camera);
      this.renderer.setRenderTarget(null);
      this.dirty = false;
    }
    this.renderer.render(this.copy, this.none);
    this.renderer.render(this.moving, this.camera);
    if (wait) {
      const gl = this.renderer.getContext();
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, this.pixel);
    }
  }

  private size() {
    const w = Math.max(1, this.canvas.clientWidth),
      h = Math.max(1, this.canvas.clientHeight);
    this.renderer.setSize(w, h, false);
    this.camera.aspect = w / h;
    this.camera.updateProjectionMatrix();
    this.target.dispose();
    this.target = new WebGLRenderTarget(w, h, {
      type: HalfFloatType,
      minFilter: NearestFilter,
      magFilter: NearestFilter,
    });
    this.target.depthTexture = new DepthTexture(w, h, UnsignedIntType);
    this.blit.uniforms.c.value = this.target.texture;
    this.blit.uniforms.d.value = this.target.depthTexture;
    this.dirty = true;
  }
}
