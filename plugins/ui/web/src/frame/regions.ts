/** The page's regions: their names, the links that jump to them, and F6, which goes from one to the next. */
import type { Page } from "../page";
import { on } from "../shortcuts";
import { t } from "./words";
import { speak, language, LANGUAGES } from "../words/words";
import { THEMES, type Theme, type Themes } from "./themes";

/** Ids of the regions in the order in which F6 visits them, and of what takes the focus there. */
const REGIONS = { main: "terrain", left: "left", right: "right", bottom: "bottom", head: "head", "parts-editor": "parts-picture" } as const;
type Region = keyof typeof REGIONS;

const regions = Object.keys(REGIONS) as Region[];
const element = (id: string): HTMLElement => document.getElementById(id)!;
/** Those that are there now: the editor of parts takes the place of the columns. */
const shown = (): Region[] => regions.filter((each) => document.getElementById(each)?.checkVisibility());

export function frame(page: Page): void {
  const { themes } = page;
  for (const region of shown()) element(region).setAttribute("aria-label", t(region));
  skipLinks();
  on("next region", () => jump(1));
  on("previous region", () => jump(-1));
  chooseTheme(themes);
  page.hub.on("theme", () => (element("theme") as HTMLSelectElement).value = themes.chosen);
  switchLanguage();
  page.hub.on("shown", ({ meta }) => (document.title = `${meta.name} – ${t("title")}`));
}

function skipLinks(): void {
  const skip = element("skip");
  skip.setAttribute("aria-label", t("jump"));
  for (const region of regions.slice(0, 4)) {
    const link = document.createElement("a");
    link.href = `#${REGIONS[region]}`;
    link.textContent = t(region);
    link.onclick = (event) => {
      event.preventDefault(); // the address keeps the key alone
      element(REGIONS[region]).focus();
    };
    skip.append(link);
  }
}

/** To the next region that is there; where its focus was last, if it was there before. */
const last = new Map<Region, HTMLElement>();

function jump(by: number): void {
  const regions = shown();
  const from = regions.findIndex((each) => element(each).contains(document.activeElement));
  if (from >= 0) last.set(regions[from], document.activeElement as HTMLElement);
  const to = regions[from < 0 ? (by > 0 ? 0 : regions.length - 1) : (from + by + regions.length) % regions.length];
  const before = last.get(to);
  (before?.isConnected && before.checkVisibility() ? before : element(REGIONS[to])).focus();
}

function chooseTheme(themes: Themes): void {
  const choice = element("theme") as HTMLSelectElement;
  choice.setAttribute("aria-label", t("theme"));
  for (const each of THEMES) choice.add(new Option(t(each), each));
  choice.value = themes.chosen;
  choice.onchange = () => themes.choose(choice.value as Theme);
}

/** The button names the other language in that language. */
function switchLanguage(): void {
  const other = LANGUAGES.find((each) => each !== language)!;
  const button = element("language");
  button.lang = other;
  button.textContent = new Intl.DisplayNames([other], { type: "language" }).of(other)!;
  button.onclick = () => speak(other);
}
