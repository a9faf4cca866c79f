// Blocks of a published twin's file: bytes as text (docs/publish.md).

/** Seven bits in each character; a few of them stand 128 higher, since HTML would not keep them. */
export function bytesOfText(text: string): Uint8Array {
  const bytes = new Uint8Array(Math.floor((7 * text.length) / 8));
  let held = 0;
  let count = 0;
  let filled = 0;
  for (let i = 0; i < text.length; ++i) {
    held |= (text.charCodeAt(i) & 127) << count;
    count += 7;
    if (count >= 8) {
      bytes[filled++] = held;
      held >>>= 8;
      count -= 8;
    }
  }
  return bytes;
}

/** Of a block of the file; null: it has none of this name. Its text goes: it is not needed twice. */
export function blockOf(id: string): Uint8Array | null {
  const block = document.getElementById(id);
  if (block === null) return null;
  const bytes = bytesOfText(block.textContent ?? "");
  block.remove();
  return bytes;
}

/** A deflated block, inflated; null: the page has none. */
export async function inflatedBlock(id: string): Promise<Response | null> {
  const packed = blockOf(id);
  return packed === null ? null : new Response(new Blob([packed as BlobPart]).stream().pipeThrough(new DecompressionStream("deflate")));
}
