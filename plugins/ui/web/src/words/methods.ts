import { words } from "./words";

export const t = words({
  title: ["Methods", "Verfahren"],
  make: ["Make and feel", "Berechnen und fühlen"],
  stopMaking: ["Stop making", "Berechnung abbrechen"],
});
