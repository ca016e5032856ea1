/** Recordings: record touch, list recordings, play them, replay them with another law, compare two. */
import { button, field, make } from "kit/elements";
import { bulk } from "kit/server/connection";
import type { Page } from "kit/page";
import type { Panel } from "../panel";
import { Player } from "./player";
import { COLUMNS, Ticks } from "./ticks";
import { t } from "./words";
import { outline } from "./force_plot";
import { table } from "./table";
import "./recordings.css";

interface Listed {
  name: string;
  path: string;
  trouble: string;
  law?: string;
  figures?: Record<string, number>;
}

interface Shown extends Listed {
  digest: string;
  rows: number;
  columns: number;
  every: number;
  compared?: Record<string, number>;
}

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4];
const SPANS = 240;

function build(page: Page, root: HTMLElement): void {
  const { hub, net } = page;
  const status = document.createElement("p");
  const say = (text: string): void => {
    status.textContent = text;
    page.say(text);
  };
  const attempt = async (work: () => Promise<void>): Promise<void> => {
    try {
      await work();
    } catch (error) {
      say(t("failed", { why: (error as Error).message }));
    }
  };

  const list = make("select", { id: "records-list", multiple: true, size: 6 });
  const figures = document.createElement("div");
  const view = playback(page);

  async function look(): Promise<void> {
    const listed = await net.ask<Listed[]>("records");
    list.replaceChildren(...listed.map((each) => new Option(line(each), each.path)));
    if (!listed.length) say(t("none"));
  }

  async function show(path: string): Promise<void> {
    load(await net.ask<Shown>("show_record", { path }));
  }

  async function load(shown: Shown): Promise<void> {
    const rows = await (await bulk(`/scene/${shown.digest}/ticks.f32`)).arrayBuffer();
    if (shown.columns !== COLUMNS) throw new Error(`${shown.columns} columns`);
    view.load(new Ticks(new Float32Array(rows)), shown.name);
    figures.replaceChildren(table({ ...shown.figures, ...shown.compared }));
    if (shown.every > 1) say(t("every", { every: shown.every }));
  }

  function chosen(count: number): string[] {
    const paths = [...list.selectedOptions].map((option) => option.value);
    if (paths.length !== count) throw new Error(t(count === 1 ? "chooseOne" : "compareHelp"));
    return paths;
  }

  const record = button(t("record"), () => attempt(async () => void (await net.ask("record"))));
  const stop = button(t("stop"), () => attempt(async () => void (await net.ask("stop_recording"))), { hidden: true });
  hub.on("recorder", ({ recording, path, ticks, why }) => {
    record.hidden = recording;
    stop.hidden = !recording;
    if (recording) say(t("recording", { path }));
    else say(why && why !== BY_HAND ? t("endedEarly", { why }) : t("kept", { path, seconds: (ticks / 1000).toFixed(1) }));
    if (!recording) void attempt(look);
  });
  hub.on("recording", ({ path }) => void attempt(() => show(path)));
  list.ondblclick = () => void attempt(() => show(chosen(1)[0]!));

  root.append(
    record,
    stop,
    field(t("list"), list),
    button(t("refresh"), () => attempt(look)),
    button(t("open"), () => attempt(() => show(chosen(1)[0]!))),
    button(t("tryLaw"), () =>
      attempt(async () => {
        await load(await net.ask<Shown>("try_law", { record: chosen(1)[0] }));
        await look();
      }),
    ),
    button(t("compare"), () =>
      attempt(async () => {
        const [path, other] = chosen(2);
        figures.replaceChildren(table(await net.ask<Record<string, number>>("compare_records", { path, other })));
      }),
    ),
    view.box,
    figures,
    status,
  );
  let looked = false;
  hub.on("maker", () => {
    if (!looked) void attempt(look);
    looked = true;
  });
}

/** The server's reason for a recording that was ended on purpose. */
const BY_HAND = "stopped by hand";

function line({ name, trouble, law, figures }: Listed): string {
  if (trouble) return t("broken", { name });
  return t("line", { name, law: law || "?", seconds: (figures?.seconds ?? 0).toFixed(1) });
}

/** Return the player's controls, hidden while nothing is loaded. */
function playback(page: Page): { box: HTMLElement; load: (ticks: Ticks, name: string) => void } {
  const box = make("fieldset", { hidden: true });
  const legend = document.createElement("legend");
  const place = make("input", { type: "range", id: "records-place", min: "0", step: "0.001" });
  const speed = make("select", { id: "records-speed" });
  for (const times of SPEEDS) speed.add(new Option(t("times", { times }), String(times), times === 1, times === 1));
  const says = document.createElement("output");
  const plot = document.createElement("div");
  let now: Ticks | null = null;

  const player = new Player(page, () => {
    box.hidden = !page.replayed;
    play.textContent = player.playing ? t("pause") : t("play");
    place.value = String(player.seconds);
    if (!page.replayed || !now) return;
    const force = Math.hypot(...page.replayed.force).toFixed(2);
    const text = t("at", { time: player.seconds.toFixed(2), seconds: player.length.toFixed(2), force });
    says.textContent = text;
    place.setAttribute("aria-valuetext", text);
  });
  const play = button(t("play"), () => player.toggle());
  place.oninput = () => player.seek(Number(place.value));
  speed.onchange = () => (player.speed = Number(speed.value));
  box.append(legend, plot, field(t("place"), place), play, field(t("speed"), speed), says);
  box.append(button(t("close"), () => player.close()));

  return {
    box,
    load(ticks, name) {
      now = ticks;
      legend.textContent = `${t("player")}: ${name}`;
      place.max = String(ticks.seconds);
      plot.replaceChildren(outline(ticks.outline(SPANS)));
      player.load(ticks);
    },
  };
}

export const recordings: Panel = { id: "records", title: t("title"), task: "feel", open: false, build };
