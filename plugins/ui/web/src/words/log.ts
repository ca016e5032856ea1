import { words } from "./words";

export const t = words({
  title: ["Log", "Protokoll"],
  lines: ["Log lines", "Zeilen des Protokolls"],
});
