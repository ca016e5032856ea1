/** Layers: the terrain is drawn once into a colour and depth target; a frame is a copy of that, and what moves. */
import {
  AlwaysDepth,
  Camera,
  Color,
  ConeGeometry,
  CylinderGeometry,
  DepthTexture,
  DirectionalLight,
  Group,
  HalfFloatType,
  HemisphereLight,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  NearestFilter,
  PerspectiveCamera,
  PlaneGeometry,
  Quaternion,
  Scene as Stage,
  ShaderMaterial,
  SphereGeometry,
  TorusGeometry,
  UnsignedIntType,
  Vector3,
  WebGLRenderer,
  WebGLRenderTarget,
  MOUSE,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { State, Vec } from "./protocol";
import type { Scene } from "./scene";
import { Terrain } from "./terrain";

const UP = new Vector3(0, 1, 0),
  Z = new Vector3(0, 0, 1);

export class View {
  readonly camera = new PerspectiveCamera(36, 1, 0.002, 2);
  readonly controls: OrbitControls;
  terrain: Terrain | null = null;
  dirty = true;
  show = { arrow: true, ring: true };
  private renderer: WebGLRenderer;
  private fixed = new Stage();
  private moving = new Stage();
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
  private hand: Mesh;
  private proxy: Mesh;
  private ring: Mesh;
  private arrow = new Group();
  private shaft: Mesh;
  private head: Mesh;
  private unit = 0.001;
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
    const plain = (color: number, more = {}) => new MeshLambertMaterial({ color, ...more });
    this.hand = new Mesh(
      new SphereGeometry(1, 20, 14),
      plain(0xff5d8f, { transparent: true, opacity: 0.85, depthTest: false }),
    );
    this.proxy = new Mesh(new SphereGeometry(1, 24, 16), plain(0x35d0ff));
    this.ring = new Mesh(new TorusGeometry(1, 0.09, 8, 40), new MeshBasicMaterial({ color: 0xffb020 }));
    this.shaft = new Mesh(new CylinderGeometry(1, 1, 1, 14).translate(0, 0.5, 0), plain(0xffb020));
    this.head = new Mesh(new ConeGeometry(1, 1, 18).translate(0, 0.5, 0), plain(0xffb020));
    this.arrow.add(this.shaft, this.head);
    const sun = new DirectionalLight(0xffffff, 2);
    sun.position.set(-1, -1, 2);
    this.moving.add(new HemisphereLight(0xffffff, 0x556070, 2), sun, this.hand, this.proxy, this.ring, this.arrow);
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
    const [w, l] = scene.meta.extent_m,
      mid = (scene.meta.height_m[0] + scene.meta.height_m[1]) / 2;
    this.unit = w / 80;
    this.camera.position.set(0, -1.15 * l - 0.35 * w, 1.05 * w);
    this.controls.target.set(0, 0.06 * l, mid);
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

  draw(s: State | null, normal: Vec, wait: boolean) {
    const seen = !!s && s.hand[2] < 0.5,
      touching = seen && (s.flags & 1) !== 0;
    this.hand.visible = seen;
    this.proxy.visible = this.ring.visible = this.arrow.visible = touching;
    if (seen) {
      const u = this.unit;
      this.hand.position.set(...s.hand);
      this.hand.scale.setScalar(0.75 * u);
      if (touching) {
        const at = Number.isNaN(s.proxy[2]) ? s.hand : s.proxy,
          n = Math.hypot(...s.force);
        this.proxy.position.set(...at);
        this.proxy.scale.setScalar(0.95 * u);
        this.ring.visible = this.show.ring;
        this.ring.position.set(...at);
        this.ring.scale.setScalar(2 * u);
        this.ring.quaternion.setFromUnitVectors(Z, new Vector3(...normal));
        this.arrow.visible = this.show.arrow && n > 1e-3;
        const length = (2 + 6 * Math.min(n, 4)) * u;
        this.arrow.position.set(...at);
        this.arrow.quaternion.copy(
          new Quaternion().setFromUnitVectors(UP, new Vector3(...s.force).divideScalar(n || 1)),
        );
        this.shaft.scale.set(0.38 * u, length, 0.38 * u);
        this.head.scale.set(1 * u, 2.4 * u, 1 * u);
        this.head.position.y = length;
      }
    }
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
