// Frames of docs/protocol.md.
import { scenarioNames, type ScenarioName } from "./messages";

export { scenarioNames, type ScenarioName };

export const frameFlag = { running: 1, tooCompressed: 2, recorded: 4 } as const;

/** Cells of the map grid that hold debris; rows run from south to north. */
export interface DepthWindow {
  column: number;
  row: number;
  columns: number;
  rows: number;
}

export interface Frame {
  scenario: ScenarioName;
  flags: number;
  time_s: number;
  step: number;
  /** Contains every stride-th particle id, starting with 0. */
  stride: number;
  count: number;
  /** x, y, z (units of `scale`, from `origin`, in the local frame) and speed (units of `speedUnit`), four per particle. */
  particles: Uint16Array;
  origin: [number, number, number];
  scale: [number, number, number];
  speedUnit_mps: number;
  window: DepthWindow;
  /** In units of depthUnit_m and mapSpeedUnit_mps, by rows of the window from the south. */
  depth: Uint16Array;
  mapSpeed: Uint8Array;
  depthUnit_m: number;
  mapSpeedUnit_mps: number;
  /** What it lies in, if it may be given back: see `recycle`. */
  room?: Room;
}

/** Arrays at least as long as what lies in them. */
interface Room { body: Uint8Array; particles: Uint16Array; depth: Uint16Array; mapSpeed: Uint8Array }

/** Of frames that nobody looks at any more. A megabyte for each message would keep the collector of garbage busy. */
const spare: Room[] = [];
const mostSpare = 4;

/** Gives back what a frame lies in: nobody may read it after this. */
export function recycle(frame: Frame): void {
  if (frame.room && spare.length < mostSpare) spare.push(frame.room);
  delete frame.room;
}
/** Longer than asked for, where it must grow: the next one is hardly ever shorter. */
const bytes = (held: Uint8Array, length: number): Uint8Array => (held.length >= length ? held : new Uint8Array(Math.ceil(1.25 * length)));
const words = (held: Uint16Array, length: number): Uint16Array => (held.length >= length ? held : new Uint16Array(Math.ceil(1.25 * length)));

/** Value of x, y and z for a particle that does not exist. */
export const absent = 65535;

/** Script time for unfolding the last frame, ms; the browser decompresses on another thread. */
export const lastDecode = { unfold_ms: 0 };

const headBytes = 88;
const largestBody = 512 * 1024 * 1024;

export class MalformedMessage extends Error {}

/** Decompresses zlib data and fails unless it contains exactly `size` bytes. `into`: gives what takes them. */
export async function inflate(packed: Uint8Array, size: number, into?: (size: number) => Uint8Array): Promise<Uint8Array> {
  if (size > largestBody) throw new MalformedMessage(`body of ${size} bytes; the limit is ${largestBody}`);
  const out = into?.(size) ?? new Uint8Array(size);
  let filled = 0;
  const stream = new Blob([packed as BlobPart]).stream().pipeThrough(new DecompressionStream("deflate"));
  const reader = stream.getReader();
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    if (filled + value.length > size) throw new MalformedMessage(`body holds more than the announced ${size} bytes`);
    out.set(value, filled);
    filled += value.length;
  }
  if (filled !== size) throw new MalformedMessage(`body holds ${filled} bytes; ${size} were announced`);
  return out;
}

export function tag(bytes: Uint8Array): string {
  return String.fromCharCode(bytes[0] ?? 0, bytes[1] ?? 0, bytes[2] ?? 0, bytes[3] ?? 0);
}

/** Undoes the folding of differences: two byte planes of n values each, written to out[first + stride * i]. */
function unfold(body: Uint8Array, at: number, n: number, out: Uint16Array, first: number, stride: number): void {
  let value = 0;
  for (let i = 0, o = first; i < n; ++i, o += stride) {
    const folded = body[at + i]! | (body[at + n + i]! << 8);
    value = (value + ((folded >> 1) ^ -(folded & 1))) & 0xffff;
    out[o] = value;
  }
}

/** reuse: in what frames that were given back have left. */
export async function decodeFrame(data: ArrayBuffer, reuse = false): Promise<Frame> {
  const message = new Uint8Array(data);
  if (data.byteLength < headBytes || tag(message) !== "TLSF") throw new MalformedMessage("no frame");
  const head = new DataView(data);
  if (head.getUint8(4) !== 1) throw new MalformedMessage(`frame of version ${head.getUint8(4)}; this page reads version 1`);
  const slots = head.getUint32(24, true);
  const stride = head.getUint32(28, true);
  if (stride === 0) throw new MalformedMessage("stride 0");
  const [column, row, columns, rows] = [60, 64, 68, 72].map((at) => head.getUint32(at, true)) as [number, number, number, number];
  const n = Math.ceil(slots / stride);
  const m = columns * rows;
  const size = head.getUint32(84, true);
  if (size !== 7 * n + 3 * m) throw new MalformedMessage(`body of ${size} bytes for ${n} particles and ${m} cells`);
  const room: Room = (reuse ? spare.pop() : undefined) ?? { body: new Uint8Array(0), particles: new Uint16Array(0), depth: new Uint16Array(0), mapSpeed: new Uint8Array(0) };
  const body = await inflate(message.subarray(headBytes), size, () => (room.body = bytes(room.body, size)));

  const begun = performance.now();
  room.particles = words(room.particles, 4 * n);
  room.depth = words(room.depth, m);
  room.mapSpeed = bytes(room.mapSpeed, m);
  const particles = room.particles.subarray(0, 4 * n);
  const depth = room.depth.subarray(0, m);
  const mapSpeed = room.mapSpeed.subarray(0, m);
  for (let axis = 0; axis < 3; ++axis) unfold(body, 2 * n * axis, n, particles, axis, 4);
  for (let i = 0; i < n; ++i) particles[4 * i + 3] = body[6 * n + i]!;
  mapSpeed.set(body.subarray(7 * n + 2 * m, size));
  unfold(body, 7 * n, m, depth, 0, 1);
  lastDecode.unfold_ms = performance.now() - begun;
  const three = (at: number): [number, number, number] =>
    [head.getFloat32(at, true), head.getFloat32(at + 4, true), head.getFloat32(at + 8, true)];
  return {
    scenario: scenarioNames[head.getUint8(5)] ?? "A",
    flags: head.getUint16(6, true),
    time_s: head.getFloat64(8, true),
    step: Number(head.getBigUint64(16, true)),
    stride,
    count: n,
    particles,
    origin: three(32),
    scale: three(44),
    speedUnit_mps: head.getFloat32(56, true),
    window: { column, row, columns, rows },
    depth,
    mapSpeed,
    depthUnit_m: head.getFloat32(76, true),
    mapSpeedUnit_mps: head.getFloat32(80, true),
    ...(reuse ? { room } : {}),
  };
}
