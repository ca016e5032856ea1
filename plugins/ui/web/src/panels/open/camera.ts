/** A picture from the camera, which is on only between the person's start and the picture. */
import { button, make } from "kit/elements";
import { t } from "./words";

export function camera(take: (files: File[]) => void, say: (text: string) => void): HTMLElement {
  const box = document.createElement("div");
  const video = make("video", { muted: true, playsInline: true, hidden: true });
  video.setAttribute("aria-label", t("cameraPicture"));
  let stream: MediaStream | null = null;

  function show(on: boolean): void {
    video.hidden = shoot.hidden = off.hidden = !on;
    start.hidden = on;
  }

  function stop(): void {
    for (const track of stream?.getTracks() ?? []) track.stop();
    stream = null;
    video.srcObject = null;
    show(false);
  }

  const start = button(t("cameraStart"), async () => {
    try {
      stream = await navigator.mediaDevices.getUserMedia({ video: { width: { ideal: 1920 } } });
      video.srcObject = stream;
      await video.play();
      show(true);
    } catch (error) {
      stop();
      say(t("cameraNone", { why: (error as Error).message }));
    }
  });
  const shoot = button(t("cameraTake"), () => {
    const canvas = make("canvas", { width: video.videoWidth, height: video.videoHeight });
    canvas.getContext("2d")!.drawImage(video, 0, 0);
    const name = `camera-${new Date().toISOString().slice(0, 19).replaceAll(":", "-")}.png`;
    canvas.toBlob((blob) => blob && take([new File([blob], name, { type: "image/png" })]), "image/png");
    stop();
  });
  const off = button(t("cameraStop"), stop);
  show(false);
  box.append(start, video, shoot, off);
  return box;
}
