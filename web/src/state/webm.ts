// A film as a WebM file: pictures that are encoded already, each with its time. Matroska (RFC 9559) with one video track.

/** Time in ms from the start. */
export interface Encoded { time_ms: number; key: boolean; bytes: Uint8Array }

type Part = Uint8Array | number[];

const text = (value: string): number[] => [...value].map((c) => c.charCodeAt(0));

/** A whole number in as few bytes as it needs. */
function whole(value: number): number[] {
  const bytes = [];
  for (let rest = value; rest > 0 || bytes.length === 0; rest = Math.floor(rest / 256)) bytes.unshift(rest % 256);
  return bytes;
}
function float(value: number): number[] {
  const view = new DataView(new ArrayBuffer(8));
  view.setFloat64(0, value);
  return [...new Uint8Array(view.buffer)];
}
const sizeOf = (parts: readonly Part[]): number => parts.reduce((sum, part) => sum + part.length, 0);

/** Id, size in eight bytes, content. */
function element(id: number, content: readonly Part[]): Part[] {
  const size = new DataView(new ArrayBuffer(8));
  const length = sizeOf(content);
  size.setUint32(0, 0x01000000 + Math.floor(length / 0x100000000));
  size.setUint32(4, length >>> 0);
  return [[...whole(id), ...new Uint8Array(size.buffer)], ...content];
}

/** Longest span of a cluster: times in it are sixteen bits of ms. */
const cluster_ms = 10_000;

export function webm(pictures: readonly Encoded[], { width, height, codec, lasts_ms }: { width: number; height: number; codec: "V_VP8" | "V_VP9"; lasts_ms: number }): Blob {
  const clusters: Part[] = [];
  let block: Part[] = [];
  let begun = 0;
  const close = (): void => {
    if (block.length > 0) clusters.push(...element(0x1f43b675, [...element(0xe7, [whole(begun)]), ...block]));
    block = [];
  };
  for (const { time_ms, key, bytes } of pictures) {
    const time = Math.round(time_ms);
    if (block.length === 0 || (key && time - begun > 0.5 * cluster_ms) || time - begun > cluster_ms) {
      close();
      begun = time;
    }
    // Track 1, time within the cluster, flag of a key picture.
    block.push(...element(0xa3, [[0x81, (time - begun) >> 8, (time - begun) & 0xff, key ? 0x80 : 0], bytes]));
  }
  close();
  const head = element(0x1a45dfa3, [
    ...element(0x4286, [whole(1)]), ...element(0x42f7, [whole(1)]), ...element(0x42f2, [whole(4)]), ...element(0x42f3, [whole(8)]),
    ...element(0x4282, [text("webm")]), ...element(0x4287, [whole(4)]), ...element(0x4285, [whole(2)]),
  ]);
  const info = element(0x1549a966, [...element(0x2ad7b1, [whole(1_000_000)]), ...element(0x4489, [float(lasts_ms)]), ...element(0x4d80, [text("talus")]), ...element(0x5741, [text("talus")])]);
  const tracks = element(0x1654ae6b, element(0xae, [
    ...element(0xd7, [whole(1)]), ...element(0x73c5, [whole(1)]), ...element(0x83, [whole(1)]), ...element(0x86, [text(codec)]),
    ...element(0xe0, [...element(0xb0, [whole(width)]), ...element(0xba, [whole(height)])]),
  ]));
  const parts = [...head, ...element(0x18538067, [...info, ...tracks, ...clusters])];
  return new Blob(parts.map((part) => new Uint8Array(part)), { type: "video/webm" });
}
