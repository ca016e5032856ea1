/** Who hears what: every part of the page subscribes here, and none knows another. */
import type { Events } from "./server/messages";

type Hear<K extends keyof Events> = (event: Events[K]) => void;

export class Hub {
  private hears = new Map<keyof Events, Hear<never>[]>();
  private told = new Map<keyof Events, unknown>();

  on<K extends keyof Events>(name: K, hear: Hear<K>): void {
    this.hears.set(name, [...(this.hears.get(name) ?? []), hear as Hear<never>]);
  }

  /** What was told last under this name, for what comes later than the page. */
  last<K extends keyof Events>(name: K): Events[K] | undefined {
    return this.told.get(name) as Events[K] | undefined;
  }

  /** One that fails is told in the console; the rest still hear. */
  tell<K extends keyof Events>(name: K, event: Events[K]): void {
    this.told.set(name, event);
    for (const hear of this.hears.get(name) ?? []) {
      try {
        (hear as Hear<K>)(event);
      } catch (error) {
        console.error(error);
      }
    }
  }
}
