// A debris flow on Cesium's globe, computed in the page; no token, no terrain of a service, no network.
// Beside the page: scene.bin of `talus publish SCENE -o site --folder`.
import { BoundingSphere, Cartesian3, CesiumWidget, Color, ColorGeometryInstanceAttribute, ComponentDatatype, Geometry, GeometryAttribute,
  GeometryAttributes, GeometryInstance, GeometryPipeline, HeadingPitchRange, Matrix4, PerInstanceColorAppearance, PointPrimitiveCollection, Primitive,
  PrimitiveType } from "@cesium/engine";
import proj4 from "proj4";
import { earthMatrix, openTwin, toEarth } from "talus-engine";

/** Reference systems in PROJ's words, as epsg.io has them; those of UTM are made from their code. */
const definitions = {
  "EPSG:2326": "+proj=tmerc +lat_0=22.3121333333333 +lon_0=114.178555555556 +k=1 +x_0=836694.05 +y_0=819069.8 +ellps=intl +towgs84=-162.619,-276.959,-161.764,0.067753,-2.243648,-1.158828,-1.094246 +units=m",
};
function definitionOf(crs) {
  const [, kind, zone] = /^EPSG:(326|327|258)(\d\d)$/.exec(crs) ?? [];
  const found = kind === undefined ? definitions[crs] : `+proj=utm +zone=${Number(zone)} +datum=WGS84 +units=m${kind === "327" ? " +south" : ""}`;
  if (found === undefined) throw new Error(`${crs}: add its definition to main.js`);
  return found;
}

/** Elevations as a surface, its points on the globe. */
function ground(grid, origin, matrix) {
  const { west, south, cell, columns, rows, values } = grid;
  const local = new Float32Array(3 * columns * rows);
  const faces = [];
  for (let j = 0; j < rows; ++j) {
    for (let i = 0; i < columns; ++i) {
      const k = j * columns + i;
      local.set([west + (i + 0.5) * cell - origin[0], south + (j + 0.5) * cell - origin[1], (values[k] || 0) - origin[2]], 3 * k);
      const corners = [k, k + 1, k + columns + 1, k + columns];
      if (i + 1 === columns || j + 1 === rows || corners.some((c) => Number.isNaN(values[c]))) continue;
      faces.push(corners[0], corners[1], corners[2], corners[0], corners[2], corners[3]);
    }
  }
  const positions = toEarth(matrix, local);
  const geometry = GeometryPipeline.computeNormal(new Geometry({
    attributes: new GeometryAttributes({ position: new GeometryAttribute({ componentDatatype: ComponentDatatype.DOUBLE, componentsPerAttribute: 3, values: positions }) }),
    indices: new Uint32Array(faces), primitiveType: PrimitiveType.TRIANGLES, boundingSphere: BoundingSphere.fromVertices(positions),
  }));
  const color = ColorGeometryInstanceAttribute.fromColor(Color.fromCssColorString("#8f9a7e"));
  return new Primitive({ geometryInstances: new GeometryInstance({ geometry, attributes: { color } }), asynchronous: false,
    appearance: new PerInstanceColorAppearance({ translucent: false, closed: false }) });
}

const panel = document.getElementById("panel");
try {
  const widget = new CesiumWidget("globe", { baseLayer: false, skyBox: false, skyAtmosphere: false });
  widget.scene.globe.baseColor = Color.fromCssColorString("#40566b");
  const twin = await openTwin(new Uint8Array(await (await fetch("scene.bin")).arrayBuffer()));
  const { scene, run } = twin;
  const definition = definitionOf(scene.crs);
  const matrix = earthMatrix(scene, (east, north) => proj4(definition, "WGS84", [east, north]));
  widget.scene.primitives.add(ground(await twin.terrain(60_000), scene.origin, matrix));

  const cloud = widget.scene.primitives.add(new PointPrimitiveCollection());
  const color = Color.fromCssColorString("#c2410c");
  const show = ({ positions, count }) => {
    const earth = toEarth(matrix, positions);
    while (cloud.length < count) cloud.add({ color, pixelSize: 5 });
    for (let i = 0; i < cloud.length; ++i) {
      const point = cloud.get(i);
      point.show = i < count;
      if (i < count) point.position = Cartesian3.unpack(earth, 3 * i);
    }
    return earth;
  };
  const first = show(await run.particles());
  widget.camera.lookAt(Cartesian3.unpack(first, 0), new HeadingPitchRange(0.4, -0.5, 500));
  widget.camera.lookAtTransform(Matrix4.IDENTITY);
  for (;;) {
    const state = await run.advance(0.1);
    const earth = show(await run.particles());
    panel.textContent = `${scene.title}: ${state.time_s.toFixed(1)} s, ${state.status}`;
    panel.dataset.globe = widget.scene.globe.tilesLoaded ? "drawn" : "waiting";
    panel.dataset.first = Array.from(earth.subarray(0, 3)).join(" ");
    await new Promise(state.status === "paused" ? requestAnimationFrame : (next) => setTimeout(next, 200));
  }
} catch (error) {
  panel.textContent = error.message;
}
