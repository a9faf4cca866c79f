import { describe, expect, it } from "vitest";
import type { Overlay, OverlayData, OverlayFeature } from "../src/protocol/messages";
import { boundsOf, featureAt, groupFiles, listKey, mayLoad, mercator, nameAt, seenAs, styleOf, tileRange, tileUrl, withOwn, withoutOwn, withoutScheme } from "../src/state/overlays";

const feature = (kind: OverlayFeature["kind"], parts: number[][], name = "", style = -1): OverlayFeature => ({ kind, parts, name, attributes: {}, style });
const area = feature("area", [[0, 0, 100, 0, 100, 100, 0, 100], [40, 40, 60, 40, 60, 60, 40, 60]], "parcel");
const line = feature("line", [[0, 20, 100, 20]], "road");
const point = feature("point", [[50, 20]], "shelter");
const data: OverlayData = { styles: [], features: [area, line, point] };

describe("files dropped together", () => {
  it("belong to the file of the same name, in any case", () => {
    expect(groupFiles(["Roads.shp", "roads.DBF", "roads.prj", "map.tif", "map.tfw", "b.gpkg"])).toEqual({
      groups: [{ main: "Roads.shp", parts: ["roads.DBF", "roads.prj"] }, { main: "map.tif", parts: ["map.tfw"] }, { main: "b.gpkg", parts: [] }], alone: [],
    });
  });
  it("are named where their main file is missing", () => {
    expect(groupFiles(["roads.dbf", "other.shp"])).toEqual({ groups: [{ main: "other.shp", parts: [] }], alone: ["roads.dbf"] });
  });
});

describe("the feature at a place", () => {
  it("is a point before a line before an area, and none in a hole or outside", () => {
    expect(featureAt(data, 51, 21, 3)?.name).toBe("shelter");
    expect(featureAt(data, 80, 22, 3)?.name).toBe("road");
    expect(featureAt(data, 80, 50, 3)?.name).toBe("parcel");
    expect(featureAt(data, 50, 50, 3)).toBeNull();
    expect(featureAt(data, 150, 50, 3)).toBeNull();
  });
  it("has bounds and a place for its name", () => {
    expect(boundsOf(data)).toEqual([0, 0, 100, 100]);
    expect(boundsOf({ styles: [], features: [] })).toBeNull();
    expect(nameAt(point)).toEqual([50, 20]);
    expect(nameAt(line)).toEqual([50, 20]);
    expect(nameAt(area)).toEqual([50, 50]);
  });
  it("has the file's style, or else the layer's colour", () => {
    const style = { stroke: "#010203", stroke_opacity: 1, fill: "", fill_opacity: 1, width_px: 3, size_px: 10 };
    expect(styleOf({ styles: [style], features: [] }, feature("line", [[0, 0, 1, 1]], "", 0), "#ff0000")).toBe(style);
    expect(styleOf(data, area, "#ff0000")).toMatchObject({ stroke: "#ff0000", fill: "#ff0000", fill_opacity: 0.25 });
    expect(styleOf(data, line, "#ff0000").fill).toBe("");
  });
});

describe("what one person sees", () => {
  it("is what everybody sees, except what was changed for that person alone", () => {
    const overlay = { visible: true, opacity: 0.8 } as Overlay;
    expect(seenAs(overlay, undefined)).toEqual({ visible: true, opacity: 0.8 });
    expect(seenAs(overlay, { visible: false })).toEqual({ visible: false, opacity: 0.8 });
  });
  it("ends for one layer when that is changed for everybody", () => {
    const own = withOwn(withOwn(withOwn(new Map(), "a", { visible: false }), "a", { opacity: 0.3 }), "b", { visible: true });
    expect([...own]).toEqual([["a", { visible: false, opacity: 0.3 }], ["b", { visible: true }]]);
    expect([...withoutOwn(own, "a")]).toEqual([["b", { visible: true }]]);
    expect(own.size).toBe(2);
    expect(withoutOwn(own, "c")).toBe(own);
  });
});

describe("the list of layers", () => {
  const roads = { id: "1", name: "Roads", visible: true, opacity: 0.8, colour: "#ff0000" } as Overlay;
  const none = new Map();
  const before = listKey([roads], none, false);
  it("stays as it is when the same layers are told again", () => expect(listKey([{ ...roads }], new Map(), false)).toBe(before));
  it("changes with a layer, its order, an own look and who has control", () => {
    const others = [listKey([{ ...roads, opacity: 0.7 }], none, false), listKey([roads, { ...roads, id: "2" }], none, false), listKey([{ ...roads, id: "2" }, roads], none, false),
      listKey([roads], withOwn(none, "1", { visible: false }), false), listKey([roads], none, true)];
    expect(new Set([before, ...others]).size).toBe(6);
  });
});

describe("map tiles", () => {
  it("are numbered from the north-west in Web Mercator", () => {
    expect(mercator(0, 0)).toEqual([0.5, 0.5]);
    expect(mercator(180, 85.0511)[1]).toBeCloseTo(0, 5);
    // Hong Kong at zoom 10: tile 836, 446, as published lists of tiles have it.
    const [x, y] = mercator(114.17, 22.3);
    expect([Math.floor(1024 * x), Math.floor(1024 * y)]).toEqual([836, 446]);
  });
  it("cover all places with no more than so many", () => {
    const places = [mercator(114.05, 22.36), mercator(114.06, 22.37)];
    const range = tileRange(places, 64);
    expect(range.columns * range.rows).toBeLessThanOrEqual(64);
    expect(tileRange(places, 64, range.zoom + 1)).toEqual(range);
    for (const [x, y] of places) {
      const [i, j] = [Math.floor(x * 2 ** range.zoom) - range.west, Math.floor(y * 2 ** range.zoom) - range.north];
      expect(i >= 0 && i < range.columns && j >= 0 && j < range.rows).toBe(true);
    }
  });
  it("have addresses in either notation", () => {
    expect(tileUrl("https://a/{z}/{x}/{y}.png", 3, 4, 5)).toBe("https://a/3/4/5.png");
    expect(tileUrl("https://a/wmts?M={TileMatrix}&R={TileRow}&C={TileCol}", 3, 4, 5)).toBe("https://a/wmts?M=3&R=5&C=4");
  });
  it("may be loaded by this page from the hosts that the server knew when it sent the page, and from no other", () => {
    const atLoad = ["https://a.example.org/{z}/{x}/{y}.png", "http://127.0.0.1:8080/wmts?M={TileMatrix}&R={TileRow}&C={TileCol}"];
    expect(mayLoad("https://a.example.org/other/{z}/{x}/{y}.jpg", atLoad)).toBe(true);
    expect(mayLoad("http://127.0.0.1:8080/{z}/{x}/{y}", atLoad)).toBe(true);
    expect(mayLoad("http://127.0.0.1:8081/{z}/{x}/{y}", atLoad)).toBe(false);
    expect(mayLoad("http://a.example.org/{z}/{x}/{y}.png", atLoad)).toBe(false);
    expect(mayLoad("https://a.example.org.evil.net/{z}/{x}/{y}.png", atLoad)).toBe(false);
    expect(mayLoad(atLoad[0], [])).toBe(false);
  });
  it("have addresses that people read without the scheme", () => {
    expect(withoutScheme("https://a.example.org/{z}/{x}/{y}.png")).toBe("a.example.org/{z}/{x}/{y}.png");
  });
});
