import { describe, expect, it } from "vitest";
import { qrPath } from "../src/ui/qr";

describe("the QR code of a link", () => {
  const link = "http://192.168.178.55:8123/#token=0123456789abcdef0123456789abcdef";
  const { path, size } = qrPath(link);
  const dark = new Set([...path.matchAll(/M(\d+) (\d+)h/g)].map(([, column, row]) => `${column},${row}`));

  it("has its three finders inside a margin of four modules, and none in the fourth corner", () => {
    expect(size).toBe(37 + 8); // version 5: up to 84 bytes at 15 % correction
    const finder = (column: number, row: number): string => Array.from({ length: 49 }, (_, i) => (dark.has(`${column + (i % 7)},${row + Math.floor(i / 7)}`) ? "#" : ".")).join("");
    const whole = "########.....##.###.##.###.##.###.##.....########";
    const last = size - 4 - 7;
    expect([finder(4, 4), finder(last, 4), finder(4, last)]).toEqual([whole, whole, whole]);
    expect(finder(last, last)).not.toBe(whole);
    expect([...dark].every((place) => place.split(",").every((at) => Number(at) >= 4 && Number(at) < size - 4))).toBe(true);
  });
  it("is another one for another link", () => {
    expect(qrPath(`${link}0`).path).not.toBe(path);
  });
});
