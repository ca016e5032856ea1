import { words } from "../../words/words";

export const t = words({
  title: ["Materials", "Materialien"],
  none: ["The surface has a single material: no texture method found segments, or the force law uses none.",
    "Die Oberfläche ist ein einziges Material: Es wurden keine Segmente gefunden, oder das Kraftgesetz braucht keine."],
  segments: ["Segments of the surface", "Segmente der Oberfläche"],
  segment: ["Segment", "Segment"],
  share: ["Area", "Fläche"],
  material: ["Material", "Material"],
  why: ["Why", "Warum"],
  choose: ["Material of segment {number}", "Material von Segment {number}"],
  library: ["The library ({count} materials)", "Die Bibliothek ({count} Materialien)"],
  libraryAlone: ["The library", "Die Bibliothek"],
  source: ["Source", "Quelle"],
  name: ["Name", "Name"],
  stiffness: ["Stiffness, N/m", "Steifigkeit, N/m"],
  damping: ["Damping, N s/m", "Dämpfung, N s/m"],
  friction: ["Friction, static / dynamic", "Reibung, haftend / gleitend"],
  roughness: ["Roughness, µm", "Rauheit, µm"],
  grain: ["Grain, mm", "Körnung, mm"],
  texture: ["Texture", "Textur"],
});
