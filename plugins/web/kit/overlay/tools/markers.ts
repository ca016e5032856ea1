/** Numbered markers on the surface. */
import type { Page } from "../../page";
import type { Vec } from "../../server/protocol";
import { on } from "../../shortcuts";
import { t } from "../words";
import { Handle, STEP_M } from "./handle";

export interface Marker {
  number: number;
  at: Vec;
  remove(): void;
}

export class Markers {
  list: Marker[] = [];
  /** Called when the markers changed. */
  onChange: () => void = () => {};
  private last = 0;

  constructor(private page: Pick<Page, "hub" | "view" | "overlay" | "scene" | "say">) {
    page.hub.on("shown", (scene) => {
      for (const each of this.list) each.at = scene.on(each.at[0], each.at[1]);
      this.onChange();
    });
    on("mark", () => this.addHere());
  }

  /** Add a marker at the hand, or at the middle of the view. */
  addHere(): void {
    const { scene, overlay, view } = this.page;
    const live = overlay.live?.seen ? overlay.live : null;
    const [x, y] = live ? live.hand : view.eye.pose.target;
    if (scene) this.add(scene.on(x, y));
  }

  add(at: Vec): void {
    const { scene, overlay } = this.page;
    const number = ++this.last;
    const put = (to: Vec): void => {
      marker.at = to;
      overlay.changed = true;
      this.onChange();
    };
    const handle = new Handle(this.page, "round", t("marker", { number }), {
      at: () => (overlay.settings.show.markers ? marker.at : null),
      drag: put,
      nudge: (right, away) => scene && put(scene.on(marker.at[0] + right * STEP_M, marker.at[1] + away * STEP_M)),
    });
    handle.element.dataset.sign = `${number}`;
    const marker: Marker = {
      number,
      at,
      remove: () => {
        handle.remove();
        this.list = this.list.filter((each) => each !== marker);
        this.onChange();
      },
    };
    this.list.push(marker);
    this.page.say(t("marked", { number }));
    this.onChange();
  }
}
