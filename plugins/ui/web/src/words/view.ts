import { words } from "./words";

export const t = words({
  title: ["View", "Ansicht"],
  shows: ["The surface shows", "Die Oberfläche zeigt"],
  photo: ["the picture", "das Bild"],
  height: ["heights", "Höhen"],
  materials: ["materials", "Materialien"],
  relief: ["the relief alone", "nur das Relief"],
});
