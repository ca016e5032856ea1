/** Files dropped anywhere on the page. */
import { make } from "kit/elements";
import { t } from "./words";

export function onDrop(take: (files: File[]) => void): void {
  const shade = make("div", { className: "drop", textContent: t("drop"), hidden: true });
  document.body.append(shade);
  const hasFiles = (event: DragEvent): boolean => event.dataTransfer?.types.includes("Files") ?? false;
  document.addEventListener("dragover", (event) => {
    if (!hasFiles(event)) return;
    event.preventDefault();
    shade.hidden = false;
  });
  document.addEventListener("dragleave", (event) => {
    if (!event.relatedTarget) shade.hidden = true;
  });
  document.addEventListener("drop", (event) => {
    if (!hasFiles(event)) return;
    event.preventDefault();
    shade.hidden = true;
    take([...event.dataTransfer!.files]);
  });
}
