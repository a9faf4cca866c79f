// The tape of a published twin (docs/publish.md): what a session has said and would answer.
import { inflate, MalformedMessage } from "./frame";

/** Where a body lies; `whole`: its length once inflated, where it is deflated. */
interface Kept { type: string; at: number; size: number; whole?: number; time_s?: number }
interface Head { messages: { type: string }[]; answers: Record<string, Kept>; times: Record<string, Kept[]> }
export interface Found { type: string; body: Uint8Array }

const mark = "TLST";
const version = 1;
const startOfHead = 16;
const largestHead = 64 * 1024 * 1024;
const almost_s = 1e-6;

/** Of the last one at or before a time; they are in the order of time. The first one before all of them. */
function lastUntil(times: readonly number[], time_s: number): number {
  const after = times.findIndex((one) => one > time_s + almost_s);
  return after < 0 ? times.length - 1 : Math.max(0, after - 1);
}

export class Tape {
  private constructor(private readonly head: Head, private readonly bodies: Uint8Array) {}

  /** Throws a MalformedMessage. */
  static async open(bytes: Uint8Array): Promise<Tape> {
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    if (bytes.length < startOfHead || String.fromCharCode(...bytes.subarray(0, 4)) !== mark) throw new MalformedMessage("This file holds no recording of talus.");
    if (view.getUint32(4, true) !== version) throw new MalformedMessage(`The recording has version ${view.getUint32(4, true)}; this page reads version ${version}.`);
    const [packed, whole] = [view.getUint32(8, true), view.getUint32(12, true)];
    if (startOfHead + packed > bytes.length || whole > largestHead) throw new MalformedMessage("The recording is cut off: get the file again.");
    const head = JSON.parse(new TextDecoder().decode(await inflate(bytes.subarray(startOfHead, startOfHead + packed), whole))) as Head;
    return new Tape(head, bytes.subarray(startOfHead + packed));
  }
  get messages(): readonly { type: string }[] {
    return this.head.messages;
  }
  /** Of an address that has answers as of times: those times, s. */
  times(address: string): number[] {
    return (this.head.times[address] ?? []).map((kept) => kept.time_s ?? 0);
  }
  /** The times of the answers on both sides of a time; the same one twice at an answer and outside them. null: there are none. */
  around(address: string, time_s: number): [number, number] | null {
    const times = this.times(address);
    if (times.length === 0) return null;
    const before = lastUntil(times, time_s);
    const [from, to] = [times[before], times[before + 1]];
    return to === undefined || time_s <= from + almost_s ? [from, from] : [from, to];
  }
  /** Now, or the last one at or before a time; the first one before all of them. null: there is none. */
  async find(address: string, time_s: number | null): Promise<Found | null> {
    const series = this.head.times[address];
    const kept = time_s === null || series === undefined ? (this.head.answers[address] ?? series?.at(-1)) : series[lastUntil(this.times(address), time_s)];
    if (kept === undefined) return null;
    if (kept.at + kept.size > this.bodies.length) throw new MalformedMessage("The recording is cut off: get the file again.");
    const body = this.bodies.subarray(kept.at, kept.at + kept.size);
    return { type: kept.type, body: kept.whole === undefined ? body : await inflate(body, kept.whole) };
  }
}
