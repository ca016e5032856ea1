/** The event bus: every part of the page subscribes here, and none imports another for it. */
import type { PageEvents } from "./events";

/** E: the events by name, with what each carries. */
export class Hub<E extends object = PageEvents> {
  private listeners = new Map<PropertyKey, ((event: never) => void)[]>();
  private latest = new Map<PropertyKey, unknown>();

  on<K extends keyof E>(name: K, listener: (event: E[K]) => void): void {
    this.listeners.set(name, [...(this.listeners.get(name) ?? []), listener as (event: never) => void]);
  }

  /** Return the latest event of this name, for parts that are built later than the page. */
  last<K extends keyof E>(name: K): E[K] | undefined {
    return this.latest.get(name) as E[K] | undefined;
  }

  /** Call every listener; an exception goes to the console and does not keep the event from the others. */
  tell<K extends keyof E>(name: K, event: E[K]): void {
    this.latest.set(name, event);
    for (const listener of this.listeners.get(name) ?? []) {
      try {
        (listener as (event: E[K]) => void)(event);
      } catch (error) {
        console.error(error);
      }
    }
  }
}
