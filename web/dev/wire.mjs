// Frames and grid messages of docs/protocol.md, written in JavaScript for the stand-in server and for tests.
import { deflateSync } from "node:zlib";

function folded(values) {
  const out = new Uint16Array(values.length);
  let before = 0;
  for (let i = 0; i < values.length; ++i) {
    const d = ((values[i] - before) << 16) >> 16;
    out[i] = ((d << 1) ^ (d >> 15)) & 0xffff;
    before = values[i];
  }
  return out;
}

function planes(values) {
  const n = values.length, f = folded(values), out = new Uint8Array(2 * n);
  for (let i = 0; i < n; ++i) {
    out[i] = f[i] & 0xff;
    out[n + i] = f[i] >> 8;
  }
  return out;
}

/** content: {scenario, flags, time, step, slots, stride, origin, scale, speedScale, window, depthScale, mapSpeedScale,
 *  x, y, z (Uint16Array), speed (Uint8Array), depth (Uint16Array), mapSpeed (Uint8Array)} */
export function encodeFrame(content) {
  const parts = [planes(content.x), planes(content.y), planes(content.z), content.speed, planes(content.depth), content.mapSpeed];
  const body = Buffer.concat(parts);
  const head = Buffer.alloc(88);
  head.write("TLSF", 0, "latin1");
  head.writeUInt8(1, 4);
  head.writeUInt8(content.scenario, 5);
  head.writeUInt16LE(content.flags, 6);
  head.writeDoubleLE(content.time, 8);
  head.writeBigUInt64LE(BigInt(content.step), 16);
  head.writeUInt32LE(content.slots, 24);
  head.writeUInt32LE(content.stride, 28);
  content.origin.forEach((v, i) => head.writeFloatLE(v, 32 + 4 * i));
  content.scale.forEach((v, i) => head.writeFloatLE(v, 44 + 4 * i));
  head.writeFloatLE(content.speedScale, 56);
  content.window.forEach((v, i) => head.writeUInt32LE(v, 60 + 4 * i));
  head.writeFloatLE(content.depthScale, 76);
  head.writeFloatLE(content.mapSpeedScale, 80);
  head.writeUInt32LE(body.length, 84);
  return Buffer.concat([head, deflateSync(body, { level: 1 })]);
}

/** values: Float32Array by rows from the south. */
export function encodeGrid(west, south, cell, columns, rows, values) {
  const body = Buffer.from(values.buffer, values.byteOffset, values.byteLength);
  const head = Buffer.alloc(44);
  head.write("TLSG", 0, "latin1");
  head.writeUInt8(1, 4);
  head.writeDoubleLE(west, 8);
  head.writeDoubleLE(south, 16);
  head.writeDoubleLE(cell, 24);
  head.writeUInt32LE(columns, 32);
  head.writeUInt32LE(rows, 36);
  head.writeUInt32LE(body.length, 40);
  return Buffer.concat([head, deflateSync(body, { level: 1 })]);
}
