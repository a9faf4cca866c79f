import { describe, expect, it } from "vitest";
import { bytesOfText } from "../src/protocol/block";

/** As src/publish/page.cpp writes it. */
function textOf(bytes: Uint8Array): string {
  let text = "";
  let held = 0;
  let count = 0;
  const put = (): void => {
    const symbol = held & 127;
    text += String.fromCharCode([0, 13, 60].includes(symbol) ? symbol + 128 : symbol);
    held >>>= 7;
    count -= 7;
  };
  for (const byte of bytes) {
    held |= byte << count;
    count += 8;
    while (count >= 7) put();
  }
  if (count > 0) put();
  return text;
}

describe("block", () => {
  it("gives its bytes back, whatever their number", () => {
    const bytes = Uint8Array.from({ length: 1000 }, (_, k) => (Math.imul(k, 2654435761) >>> 11) & 255);
    for (const size of [0, 1, 2, 6, 7, 8, 9, 999, 1000]) expect([...bytesOfText(textOf(bytes.subarray(0, size)))], `${size} bytes`).toEqual([...bytes.subarray(0, size)]);
  });
  it("reads the characters that stand higher, and those of every bit", () => {
    expect([...bytesOfText("\u0080\u0080\u0080")]).toEqual([0, 0]);
    expect([...bytesOfText("A\u0001")]).toEqual([0xc1]); // 'A' is 65, its eighth bit from the next character
    expect([...bytesOfText("\u007f\u007f\u007f\u007f\u007f\u007f\u007f\u007f")]).toEqual(Array(7).fill(255));
  });
});
