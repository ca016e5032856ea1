/** Lines of the log, a limited number; a repeated line counts up. */

export const LEVELS = ["event", "detail", "warning", "error"] as const;
export type Level = (typeof LEVELS)[number];

export interface Line {
  level: Level;
  text: string;
  /** The end of the text that comes from the program, in English. */
  foreign: string;
  /** Unix time of the last occurrence. */
  at_s: number;
  times: number;
}

export const MAX_LINES = 2000;

export class Lines {
  readonly all: Line[] = [];

  constructor(private most = MAX_LINES) {}

  /** Add a line; return it, whether it repeats the last one, and the line dropped for it. */
  add(level: Level, text: string, at_s: number, foreign = ""): { line: Line; again: boolean; dropped: Line | undefined } {
    const before = this.all.at(-1);
    if (before && before.level === level && before.text === text) {
      before.times++;
      before.at_s = at_s;
      return { line: before, again: true, dropped: undefined };
    }
    const line = { level, text, foreign, at_s, times: 1 };
    this.all.push(line);
    return { line, again: false, dropped: this.all.length > this.most ? this.all.shift() : undefined };
  }

  clear(): void {
    this.all.length = 0;
  }
}

/** Return whether a line is shown: its level is, and it contains every word of the search. */
export function isShown({ level, text }: Line, levels: ReadonlySet<Level>, wanted: string): boolean {
  const small = text.toLowerCase();
  return levels.has(level) && wanted.toLowerCase().split(/\s+/).every((word) => small.includes(word));
}

/** Return lines as text, with full times. */
export function asText(lines: Line[]): string {
  return lines.map(({ level, text, at_s, times }) => `${new Date(1000 * at_s).toISOString()} ${level} ${text}${times > 1 ? ` (x ${times})` : ""}\n`).join("");
}
