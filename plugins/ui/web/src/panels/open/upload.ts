/** Upload of files, one after the other; then they are opened together. */
import type { Server } from "kit/page";
import { token } from "kit/server/token";
import { language } from "kit/words/words";

/** Called with the share of a file that is sent, 0 to 100. */
export type Progress = (name: string, percent: number) => void;

/** Answer of opening: the path of a recording, if it is one. */
export interface Opened {
  recording?: string;
}

/** Upload files and open them. Rejects with the server's text. */
export async function uploadAndOpen(net: Server, files: File[], progress: Progress): Promise<Opened> {
  const batch = await net.ask<string>("batch");
  for (const file of files) await sendFile(batch, file, progress);
  return net.ask<Opened>("open_batch", { batch });
}

/** Send one file of a batch. Rejects with the server's text. */
export function sendFile(batch: string, file: File, progress: Progress): Promise<void> {
  const request = new XMLHttpRequest(); // fetch reports no progress
  const name = encodeURIComponent(file.name);
  return new Promise((done, refused) => {
    request.upload.onprogress = ({ loaded, total }) => progress(file.name, Math.round((100 * loaded) / (total || 1)));
    request.onload = () => (request.status < 300 ? done() : refused(new Error(request.responseText)));
    request.onerror = () => refused(new Error(file.name));
    request.open("PUT", `/upload/${batch}/${name}?token=${encodeURIComponent(token)}&language=${language}`);
    request.send(file);
  });
}
