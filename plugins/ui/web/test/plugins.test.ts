import assert from "node:assert/strict";
import { before, describe, test } from "node:test";
import { Hub } from "kit/hub";
import type * as Plugins from "../src/panels/plugins";
import type { Panel } from "../src/panels/panel";
import type { PluginPanel } from "kit/server/messages";

const GLOVE: PluginPanel = { name: "glove", title: { en: "Glove", de: "Handschuh" }, module: "/panels/glove/module.js", task: "advanced" };

/** A page of a hub and a server that answers with what was asked. */
function fake() {
  const hub = new Hub();
  const announced: string[] = [];
  const net = { ask: (name: string, args?: object) => Promise.resolve([name, args]) };
  return { hub, announced, page: { hub, net, say: (text: string) => announced.push(text) } as never };
}

/** The elements that a panel touches, as far as it touches them. */
function panelElement(open: boolean) {
  const listeners: (() => void)[] = [];
  const box = { open, checkVisibility: () => true, addEventListener: (_: string, listener: () => void) => listeners.push(listener) };
  const root = { textContent: "", closest: () => box, replaceChildren: () => undefined };
  return { root: root as never as HTMLElement, toggle: (on: boolean) => ((box.open = on), listeners.forEach((each) => each())) };
}

const settled = (): Promise<void> => new Promise((done) => setTimeout(done));

describe("plugin panel", () => {
  let plugins: typeof Plugins;

  before(async () => {
    Object.assign(globalThis, { location: { href: "http://localhost/?token=secret%2F1" }, history: { replaceState: () => undefined } });
    Object.assign(globalThis, { sessionStorage: { getItem: () => null, setItem: () => undefined } });
    plugins = await import("../src/panels/plugins");
  });

  test("title is the one in the page's language, else English, else the name", () => {
    const title = (all: Record<string, string>): string => plugins.pluginPanel({ ...GLOVE, title: all }).title;
    assert.deepEqual([title({ en: "Glove", fr: "Gant" }), title({ en: "Glove" }), title({ fr: "Gant" })], ["Glove", "Glove", "glove"]);
  });

  test("module is loaded once, when the panel is first opened, with the page's key", async () => {
    const loaded: string[] = [];
    const built: string[] = [];
    const build = ({ language }: Plugins.PanelInterface): void => void built.push(language);
    const panel: Panel = plugins.pluginPanel(GLOVE, async (address) => (loaded.push(address), { default: build }));
    const { root, toggle } = panelElement(false);
    void panel.build(fake().page, root);
    await settled();
    assert.deepEqual(loaded, []);
    for (const on of [true, false, true]) toggle(on), await settled();
    assert.deepEqual([loaded, built], [["/panels/glove/module.js?token=secret%2F1"], ["en"]]);
  });

  test("module that fails shows why and is tried again when opened again", async () => {
    let tries = 0;
    const panel = plugins.pluginPanel(GLOVE, async () => (tries++, {}));
    const { root, toggle } = panelElement(true);
    void panel.build(fake().page, root);
    await settled();
    assert.match(root.textContent!, /no function as its default export/);
    toggle(true);
    await settled();
    assert.equal(tries, 2);
  });

  test("address outside of /panels/ is refused", () => {
    for (const module of ["//evil.example/panels/a/b.js", "https://evil.example/panels/a/b.js", "/panels/../app.js", "/scene/a/b.js", "/panels/a/b/c.js"])
      assert.throws(() => plugins.address(module), /not an address below/, module);
  });

  test("request carries the plugin's name and returns the answer", async () => {
    const { page } = fake();
    assert.deepEqual(await plugins.panelInterface("glove", page, panelElement(true).root).ask("stretch", { by: 2 }), ["ask_panel", { panel: "glove", request: "stretch", arguments: { by: 2 } }]);
  });

  test("listener gets the latest message at once and each that follows", () => {
    const { hub, page } = fake();
    const heard: string[] = [];
    hub.tell("touch", { law: "proxy" } as never);
    plugins.panelInterface("glove", page, panelElement(true).root).on("touch", ({ law }) => heard.push(law));
    hub.tell("touch", { law: "penalty" } as never);
    assert.deepEqual(heard, ["proxy", "penalty"]);
  });

  test("unknown message is refused with the names of those there are", () => {
    const panel = plugins.panelInterface("glove", fake().page, panelElement(true).root);
    assert.throws(() => panel.on("drawn" as never, () => undefined), /"drawn" is not a message; there are document, /);
  });

  test("words and announcements are the page's", () => {
    const { announced, page } = fake();
    const panel = plugins.panelInterface("glove", page, panelElement(true).root);
    const t = panel.words({ worn: ["{hand} glove is worn", "Handschuh {hand} wird getragen"] });
    panel.say(t("worn", { hand: "left" }));
    assert.deepEqual(announced, ["left glove is worn"]);
  });
});
