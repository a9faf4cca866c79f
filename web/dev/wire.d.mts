export function encodeFrame(content: {
  scenario: number; flags: number; time: number; step: number; slots: number; stride: number; origin: number[]; scale: number[]; speedScale: number;
  window: number[]; depthScale: number; mapSpeedScale: number; x: Uint16Array; y: Uint16Array; z: Uint16Array; speed: Uint8Array; depth: Uint16Array;
  mapSpeed: Uint8Array;
}): Uint8Array;
export function encodeGrid(west: number, south: number, cell: number, columns: number, rows: number, values: Float32Array): Uint8Array;
