/** A page's voice: announcements in its two live regions, and aloud if speech is on. */
import type { Hub } from "../hub";
import { Announcer, liveRegions } from "./announcer";
import { Speech } from "./speech";

export function voiceOf(hub: Hub, polite: HTMLElement, assertive: HTMLElement): { speech: Speech; announcer: Announcer } {
  const speech = new Speech(hub);
  const shown = liveRegions(polite, assertive);
  const announcer = new Announcer((message) => {
    shown(message);
    speech.speak(message);
  });
  return { speech, announcer };
}
