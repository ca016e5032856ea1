/** Contact and texture to hear: a tap when touched, and noise around speed over grain, as loud as roughness, force and speed make it. */
import type { State } from "./protocol";
import type { Material } from "./messages";

export class Sound {
  private context: AudioContext | null = null;
  private band!: BiquadFilterNode;
  private loud!: GainNode;
  private hum!: OscillatorNode;
  private humLoud!: GainNode;
  private touching = false;

  get state() {
    return this.context ? [this.context.state, this.context.baseLatency] : null;
  }
  async toggle(): Promise<boolean> {
    if (this.context) {
      await this.context.close();
      this.context = null;
      return false;
    }
    const c = (this.context = new AudioContext({ latencyHint: "interactive" }));
    const noise = c.createBuffer(1, 2 * c.sampleRate, c.sampleRate),
      data = noise.getChannelData(0);
    for (let i = 0; i < data.length; i++) data[i] = Math.random() * 2 - 1;
    const source = c.createBufferSource();
    source.buffer = noise;
    source.loop = true;
    this.band = c.createBiquadFilter();
    this.band.type = "bandpass";
    this.loud = c.createGain();
    this.loud.gain.value = 0;
    this.hum = c.createOscillator();
    this.hum.type = "triangle";
    this.humLoud = c.createGain();
    this.humLoud.gain.value = 0;
    source.connect(this.band).connect(this.loud).connect(c.destination);
    source.start();
    this.hum.connect(this.humLoud).connect(c.destination);
    this.hum.start();
    return true;
  }
  hear(s: State, m: Material | null) {
    const c = this.context;
    if (!c) return;
    const force = Math.hypot(...s.force),
      speed = Math.hypot(s.velocity[0], s.velocity[1]),
      touching = (s.flags & 1) === 1;
    if (touching && !this.touching) this.tap(c, Math.min(1, 0.15 + 4 * Math.abs(s.velocity[2])));
    this.touching = touching;
    const rate = m ? speed / m.grain_m : 0,
      level = touching && m ? Math.min(0.35, 900 * m.roughness_m * force * Math.min(1, speed / 0.05)) : 0;
    const periodic = m?.texture === "periodic";
    this.band.frequency.setTargetAtTime(Math.min(8000, Math.max(60, rate)), c.currentTime, 0.01);
    this.band.Q.setTargetAtTime(periodic ? 8 : 0.9, c.currentTime, 0.01);
    this.loud.gain.setTargetAtTime(level, c.currentTime, 0.008);
    this.hum.frequency.setTargetAtTime(Math.min(2000, Math.max(30, rate)), c.currentTime, 0.01);
    this.humLoud.gain.setTargetAtTime(periodic ? 0.5 * level : 0, c.currentTime, 0.008);
  }
  private tap(c: AudioContext, level: number) {
    const o = c.createOscillator(),
      g = c.createGain();
    o.frequency.setValueAtTime(180, c.currentTime);
    o.frequency.exponentialRampToValueAtTime(60, c.currentTime + 0.06);
    g.gain.setValueAtTime(level * 0.4, c.currentTime);
    g.gain.exponentialRampToValueAtTime(1e-4, c.currentTime + 0.09);
    o.connect(g).connect(c.destination);
    o.start();
    o.stop(c.currentTime + 0.1);
  }
}
