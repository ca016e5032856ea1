/** Latest-wins sending: while an update is under way, only the newest of the following ones is kept. */

/** Heights and materials by the number of the part in the file (null: the program finds it), and the shape of all parts. */
export interface Update {
  heights_m: (number | null)[];
  materials: (string | null)[];
  heights: object;
}

export class LiveUpdate {
  private next: Update | null = null;
  private sending = false;
  /** The update that was sent last, as JSON; empty while the surface is as it was opened or saved. */
  private sent = "";

  constructor(
    private ask: (update: Update) => Promise<unknown>,
    private failed: (error: Error) => void,
  ) {}

  /** Send an update, unless the surface equals it already. base: the update of the opened or saved parts. */
  send(update: Update, base: Update): void {
    if (!this.sent && !this.sending && JSON.stringify(update) === JSON.stringify(base)) return;
    this.next = update;
    if (!this.sending) void this.run();
  }

  /** Take the present surface as the base: it was saved. */
  reset(): void {
    this.next = null;
    this.sent = "";
  }

  private async run(): Promise<void> {
    this.sending = true;
    try {
      while (this.next) {
        const update = this.next;
        this.next = null;
        const text = JSON.stringify(update);
        if (text === this.sent) continue;
        this.sent = text;
        await this.ask(update);
      }
    } catch (error) {
      this.next = null;
      this.sent = "";
      this.failed(error as Error);
    } finally {
      this.sending = false;
    }
  }
}
