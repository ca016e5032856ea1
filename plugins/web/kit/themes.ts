/** Themes: light, dark and high contrast, by the system or by choice. The colours are the tokens of style/tokens.css. */
import type { Hub } from "./hub";
import { recall, remember } from "./preferences";

export const THEMES = ["system", "light", "dark", "contrast-light", "contrast-dark"] as const;
export type Theme = (typeof THEMES)[number];

const KEPT = "theme";
const dark = matchMedia("(prefers-color-scheme: dark)");
const contrast = matchMedia("(prefers-contrast: more)");

export class Themes {
  constructor(private hub: Hub) {
    for (const asked of [dark, contrast, matchMedia("(forced-colors: active)")]) {
      asked.addEventListener("change", () => this.apply());
    }
    this.apply();
  }

  get chosen(): Theme {
    const kept = recall<string>(KEPT, "system");
    return THEMES.find((each) => each === kept) ?? "system";
  }

  choose(theme: Theme): void {
    remember(KEPT, theme);
    this.apply();
  }

  private apply(): void {
    const [more, scheme] = split(this.chosen);
    const { dataset } = document.documentElement;
    dataset.scheme = scheme ?? (dark.matches ? "dark" : "light");
    dataset.contrast = (more ?? contrast.matches) ? "more" : "usual";
    this.hub.tell("theme", { chosen: this.chosen, dark: dataset.scheme === "dark", contrast: dataset.contrast === "more" });
  }
}

/** Return whether a theme has high contrast, and its scheme; undefined for what the system decides. */
function split(theme: Theme): [more?: boolean, scheme?: "light" | "dark"] {
  if (theme === "system") return [];
  return [theme.startsWith("contrast"), theme.endsWith("dark") ? "dark" : "light"];
}

const probe = document.createElement("span");

/** Return a token's present colour as rgb(...), for drawings. Ask again on the event `theme`. */
export function colour(token: `--${string}`): string {
  probe.hidden = true;
  probe.style.setProperty("forced-color-adjust", "none"); // else every token is the system's colour of text
  probe.style.setProperty("color", `var(${token})`);
  if (!probe.isConnected) document.body.append(probe);
  return getComputedStyle(probe).color;
}
