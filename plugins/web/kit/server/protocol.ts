/** The binary frames of the websocket, little-endian; the counterpart of tangible_web/framing.py. */

export const VERSION = 1;
export const STATE = 1;
export const POINTER = 2;
export const ACK = 3;
export const RELEASE = 4;
export const STATE_BYTES = 96;
export const POINTER_BYTES = 32;
export const ACK_BYTES = 8;
export const RELEASE_BYTES = 1;
export const STATUS = { RUNNING: 1, HOLDING: 2, RECORDING: 4 } as const;
export const TAGS = 0x3fffff;
/** Bits of `flags`, as `TickFlag` of the core. */
export const FLAGS = {
  TOUCHING: 1,
  FORCE_LIMITED: 2,
  SLEW_LIMITED: 4,
  STIFFNESS_LIMITED: 8,
  RAMPING: 16,
  NOT_FINITE: 32,
  DAMPED: 64,
  STALE: 128,
  OVERRUN: 256,
  SWAPPED: 512,
  BEACON: 1024,
} as const;

/** Vector: x right, y away, z up; metres, newtons, metres per second. */
export type Vec = [number, number, number];

/** State of the newest tick of the force loop. */
export interface State {
  status: number;
  flags: number;
  seq: number;
  /** Tag of the pointer that this tick acted on. */
  tag: number;
  overruns: number;
  /** Start of the tick, ms of the Unix clock. */
  sampleMs: number;
  hand: Vec;
  /** Proxy position; NaN for a law without a proxy. */
  proxy: Vec;
  force: Vec;
  velocity: Vec;
  /** Force of the second law in a comparison; 0 without one. */
  other: Vec;
  lateUs: number;
  arrivedMs: number;
}

/** Return milliseconds of the Unix clock, finer than Date.now. */
export const now = (): number => performance.timeOrigin + performance.now();

export function parseState(buffer: ArrayBuffer): State | null {
  const data = new DataView(buffer);
  if (buffer.byteLength !== STATE_BYTES || data.getUint8(0) !== STATE) return null;
  const at = (offset: number): Vec => [
    data.getFloat32(offset, true),
    data.getFloat32(offset + 4, true),
    data.getFloat32(offset + 8, true),
  ];
  return {
    status: data.getUint8(1),
    flags: data.getUint16(2, true),
    seq: data.getUint32(4, true),
    tag: data.getUint32(8, true),
    overruns: data.getUint32(12, true),
    sampleMs: data.getFloat64(16, true),
    hand: at(24),
    proxy: at(36),
    force: at(48),
    velocity: at(60),
    other: at(72),
    lateUs: data.getFloat32(84, true),
    arrivedMs: now(),
  };
}

export function encodePointer(hand: Vec, buttons: number, tag: number): ArrayBuffer {
  const buffer = new ArrayBuffer(POINTER_BYTES);
  const data = new DataView(buffer);
  data.setUint8(0, POINTER);
  data.setUint8(1, buttons);
  data.setUint32(4, tag, true);
  data.setFloat64(8, now(), true);
  hand.forEach((part, i) => data.setFloat32(16 + 4 * i, part, true));
  return buffer;
}

export function encodeAck(seq: number): ArrayBuffer {
  const buffer = new ArrayBuffer(ACK_BYTES);
  const data = new DataView(buffer);
  data.setUint8(0, ACK);
  data.setUint32(4, seq, true);
  return buffer;
}

export function encodeRelease(): ArrayBuffer {
  return new Uint8Array([RELEASE]).buffer;
}

/** Height from which a hand counts as absent, metres: the server puts a device without a hand a metre high. */
export const NOBODY_M = 0.5;

export const isRunning = (state: State): boolean => (state.status & STATUS.RUNNING) !== 0;
/** Return whether the loop runs and a hand holds the device. */
export const isHeld = (state: State): boolean => isRunning(state) && state.hand[2] < NOBODY_M;
export const isTouching = (state: State): boolean => isHeld(state) && (state.flags & FLAGS.TOUCHING) !== 0;
