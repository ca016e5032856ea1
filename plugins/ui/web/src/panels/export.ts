/** Export: files for others, made of the document as it is on the screen. */
import { t } from "./words";
import { late } from "./lazy";
import "./export/export.css";

export const handOn = late({ id: "export", title: t("export"), place: "left", open: false }, async () => (await import("./export/panel")).build);
