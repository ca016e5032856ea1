/** Heights that are dragged are felt: the newest is sent when the one before has arrived. */
export class Live {
  private next: number[] | null = null;
  private sending = false;
  /** What was sent last; nothing, while what is felt is what was opened or saved. */
  private sent = "";

  constructor(
    private ask: (heights_m: number[]) => Promise<unknown>,
    private failed: (error: Error) => void,
  ) {}

  /** Feel these heights, by the number that a part was opened or saved with. base: those that it was with. */
  feel(heights_m: number[], base: number[]): void {
    if (!this.sent && !this.sending && String(heights_m) === String(base)) return;
    this.next = heights_m;
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
        const heights_m = this.next;
        this.next = null;
        if (String(heights_m) === this.sent) continue;
        this.sent = String(heights_m);
        await this.ask(heights_m);
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
