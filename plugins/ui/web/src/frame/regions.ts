/** The page's regions: their names, the links that jump to them, and F6, which goes from one to the next. */
import type { Page } from "kit/page";
import { on } from "kit/shortcuts";
import { t } from "./words";
import { speak, language, LANGUAGES } from "kit/words/words";
import { THEMES, type Theme } from "kit/themes";

/** Ids of the regions in the order of F6, and of the elements that take the focus there. */
const REGIONS = { main: "terrain", left: "left", right: "right", bottom: "bottom", head: "head", "parts-editor": "parts-picture" } as const;
type Region = keyof typeof REGIONS;

const regions = Object.keys(REGIONS) as Region[];
const element = (id: string): HTMLElement => document.getElementById(id)!;
/** Return the visible regions: the parts editor replaces the columns. */
const visibleRegions = (): Region[] => regions.filter((each) => document.getElementById(each)?.checkVisibility());

export function buildRegions(page: Pick<Page, "hub" | "themes">): void {
  const { themes } = page;
  for (const region of regions) document.getElementById(region)?.setAttribute("aria-label", t(region));
  skipLinks();
  new ResizeObserver(([head]) => keepHeight(head!.target as HTMLElement)).observe(element("head"));
  on("next region", () => focusRegion(1));
  on("previous region", () => focusRegion(-1));
  chooseTheme(themes);
  page.hub.on("theme", () => (element("theme") as HTMLSelectElement).value = themes.chosen);
  switchLanguage();
  page.hub.on("shown", ({ meta }) => (document.title = `${meta.name} – ${t("title")}`));
}

/** Keep the height of the head as a token: below it the surface sticks. */
function keepHeight(head: HTMLElement): void {
  document.documentElement.style.setProperty("--head", `${head.offsetHeight}px`);
}

function skipLinks(): void {
  const skip = element("skip");
  skip.setAttribute("aria-label", t("jump"));
  for (const region of ["main", "left"] as const) {
    const link = document.createElement("a");
    link.href = `#${REGIONS[region]}`;
    link.textContent = t(region);
    link.onclick = (event) => {
      event.preventDefault(); // the address must not change
      element(REGIONS[region]).focus();
    };
    skip.append(link);
  }
}

/** Last focused element of each region. */
const last = new Map<Region, HTMLElement>();

function focusRegion(by: number): void {
  const regions = visibleRegions();
  const from = regions.findIndex((each) => element(each).contains(document.activeElement));
  if (from >= 0) last.set(regions[from], document.activeElement as HTMLElement);
  const to = regions[from < 0 ? (by > 0 ? 0 : regions.length - 1) : (from + by + regions.length) % regions.length];
  const before = last.get(to);
  (before?.isConnected && before.checkVisibility() ? before : element(REGIONS[to])).focus();
}

function chooseTheme(themes: Page["themes"]): void {
  const choice = element("theme") as HTMLSelectElement;
  choice.setAttribute("aria-label", t("theme"));
  for (const each of THEMES) choice.add(new Option(t(each), each));
  choice.value = themes.chosen;
  choice.onchange = () => themes.choose(choice.value as Theme);
}

/** Label the button with the other language's own name. */
function switchLanguage(): void {
  const other = LANGUAGES.find((each) => each !== language)!;
  const button = element("language");
  button.lang = other;
  button.textContent = new Intl.DisplayNames([other], { type: "language" }).of(other)!;
  button.onclick = () => speak(other);
}
