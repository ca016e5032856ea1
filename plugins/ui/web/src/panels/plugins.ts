/** Panels of plugins: each is an ES module that the server serves, loaded when its panel is first opened. */
import type { Page } from "kit/page";
import type { Events, PluginPanel } from "kit/server/messages";
import { token } from "kit/server/token";
import { language, type Language, type Table, type Words, words } from "kit/words/words";
import { lazy } from "./lazy";
import type { Panel } from "./panel";

/** The messages of the server that a plugin's panel may listen to; their fields stand in server/messages.ts. */
export const MESSAGES = ["document", "making", "stage", "made", "scene", "touch", "loop", "laws", "gone"] as const;
type Message = (typeof MESSAGES)[number];

/** The one argument of a module's default export, `export default function (panel) { ... }`, which fills `root`. */
export interface PanelInterface {
  /** The empty panel. Headings in it are <h3>; classes for controls stand at the top of style/tokens.css. */
  readonly root: HTMLElement;
  readonly language: Language;
  /** Send a request that the plugin answers; rejects with the text of its error. */
  ask<T>(name: string, args?: Record<string, unknown>): Promise<T>;
  /** Call a listener with the latest message of this name, if there was one, and with each that follows. */
  on<K extends Message>(message: K, listener: (message: Events[K]) => void): void;
  /** Return a function that gives the texts of a table {key: [English, German, French]} in the page's language. */
  words<T extends Table>(table: T): Words<T>;
  /** Announce a text to screen readers. */
  say(text: string): void;
}

type Build = (panel: PanelInterface) => void | Promise<void>;
type Load = (address: string) => Promise<{ default?: unknown }>;

/** Return the panel of a plugin: the last of its task, closed at first. */
export function pluginPanel({ name, title, module, task }: PluginPanel, load: Load = (address) => import(address)): Panel {
  const about = { id: `plugin-${name}`, title: title[language] ?? title.en ?? name, task, open: false } as const;
  return lazy(about, async () => {
    const { default: build } = await load(address(module));
    if (typeof build !== "function") throw new Error(`${module} has no function as its default export`);
    return { build: (page, root) => (build as Build)(panelInterface(name, page, root)) };
  });
}

/** Return the address of a module with this page's key. Throws for an address outside of /panels/. */
export function address(module: string): string {
  if (!/^\/panels\/\w[\w.-]*\/\w[\w.-]*$/.test(module)) throw new Error(`${module} is not an address below /panels/`);
  return `${module}?token=${encodeURIComponent(token)}`;
}

export function panelInterface(name: string, page: Pick<Page, "hub" | "net" | "say">, root: HTMLElement): PanelInterface {
  return {
    root,
    language,
    words,
    ask: (request, args = {}) => page.net.ask("ask_panel", { panel: name, request, arguments: args }),
    on: (message, listener) => {
      if (!MESSAGES.includes(message)) throw new Error(`"${message}" is not a message; there are ${MESSAGES.join(", ")}`);
      const latest = page.hub.last(message);
      if (latest) listener(latest as never);
      page.hub.on(message, listener as never);
    },
    say: (text) => page.say(text, { topic: `plugin ${name}` }),
  };
}
