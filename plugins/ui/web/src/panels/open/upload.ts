/** Files from the browser to the program: sent one after the other, opened together. */
import { token, type Net } from "../../server/connection";

/** Hears how much of a file is sent, 0 to 100. */
export type Progress = (name: string, percent: number) => void;

/** What opening says: the path of a recording, if it is one. */
export interface Opened {
  recording?: string;
}

/** Send files and open them. Rejects with the server's words. */
export async function send(net: Net, files: File[], progress: Progress): Promise<Opened> {
  const batch = await net.ask<string>("batch");
  for (const file of files) await put(batch, file, progress);
  return net.ask<Opened>("open_batch", { batch });
}

function put(batch: string, file: File, progress: Progress): Promise<void> {
  const request = new XMLHttpRequest(); // fetch does not say how much was sent
  const name = encodeURIComponent(file.name);
  return new Promise((done, refused) => {
    request.upload.onprogress = ({ loaded, total }) => progress(file.name, Math.round((100 * loaded) / (total || 1)));
    request.onload = () => (request.status < 300 ? done() : refused(new Error(request.responseText)));
    request.onerror = () => refused(new Error(file.name));
    request.open("PUT", `/upload/${batch}/${name}?token=${encodeURIComponent(token)}`);
    request.send(file);
  });
}
