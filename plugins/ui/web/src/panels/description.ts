/** The description: what is felt, in words. */
import { t } from "./words";
import { late } from "./lazy";
import "./description/description.css";

export const description = late(
  { id: "description", title: t("description"), place: "left", open: false },
  async () => (await import("./description/panel")).build,
);
