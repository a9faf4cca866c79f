// One ZIP file of several, stored as they are (PKWARE, APPNOTE.TXT 6.3.10): most maps and all pictures are compressed already.

/** A ZIP without 64-bit fields ends at 4 GB; a page does well with far less. */
export const mostZipped_bytes = 1e9;

export interface Member { name: string; bytes: Uint8Array<ArrayBuffer> }

const table = Uint32Array.from({ length: 256 }, (_, n) => {
  let c = n;
  for (let k = 0; k < 8; ++k) c = c & 1 ? 0xedb88320 ^ (c >>> 1) : c >>> 1;
  return c;
});
export function crc32(bytes: Uint8Array): number {
  let c = 0xffffffff;
  for (const byte of bytes) c = table[(c ^ byte) & 0xff] ^ (c >>> 8);
  return (c ^ 0xffffffff) >>> 0;
}

/** Little endian: 16 bits for a plain number, 32 for one in a list of its own. */
function record(...fields: (number | [number])[]): Uint8Array<ArrayBuffer> {
  const view = new DataView(new ArrayBuffer(fields.reduce<number>((sum, f) => sum + (typeof f === "number" ? 2 : 4), 0)));
  let at = 0;
  for (const field of fields) {
    if (typeof field === "number") view.setUint16(at, field, true);
    else view.setUint32(at, field[0], true);
    at += typeof field === "number" ? 2 : 4;
  }
  return new Uint8Array(view.buffer);
}

const version = 20;
const utf8Names = 0x0800;

/** `when`: the time that all members carry. */
export function zip(members: readonly Member[], when: Date): Blob {
  const time = (when.getHours() << 11) | (when.getMinutes() << 5) | (when.getSeconds() >> 1);
  const date = ((when.getFullYear() - 1980) << 9) | ((when.getMonth() + 1) << 5) | when.getDate();
  const parts: Uint8Array<ArrayBuffer>[] = [];
  const directory: Uint8Array<ArrayBuffer>[] = [];
  let offset = 0;
  for (const { name, bytes } of members) {
    const text = new TextEncoder().encode(name);
    const sum = crc32(bytes);
    const head = record([0x04034b50], version, utf8Names, 0, time, date, [sum], [bytes.length], [bytes.length], text.length, 0);
    parts.push(head, text, bytes);
    directory.push(record([0x02014b50], version, version, utf8Names, 0, time, date, [sum], [bytes.length], [bytes.length], text.length, 0, 0, 0, 0, [0], [offset]), text);
    offset += head.length + text.length + bytes.length;
  }
  const size = directory.reduce((all, part) => all + part.length, 0);
  return new Blob([...parts, ...directory, record([0x06054b50], 0, 0, members.length, members.length, [size], [offset], 0)], { type: "application/zip" });
}
