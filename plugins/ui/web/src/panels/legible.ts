/** Whether fingers can read it: what fails, where, and what would cure it. */
import { t } from "./words";
import { late } from "./lazy";
import "./legibility/legibility.css";

export const legible = late({ id: "legible", title: t("legible"), place: "left", open: false }, async () => (await import("./legibility/panel")).build);
