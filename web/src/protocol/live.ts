// The half of docs/protocol.md that a WebSocket carries: connects, reconnects after a break, decodes frames in order.
import { decodeFrame, type Frame, type ScenarioName } from "./frame";
import type { PageMessage, Place, ServerMessage } from "./messages";
import type { Transport, Wire } from "./transport";

export type Connection = "connecting" | "open" | "lost" | "refused";
export interface View { scenarios: ScenarioName[]; rate_hz: number; particle_cap: number }

export interface LiveEvents {
  message(message: ServerMessage): void;
  frame(frame: Frame): void;
  connection(connection: Connection, retryInSeconds: number): void;
  /** Asked after a break, before it connects again: a server that refuses a WebSocket cannot say why. False: it does not. */
  mayReturn(): Promise<boolean>;
}

const firstWait_s = 0.5;
const longestWait_s = 8;

export class Live {
  private wire: Wire | null = null;
  private isOpen = false;
  private wait_s = firstWait_s;
  private everOpen = false;
  private asking = false;
  private view: View | null = null;
  /** Given by the last hello: sent again after a break, so that the person is recognised. */
  secret: string | null = null;
  private timer: number | undefined;
  // Of each scenario only the newest frame that waits is kept: a page that cannot keep up shows fewer frames.
  private readonly waiting = new Map<number, ArrayBuffer>();
  private decoding = false;
  /** Time for decoding the last frame, on this thread and others, ms. */
  decode_ms = 0;

  constructor(private readonly transport: Transport, private name: string, private readonly events: LiveEvents) {}

  start(): void {
    this.events.connection(this.everOpen ? "lost" : "connecting", 0);
    const wire: Wire = this.transport.connect(this.name, this.secret, {
      opened: () => {
        this.everOpen = this.isOpen = true;
        this.wait_s = firstWait_s;
        this.events.connection("open", 0);
        if (this.view) this.send({ type: "view", ...this.view });
      },
      message: (data) => {
        if (typeof data === "string") this.events.message(JSON.parse(data) as ServerMessage);
        else this.take(data);
      },
      closed: () => {
        if (this.wire !== wire) return;
        this.wire = null;
        this.isOpen = false;
        this.events.connection("lost", this.wait_s);
        this.timer = window.setTimeout(() => void this.again(), this.wait_s * 1000);
        this.wait_s = Math.min(2 * this.wait_s, longestWait_s);
      },
    });
    this.wire = wire;
  }
  /** Retries immediately instead of waiting. */
  retry(): void {
    if (this.wire) return;
    clearTimeout(this.timer);
    void this.again();
  }
  /** Drops the connection as a break in the network would; it reconnects by itself. */
  drop(): void {
    this.wire?.close();
  }
  show(view: View): void {
    this.view = view;
    this.send({ type: "view", ...view });
  }
  mark(at: Place | null): void {
    this.send({ type: "mark", at });
  }
  rename(name: string): void {
    this.name = name;
    this.send({ type: "name", name });
  }

  private async again(): Promise<void> {
    if (this.asking) return;
    this.asking = true;
    const mayReturn = await this.events.mayReturn();
    this.asking = false;
    if (mayReturn) this.start();
  }
  private send(message: PageMessage): void {
    if (this.isOpen) this.wire?.send(JSON.stringify(message));
  }
  private take(data: ArrayBuffer): void {
    this.waiting.set(new Uint8Array(data)[5] ?? 0, data);
    if (!this.decoding) void this.drain();
  }
  private async drain(): Promise<void> {
    this.decoding = true;
    for (;;) {
      const next = this.waiting.entries().next();
      if (next.done) break;
      const [scenario, data] = next.value;
      this.waiting.delete(scenario);
      const begun = performance.now();
      try {
        const frame = await decodeFrame(data, true);
        this.decode_ms = performance.now() - begun;
        this.events.frame(frame);
      } catch (error) {
        console.error(error);
      }
    }
    this.decoding = false;
  }
}
