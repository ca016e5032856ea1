/** What is felt, to hear: taps, texture, force, and heights as pitch. Off until a person switches it on. */
import type { Hub } from "../hub";
import { Instrument } from "./synthesizer";
import { held, touching } from "../speech/narrator";
import type { State } from "../server/protocol";
import { recall, remember } from "../preferences";
import type { Scene } from "../surface/scene";
import { force_level, pan, pitch_hz, stroke, tap } from "./sonification";

/** What is heard; each can be switched. */
export const VOICES = { texture: true, contact: true, force: false, height: false } as const;
export type VoiceName = keyof typeof VOICES;

const SWEEP_S = 2.5;
const SWEEP_STEPS = 200;
/** Without a state for so long nothing is heard. */
const SILENT_MS = 250;
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

  /** How loud it is now, root mean square of full scale. */
  get level(): number {
    if (!this.instrument) return 0;
    const { meter } = this.instrument;
    const data = new Float32Array(meter.fftSize);
    meter.getFloatTimeDomainData(data);
    return Math.sqrt(data.reduce((sum, each) => sum + each * each, 0) / data.length);
  }

  /** The heights of a row from left to right, as pitches. It is heard with the sound off too: a person asked for it. */
  async sweep(scene: Scene, y: number): Promise<void> {
    const instrument = await this.wake();
    this.sweeping?.stop();
    this.sweeping = instrument.sweep(row(scene, y), SWEEP_S);
    await new Promise((ended) => (this.sweeping!.onended = ended));
  }

  /** There is one context, made when a person first asks for sound: before that browsers allow none. */
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
    const touched = touching(state);
    if (touched && !this.touched && this.has("contact")) instrument.tap(tap(material, state.velocity));
    this.touched = touched;
    instrument.pan(pan(x, scene.meta.extent_m[0]));
    instrument.stroke(touched && this.has("texture") ? stroke(material, state.force, state.velocity) : NONE);
    instrument.force(touched && this.has("force") ? force_level(Math.hypot(...state.force)) : 0);
    const height = held(state) && this.has("height") ? scene.height(x, y) : NaN;
    instrument.heightAt(Number.isNaN(height) ? null : pitch_hz(height, scene.meta.height_m));
  }

  private hush(): void {
    this.touched = false;
    this.instrument?.stroke(NONE);
    this.instrument?.force(0);
    this.instrument?.heightAt(null);
  }
}

/** The pitches of a row of a surface. */
export function row(scene: Scene, y: number): Float32Array {
  const { extent_m, height_m } = scene.meta;
  return Float32Array.from({ length: SWEEP_STEPS }, (_, i) =>
    pitch_hz(scene.height(((i + 0.5) / SWEEP_STEPS - 0.5) * extent_m[0], y), height_m),
  );
}
