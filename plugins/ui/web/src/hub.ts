/** The event bus: every part of the page subscribes here, and none imports another for it. */
import type { PageEvents } from "./events";

type Listener<K extends keyof PageEvents> = (event: PageEvents[K]) => void;

export class Hub {
  private listeners = new Map<keyof PageEvents, Listener<never>[]>();
  private latest = new Map<keyof PageEvents, unknown>();

  on<K extends keyof PageEvents>(name: K, listener: Listener<K>): void {
    this.listeners.set(name, [...(this.listeners.get(name) ?? []), listener as Listener<never>]);
  }

  /** Return the latest event of this name, for parts that are built later than the page. */
  last<K extends keyof PageEvents>(name: K): PageEvents[K] | undefined {
    return this.latest.get(name) as PageEvents[K] | undefined;
  }

  /** Call every listener; an exception goes to the console and does not keep the event from the others. */
  tell<K extends keyof PageEvents>(name: K, event: PageEvents[K]): void {
    this.latest.set(name, event);
    for (const listener of this.listeners.get(name) ?? []) {
      try {
        (listener as Listener<K>)(event);
      } catch (error) {
        console.error(error);
      }
    }
  }
}
