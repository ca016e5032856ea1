/** Textures of arrays. */
import {
  DataTexture,
  DataUtils,
  FloatType,
  HalfFloatType,
  LinearFilter,
  LinearMipmapLinearFilter,
  NearestFilter,
  RedFormat,
  RedIntegerFormat,
  RGBAFormat,
  RGFormat,
  SRGBColorSpace,
  Texture,
  UnsignedByteType,
  UnsignedIntType,
  UnsignedShortType,
} from "three";
import type { Grid } from "../surface/grid";
import type { Labels } from "../surface/scene";
import { heatTexels } from "./colours";

const KINDS_WIDE = 1024;
const MAX_HALF = 65000;

export function numbers(values: Float32Array, columns: number, rows: number): DataTexture {
  return ready(new DataTexture(values as Float32Array<ArrayBuffer>, columns, rows, RedFormat, FloatType));
}

export function integers(values: Labels, columns: number, rows: number): DataTexture {
  const short = values instanceof Uint16Array;
  const type = short ? UnsignedShortType : UnsignedIntType;
  const texture = new DataTexture(values as Uint16Array<ArrayBuffer>, columns, rows, RedIntegerFormat, type);
  texture.internalFormat = short ? "R16UI" : "R32UI";
  texture.unpackAlignment = values.BYTES_PER_ELEMENT;
  return ready(texture);
}

/** Return a texture of a number per label, in rows of KINDS_WIDE. */
export function kindsTexture(kinds: Uint16Array): DataTexture {
  const rows = Math.max(1, Math.ceil(kinds.length / KINDS_WIDE));
  const padded = new Uint16Array(rows * KINDS_WIDE);
  padded.set(kinds);
  return integers(padded, KINDS_WIDE, rows);
}

export function heatTexture(): DataTexture {
  const texture = new DataTexture(heatTexels() as Uint8Array<ArrayBuffer>, 256, 1, RGBAFormat, UnsignedByteType);
  texture.minFilter = texture.magFilter = LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

/** Return a texture of slopes dh/dx and dh/dy: central differences, one-sided at the border, interpolated between cells. */
export function gradientTexture({ heights, rows, columns, place }: Grid): DataTexture {
  const slopes = new Uint16Array(2 * rows * columns);
  for (let j = 0, k = 0; j < rows; j++) {
    const up = (j > 0 ? j - 1 : j) * columns;
    const down = (j < rows - 1 ? j + 1 : j) * columns;
    const perY = 1 / (Math.max(down / columns - up / columns, 1) * place.dy);
    for (let i = 0; i < columns; i++, k += 2) {
      const left = i > 0 ? i - 1 : i;
      const right = i < columns - 1 ? i + 1 : i;
      const row = j * columns;
      slopes[k] = half((heights[row + right] - heights[row + left]) / (Math.max(right - left, 1) * place.dx));
      slopes[k + 1] = half((heights[up + i] - heights[down + i]) * perY);
    }
  }
  const texture = new DataTexture(slopes, columns, rows, RGFormat, HalfFloatType);
  texture.unpackAlignment = 4;
  texture.magFilter = LinearFilter;
  texture.minFilter = LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

function half(value: number): number {
  return DataUtils.toHalfFloat(Math.min(Math.max(value, -MAX_HALF), MAX_HALF));
}

export function pictureTexture(picture: ImageBitmap | null): Texture {
  const texture = picture ? new Texture(picture) : new DataTexture(new Uint8Array(4), 1, 1);
  texture.flipY = false;
  texture.colorSpace = SRGBColorSpace;
  texture.generateMipmaps = picture !== null;
  texture.minFilter = picture ? LinearMipmapLinearFilter : NearestFilter;
  texture.magFilter = LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

function ready(texture: DataTexture): DataTexture {
  texture.minFilter = texture.magFilter = NearestFilter;
  texture.needsUpdate = true;
  return texture;
}
