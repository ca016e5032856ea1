/** A part of the surface as a mesh: its heights are a texture, and no vertex is stored. */
import { BufferAttribute, BufferGeometry, GLSL3, Mesh, RawShaderMaterial, Vector4, type IUniform, type Texture } from "three";
import type { Part } from "../surface/scene";
import { FRAGMENT, VERTEX } from "./shader";
import { gradientTexture, integers, numbers, pictureTexture } from "./textures";
import { strideOf, triangles } from "./triangles";

export type Uniforms = Record<string, IUniform>;

const NO_LABELS = new Uint16Array(1);

export class Sheet {
  readonly mesh: Mesh<BufferGeometry, RawShaderMaterial>;
  readonly own: Uniforms;
  /** Indices of all triangles, and of fewer; created when first drawn. */
  private finest: BufferAttribute | null = null;
  private coarse: BufferAttribute | null = null;

  /** Create a sheet. common: uniforms shared by all sheets. pictured: place of the picture: left x, far y, width, length. */
  constructor(
    readonly part: Part,
    common: Uniforms,
    picture: ImageBitmap | null,
    pictured: [number, number, number, number],
    moving = false,
  ) {
    const { grid, labels } = part;
    const { rows, columns, place } = grid;
    this.own = {
      heights: { value: numbers(grid.heights, columns, rows) },
      gradient: { value: gradientTexture(grid) },
      labels: { value: labels ? integers(labels, columns, rows) : integers(NO_LABELS, 1, 1) },
      photo: { value: pictureTexture(picture) },
      place: { value: new Vector4(place.left, place.far, place.dx, place.dy) },
      photoPlace: { value: new Vector4(...pictured) },
      hole: { value: new Vector4() },
    };
    const material = new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      side: 2,
      uniforms: { ...common, ...this.own },
    });
    this.mesh = new Mesh(new BufferGeometry(), material);
    this.mesh.frustumCulled = false;
    this.moving = moving;
  }

  /** Draw fewer triangles while the camera moves; the shading stays as fine. */
  set moving(moving: boolean) {
    const { rows, columns } = this.part.grid;
    const stride = moving ? strideOf(rows, columns) : 1;
    const made = (): BufferAttribute => new BufferAttribute(triangles(rows, columns, stride), 1);
    this.mesh.geometry.setIndex(stride > 1 ? (this.coarse ??= made()) : (this.finest ??= made()));
  }

  /** Leave out a box that another sheet draws; none if it is empty. */
  cut(left: number, near: number, right: number, far: number): void {
    this.own.hole.value.set(left, near, right, far);
  }

  dispose(): void {
    for (const name of ["heights", "gradient", "labels", "photo"]) (this.own[name].value as Texture).dispose();
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }
}
