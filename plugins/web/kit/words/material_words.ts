import { words } from "./words";

const t = words({
  plain: ["plain material", "schlichtes Material", "matière neutre"],
  ice: ["ice", "Eis", "glace"],
  glass: ["glass", "Glas", "verre"],
  metal: ["metal", "Metall", "métal"],
  paper: ["paper", "Papier", "papier"],
  leather: ["leather", "Leder", "cuir"],
  wood: ["wood", "Holz", "bois"],
  rubber: ["rubber", "Gummi", "caoutchouc"],
  cloth: ["cloth", "Stoff", "tissu"],
  foam: ["foam", "Schaumstoff", "mousse"],
  carpet: ["carpet", "Teppich", "moquette"],
  sand: ["sand", "Sand", "sable"],
  stone: ["stone", "Stein", "pierre"],
  brick: ["brick", "Ziegel", "brique"],
  skin: ["skin", "Haut", "peau"],
  grass: ["grass", "Gras", "herbe"],
  water: ["water", "Wasser", "eau"],
});

/** Return a material's name in the page's language; one of a user's own library keeps its own. */
export const materialWord = (name: string): string => (t.has(name) ? t(name) : name);
