/** The description: what is felt, in words. */
import { t } from "../words/handing";
import { late } from "./late";
import "./description.css";

export const description = late(
  { id: "description", title: t("description"), place: "left", open: false },
  async () => (await import("./description/panel")).build,
);
