// A small scene: a gully in gravel 2 m deep, which debris entrains.
import { writeFileSync } from "node:fs";
import { join } from "node:path";

const [west, south, columns, rows] = [500000, 5200000, 100, 50];
const prj = `PROJCS["WGS 84 / UTM zone 33N",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",15],PARAMETER["scale_factor",0.9996],PARAMETER["false_easting",500000],PARAMETER["false_northing",0],UNIT["metre",1]]`;

/** Writes the scene and answers its file: it falls to the east by 30 degrees for 60 m, to level ground, or to the sea. */
export function writeGully(folder, sea = false) {
  const lines = [`ncols ${columns}`, `nrows ${rows}`, `xllcorner ${west}`, `yllcorner ${south}`, "cellsize 1"];
  for (let j = rows - 1; j >= 0; --j) {
    const across = Math.max(0, Math.abs(j + 0.5 - rows / 2) - 4);
    lines.push(Array.from({ length: columns }, (_, i) => ((sea ? 0 : 100) + Math.max(0, 60 - i) * 0.577 + (sea && i >= 60 ? 0 : across / 2)).toFixed(3)).join(" "));
  }
  writeFileSync(join(folder, "gully.asc"), lines.join("\n"));
  writeFileSync(join(folder, "gully.prj"), prj);
  const places = (list) => list.map(([x, y]) => [west + x, south + y]);
  const writeFeature = (name, type, coordinates) => writeFileSync(join(folder, name), JSON.stringify({ type: "FeatureCollection",
    crs: { type: "name", properties: { name: "urn:ogc:def:crs:EPSG::32633" } }, features: [{ type: "Feature", properties: {}, geometry: { type, coordinates } }] }));
  writeFeature("scar.geojson", "Polygon", [places([[5, 20], [14, 20], [14, 30], [5, 30], [5, 20]])]);
  writeFeature("path.geojson", "LineString", places([[6, 25], [95, 25]]));
  const file = join(folder, "gully.toml");
  writeFileSync(file, `[scene]
title = "Gully"
[terrain]
file = "gully.asc"
[[release]]
file = "scar.geojson"
thickness_m = 1.5
[[bed]]
name = "gravel"
depth_m = 2
growth_rate_per_m = 0.04
[flow_path]
file = "path.geojson"
corridor_width_m = 30
[material]
friction_coefficient = 0.2
[solver]
particle_spacing_m = 0.7
end_time_s = 60
`);
  return file;
}
