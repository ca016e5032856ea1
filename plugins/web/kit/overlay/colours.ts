/** Colours of the overlay: light ones have a dark rim, so that they are visible on any photograph. */
export const COLOURS = {
  device: 0xff5d8f,
  proxy: 0x35d0ff,
  force: 0xffb020,
  other: 0xb79bff,
  rim: 0x0b0e13,
  cone: 0xc77f1a,
  frame: 0xffffff,
} as const;
