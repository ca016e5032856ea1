/** Touch as sound: taps, texture, force, and heights as pitch. Off until a person switches it on. */
import type { Hub } from "../hub";
import { Instrument } from "./synthesizer";
import { isHeld, isTouching, type State } from "../server/protocol";
import { recall, remember } from "../preferences";
import type { Scene } from "../surface/scene";
import { force_level, pan, pitch_hz, stroke, tap } from "./sonification";

/** Sounds that can be switched. */
export const VOICES = { texture: true, contact: true, force: false, height: false } as const;
export type VoiceName = keyof typeof VOICES;

const SWEEP_S = 2.5;
const SWEEP_STEPS = 200;
/** Milliseconds without a state after which all is silent. */
const SILENT_MS = 250;
/** The sound of a border between parts: short and high, unlike the tap of a touch. */
const CLICK = { hz: 1400, level: 0.25, seconds: 0.02 };
const NONE = stroke(null, [0, 0, 0], [0, 0, 0]);

export class Sound {
  private instrument: Instrument | null = null;
  private sounding = false;
  private touched = false;
  private heardMs = 0;
  private sweeping: OscillatorNode | null = null;

  constructor(
    private hub: Hub,
    private scene: () => Scene | null,
  ) {
    hub.on("state", (state) => this.hear(state));
    setInterval(() => this.sounding && performance.now() - this.heardMs > SILENT_MS && this.hush(), SILENT_MS);
  }

  get on(): boolean {
    return this.sounding;
  }

  async toggle(): Promise<void> {
    this.sounding = !this.sounding;
    if (this.sounding) await this.wake();
    else this.hush();
    this.hub.tell("sound", { on: this.sounding });
  }

  get volume(): number {
    return recall("volume", 0.5);
  }

  set volume(volume: number) {
    remember("volume", volume);
    if (this.instrument) this.instrument.volume = volume;
  }

  has(voice: VoiceName): boolean {
    return recall(`hear.${voice}`, VOICES[voice] as boolean);
  }

  let(voice: VoiceName, on: boolean): void {
    remember(`hear.${voice}`, on);
  }

  /** Present loudness, root mean square of full scale. */
  get level(): number {
    if (!this.instrument) return 0;
    const { meter } = this.instrument;
    const data = new Float32Array(meter.fftSize);
    meter.getFloatTimeDomainData(data);
    return Math.sqrt(data.reduce((sum, each) => sum + each * each, 0) / data.length);
  }

  /** Play the click of a border between parts. */
  click(): void {
    if (this.sounding && this.has("contact")) this.instrument?.tap(CLICK);
  }

  /** Play the heights of a row from left to right, as pitches, also while the sound is off. */
  async sweep(scene: Scene, y: number): Promise<void> {
    const instrument = await this.wake();
    this.sweeping?.stop();
    this.sweeping = instrument.sweep(row(scene, y), SWEEP_S);
    await new Promise((ended) => (this.sweeping!.onended = ended));
  }

  /** Return the one audio context, created by the person's first use: browsers allow none before. */
  private async wake(): Promise<Instrument> {
    this.instrument ??= new Instrument(new AudioContext({ latencyHint: "interactive" }));
    this.instrument.volume = this.volume;
    await (this.instrument.context as AudioContext).resume();
    return this.instrument;
  }

  private hear(state: State): void {
    const { instrument } = this;
    const scene = this.scene();
    if (!this.sounding || !instrument || !scene) return;
    this.heardMs = performance.now();
    const [x, y] = state.hand;
    const material = scene.material(x, y);
    const touched = isTouching(state);
    if (touched && !this.touched && this.has("contact")) instrument.tap(tap(material, state.velocity));
    this.touched = touched;
    instrument.pan(pan(x, scene.meta.extent_m[0]));
    instrument.stroke(touched && this.has("texture") ? stroke(material, state.force, state.velocity) : NONE);
    instrument.force(touched && this.has("force") ? force_level(Math.hypot(...state.force)) : 0);
    const height = isHeld(state) && this.has("height") ? scene.height(x, y) : NaN;
    instrument.heightAt(Number.isNaN(height) ? null : pitch_hz(height, scene.meta.height_m));
  }

  private hush(): void {
    this.touched = false;
    this.instrument?.stroke(NONE);
    this.instrument?.force(0);
    this.instrument?.heightAt(null);
  }
}

/** Return the pitches of a row of a surface. */
export function row(scene: Scene, y: number): Float32Array {
  const { extent_m, height_m } = scene.meta;
  return Float32Array.from({ length: SWEEP_STEPS }, (_, i) =>
    pitch_hz(scene.height(((i + 0.5) / SWEEP_STEPS - 0.5) * extent_m[0], y), height_m),
  );
}
