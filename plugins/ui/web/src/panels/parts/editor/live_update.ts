/** What is dragged is felt: the newest is sent when the one before has arrived. */

/** By the number that a part was opened or saved with, no height where the program finds it; and the shape of all. */
export interface Felt {
  heights_m: (number | null)[];
  materials: (string | null)[];
  heights: object;
}

export class Live {
  private next: Felt | null = null;
  private sending = false;
  /** What was sent last; nothing, while what is felt is what was opened or saved. */
  private sent = "";

  constructor(
    private ask: (felt: Felt) => Promise<unknown>,
    private failed: (error: Error) => void,
  ) {}

  /** base: what was opened or saved. */
  feel(felt: Felt, base: Felt): void {
    if (!this.sent && !this.sending && JSON.stringify(felt) === JSON.stringify(base)) return;
    this.next = felt;
    if (!this.sending) void this.go();
  }

  /** What was sent is what is felt for good: it was saved. */
  settled(): void {
    this.next = null;
    this.sent = "";
  }

  private async go(): Promise<void> {
    this.sending = true;
    try {
      while (this.next) {
        const felt = this.next;
        this.next = null;
        const said = JSON.stringify(felt);
        if (said === this.sent) continue;
        this.sent = said;
        await this.ask(felt);
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
