/** The voices as a graph of Web Audio, for the loudspeaker and for tests that render it. */
import { makeup, type Stroke } from "./sonification";

const SMOOTH_S = 0.012;
/** Level of the height's voice: soft, as it lasts. */
const HEIGHT_LEVEL = 0.08;
const FORCE_HZ = 110;

export class Instrument {
  private band: BiquadFilterNode;
  private noise: GainNode;
  private tone: OscillatorNode;
  private toneGain: GainNode;
  private height: OscillatorNode;
  private heightGain: GainNode;
  private forceGain: GainNode;
  private panner: StereoPannerNode;
  private out: GainNode;
  readonly meter: AnalyserNode;

  constructor(readonly context: BaseAudioContext) {
    const limiter = new DynamicsCompressorNode(context, { threshold: -12, knee: 6, ratio: 20, attack: 0.002, release: 0.1 });
    this.meter = new AnalyserNode(context, { fftSize: 2048 });
    this.out = new GainNode(context, { gain: 1 });
    this.out.connect(limiter).connect(this.meter).connect(context.destination);
    this.panner = new StereoPannerNode(context);
    this.panner.connect(this.out);
    this.band = new BiquadFilterNode(context, { type: "bandpass", frequency: 200 });
    this.noise = this.silent();
    hiss(context).connect(this.band).connect(this.noise);
    this.toneGain = this.silent();
    this.tone = this.voice("triangle", 100, this.toneGain);
    this.heightGain = this.silent();
    this.height = this.voice("sine", 220, this.heightGain);
    this.forceGain = this.silent();
    this.voice("sine", FORCE_HZ, this.forceGain);
  }

  /** Set the volume, clamped to 0 to 1. */
  set volume(volume: number) {
    this.out.gain.setTargetAtTime(Math.min(1, Math.max(0, volume)), this.context.currentTime, SMOOTH_S);
  }

  stroke({ noise, tone, creaks }: Stroke): void {
    this.tone.type = creaks ? "sawtooth" : "triangle";
    this.glide(this.band.frequency, noise.hz);
    this.glide(this.band.Q, noise.q);
    this.glide(this.noise.gain, noise.level * makeup(noise, this.context.sampleRate));
    this.glide(this.tone.frequency, tone.hz);
    this.glide(this.toneGain.gain, tone.level);
  }

  /** Set the pitch of the height; null: silent. */
  heightAt(hz: number | null): void {
    if (hz !== null) this.glide(this.height.frequency, hz);
    this.glide(this.heightGain.gain, hz === null ? 0 : HEIGHT_LEVEL);
  }

  force(level: number): void {
    this.glide(this.forceGain.gain, level);
  }

  pan(side: number): void {
    this.glide(this.panner.pan, side);
  }

  tap({ hz, level, seconds }: { hz: number; level: number; seconds: number }): void {
    const { context } = this;
    const from = context.currentTime;
    const gain = new GainNode(context, { gain: level });
    const voice = new OscillatorNode(context, { frequency: hz });
    voice.frequency.exponentialRampToValueAtTime(hz / 3, from + seconds);
    gain.gain.exponentialRampToValueAtTime(1e-4, from + seconds);
    voice.connect(gain).connect(this.panner);
    voice.start(from);
    voice.stop(from + seconds);
  }

  /** Play a row of pitches from left to right; return the oscillator, which ends with it. */
  sweep(pitches_hz: Float32Array, seconds: number): OscillatorNode {
    const { context } = this;
    const from = context.currentTime + 0.03;
    const voice = new OscillatorNode(context);
    const gain = new GainNode(context, { gain: 0 });
    const side = new StereoPannerNode(context, { pan: -1 });
    voice.frequency.setValueCurveAtTime(pitches_hz, from, seconds);
    side.pan.setValueCurveAtTime([-1, 1], from, seconds);
    gain.gain.setTargetAtTime(2 * HEIGHT_LEVEL, from, SMOOTH_S);
    gain.gain.setTargetAtTime(0, from + seconds, SMOOTH_S);
    voice.connect(gain).connect(side).connect(this.out);
    voice.start(from);
    voice.stop(from + seconds + 0.1);
    return voice;
  }

  private silent(): GainNode {
    const gain = new GainNode(this.context, { gain: 0 });
    gain.connect(this.panner);
    return gain;
  }

  private voice(type: OscillatorType, frequency: number, gain: GainNode): OscillatorNode {
    const voice = new OscillatorNode(this.context, { type, frequency });
    voice.connect(gain);
    voice.start();
    return voice;
  }

  private glide(parameter: AudioParam, value: number): void {
    parameter.setTargetAtTime(value, this.context.currentTime, SMOOTH_S);
  }
}

/** Return a loop of two seconds of noise. */
function hiss(context: BaseAudioContext): AudioBufferSourceNode {
  const buffer = context.createBuffer(1, 2 * context.sampleRate, context.sampleRate);
  const data = buffer.getChannelData(0);
  for (let i = 0; i < data.length; i++) data[i] = 2 * Math.random() - 1;
  const source = new AudioBufferSourceNode(context, { buffer, loop: true });
  source.start();
  return source;
}
