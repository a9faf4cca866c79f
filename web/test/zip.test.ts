import { execFileSync } from "node:child_process";
import { mkdtempSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { describe, expect, it } from "vitest";
import { crc32, zip } from "../src/state/zip";

const bytes = (text: string): Uint8Array<ArrayBuffer> => new TextEncoder().encode(text);

describe("a ZIP of files", () => {
  it("has the checksum of the standard", () => {
    expect(crc32(bytes("123456789"))).toBe(0xcbf43926);
    expect(crc32(bytes(""))).toBe(0);
  });
  it("lists every member with size and place, after its own header", async () => {
    const data = new DataView(await zip([{ name: "a.csv", bytes: bytes("1,2\n") }, { name: "höhe.txt", bytes: bytes("") }], new Date(2026, 10, 23, 18, 30, 8)).arrayBuffer());
    const end = data.byteLength - 22;
    expect(data.getUint32(end, true)).toBe(0x06054b50);
    expect(data.getUint16(end + 10, true)).toBe(2);
    let at = data.getUint32(end + 16, true);
    const names: string[] = [];
    for (let k = 0; k < 2; ++k) {
      expect(data.getUint32(at, true)).toBe(0x02014b50);
      const length = data.getUint16(at + 28, true);
      names.push(new TextDecoder().decode(new Uint8Array(data.buffer, at + 46, length)));
      const place = data.getUint32(at + 42, true);
      expect(data.getUint32(place, true)).toBe(0x04034b50);
      expect(data.getUint32(place + 18, true)).toBe(data.getUint32(at + 24, true));
      at += 46 + length;
    }
    expect(names).toEqual(["a.csv", "höhe.txt"]);
    expect(at).toBe(end);
  });
  it("is read by another program", async () => {
    let unzip = true;
    try {
      execFileSync("python3", ["--version"]);
    } catch {
      unzip = false;
    }
    if (!unzip) return;
    const file = join(mkdtempSync(join(tmpdir(), "zip-")), "files.zip");
    writeFileSync(file, new Uint8Array(await zip([{ name: "a.csv", bytes: bytes("1,2\n") }, { name: "höhe.txt", bytes: bytes("x".repeat(70000)) }], new Date()).arrayBuffer()));
    const told = execFileSync("python3", ["-c", "import sys,zipfile; z=zipfile.ZipFile(sys.argv[1]); print(z.testzip(), [(i.filename, i.file_size) for i in z.infolist()])", file]);
    expect(told.toString().trim()).toBe("None [('a.csv', 4), ('höhe.txt', 70000)]");
  });
});
