// Positions of a twin on the globe: earth-centred, earth-fixed coordinates of WGS 84 (EPSG:4978).
import type { SceneInfo } from "../../src/protocol/messages";

/** The flat scene on the globe, as 4 x 4 numbers by columns: from local positions, m, to metres from the earth's centre. Cesium.Matrix4.fromArray and three.Matrix4.fromArray take it. */
export type EarthMatrix = Float64Array;

// WGS 84 (NIMA 2000, TR8350.2).
const semiMajor_m = 6378137;
const squeezed = (1 - 1 / 298.257223563) ** 2;
/** Over which the axes are measured. */
const baseline_m = 100;

type Vector = [number, number, number];

function upAt([longitude, latitude]: readonly [number, number]): Vector {
  const [l, b] = [longitude * Math.PI / 180, latitude * Math.PI / 180];
  return [Math.cos(b) * Math.cos(l), Math.cos(b) * Math.sin(l), Math.sin(b)];
}
function fromDegrees(degrees: readonly [number, number], height_m: number): Vector {
  const up = upAt(degrees);
  const normal = semiMajor_m / Math.sqrt(1 - (1 - squeezed) * up[2] ** 2);
  return [(normal + height_m) * up[0], (normal + height_m) * up[1], (normal * squeezed + height_m) * up[2]];
}

/**
 * Where a scene is on the globe. Its axes keep the turn and the scale of its reference system; a flat scene touches the globe in the middle
 * of its terrain: at distance d from there it is d^2 / 12742 km too high.
 *
 * @param toDegrees longitude and latitude on WGS 84, degrees, of a place (east, north; m) in the reference system `scene.crs`; proj4 makes
 *     such a function: `(east, north) => proj4(definition, "WGS84", [east, north])`
 * @param geoidHeight_m how far the zero of the scene's elevations is above the ellipsoid there
 * @throws Error if `toDegrees` has no numbers for the scene's place
 */
export function earthMatrix(scene: Pick<SceneInfo, "origin" | "extent_m" | "crs">, toDegrees: (east_m: number, north_m: number) => readonly [number, number], geoidHeight_m = 0): EarthMatrix {
  const [west, south, east, north] = scene.extent_m;
  const middle: Vector = [(west + east) / 2, (south + north) / 2, scene.origin[2] + geoidHeight_m];
  const at = (dx: number, dy: number): Vector => fromDegrees(toDegrees(middle[0] + dx, middle[1] + dy), middle[2]);
  const axis = (dx: number, dy: number): Vector => {
    const [from, to] = [at(-dx, -dy), at(dx, dy)];
    return [0, 1, 2].map((k) => (to[k]! - from[k]!) / (2 * baseline_m)) as Vector;
  };
  const [x, y, z] = [axis(baseline_m, 0), axis(0, baseline_m), upAt(toDegrees(middle[0], middle[1]))];
  const [dx, dy] = [middle[0] - scene.origin[0], middle[1] - scene.origin[1]];
  const place = at(0, 0).map((value, k) => value - dx * x[k]! - dy * y[k]!);
  const matrix = Float64Array.of(...x, 0, ...y, 0, ...z, 0, ...place, 1);
  if (!matrix.every(Number.isFinite)) throw new Error(`${scene.crs || "the scene's reference system"}: its place on the globe is not known`);
  return matrix;
}

/** Local positions, three numbers each, on the globe: x, y, z in metres from the earth's centre, three numbers each. */
export function toEarth(matrix: EarthMatrix, positions: ArrayLike<number>): Float64Array {
  const out = new Float64Array(positions.length);
  for (let i = 0; i + 2 < positions.length; i += 3) {
    for (let k = 0; k < 3; ++k) {
      out[i + k] = matrix[k]! * positions[i]! + matrix[4 + k]! * positions[i + 1]! + matrix[8 + k]! * positions[i + 2]! + matrix[12 + k]!;
    }
  }
  return out;
}
