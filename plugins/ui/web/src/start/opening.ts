/** The picture that is opened, until its surface is there. */
import { token } from "kit/server/token";
import type { Page } from "kit/page";

export function showOpening(page: Pick<Page, "hub">): void {
  const picture = Object.assign(new Image(), { id: "opening", alt: "", hidden: true });
  document.getElementById("scenery")!.append(picture);
  const hide = (): void => {
    picture.hidden = true;
    picture.removeAttribute("src");
  };
  let isOpening = false;
  page.hub.on("opening", ({ at_s, name, picture: isShown }) => {
    isOpening = isShown;
    if (!isShown) return hide();
    picture.alt = name;
    picture.src = `opening?${new URLSearchParams({ token, at: `${at_s}` })}`;
    picture.hidden = false;
  });
  picture.onerror = hide;
  page.hub.on("shown", () => {
    isOpening = false;
    hide();
  });
  page.hub.on("error", () => isOpening && hide());
  page.hub.on("made", ({ outcome }) => outcome !== "made" && isOpening && hide());
}
