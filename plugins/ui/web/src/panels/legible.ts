/** Whether fingers can read it: what fails, where, and what would cure it. */
import { t } from "../words/handing";
import { late } from "./late";
import "./legible.css";

export const legible = late({ id: "legible", title: t("legible"), place: "left", open: false }, async () => (await import("./legible/panel")).build);
