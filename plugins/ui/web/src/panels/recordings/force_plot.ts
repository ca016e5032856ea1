/** The force over time, as a small plot. */
import { t } from "./words";

const SVG = "http://www.w3.org/2000/svg";
const HEIGHT = 60;

export function outline(forces: Float32Array): SVGElement {
  const most = Math.max(...forces, 1e-9);
  const plot = document.createElementNS(SVG, "svg");
  plot.setAttribute("viewBox", `0 0 ${forces.length} ${HEIGHT}`);
  plot.setAttribute("preserveAspectRatio", "none");
  plot.setAttribute("role", "img");
  plot.setAttribute("aria-label", t("force", { most: most.toFixed(2) }));
  plot.classList.add("outline");
  const path = document.createElementNS(SVG, "path");
  const points = [...forces].map((force, i) => `L${i} ${(HEIGHT * (1 - force / most)).toFixed(1)}`);
  path.setAttribute("d", `M0 ${HEIGHT}${points.join("")}L${forces.length - 1} ${HEIGHT}Z`);
  plot.append(path);
  return plot;
}
