#!/usr/bin/env python3
"""Makes the small valley that the scenes of the gallery share (docs/gallery.md): terrain, scar,
loose bed, flow path and village.

    python3 examples/valley/make_valley.py [FOLDER]

writes terrain.tif, release.geojson and its halves release_lower.geojson and release_upper.geojson, bed.geojson,
flow_path.geojson and village.city.json into FOLDER (by default the folder of this script). Needs numpy and GDAL's Python bindings. The ground is the formula below, no real place: a torrent that runs down
from the west in a channel and leaves it at x = 180 m, onto a fan. Metres in a local reference system, x to the east.

    axis             y_a(x) = 80 + 5 sin(2 pi x / 130) (1 - S(x))
    slope of the bed s(x)   = 0.12 + 0.58 exp(-x / 80)                  35 degrees at the top, 10 to 7 on the fan
    bed              z_b(x) = 100 - integral of s from 0 to x
    bank             c(x,d) = D tanh((sqrt(d^2 + w^2) - w) / D)     d = |y - y_a|, half width w of the bed
    hillside         r(x,y) = 0.9 (1 - exp(-(d / 22)^4)) (1 - 0.8 S) (sin(a + 0.6 sin b) + 0.5 sin(2 a + b)),
                              a = (x + 0.3 y) / 5.5, b = (y - 0.4 x) / 9
    ground           z(x,y) = z_b + c + k d + r                         k: hillside above the bank, or fan falling off
    S(x) is the smooth step 3 t^2 - 2 t^3, t = (x - 145) / 45 within 0 and 1, from the channel to the fan. With it
    D goes from 9 to 1 m, w from 2 to 4 m and k from 0.25 to -0.03.
"""

import json
import os
import sys

import numpy as np
from osgeo import gdal, osr

LENGTH, WIDTH, CELL = 320.0, 160.0, 2.0
# Name, middle, length along the ridge, width, direction of the ridge in degrees from east, heights of eaves and ridge.
HOUSES = [
    ("House 1", 214, 88, 12, 8, 80, 4.5, 7.0),
    ("House 2", 226, 76, 10, 8, 10, 4.5, 7.0),
    ("House 3", 231, 93, 11, 8, 75, 4.5, 7.0),
    ("House 4", 246, 82, 12, 9, 15, 5.5, 8.5),
    ("House 5", 243, 100, 10, 8, 0, 4.5, 7.0),
    ("Church", 218, 108, 16, 9, 5, 7.0, 12.0),
]


def step(x):
    t = np.clip((x - 145) / 45, 0, 1)
    return t * t * (3 - 2 * t)


def blend(x, channel, fan):
    return channel + (fan - channel) * step(x)


def axis(x):
    return 80 + 5 * np.sin(2 * np.pi * x / 130) * (1 - step(x))


def ground(x, y):
    bed = 100 - 0.12 * x - 0.58 * 80 * (1 - np.exp(-x / 80))
    from_axis = np.abs(y - axis(x))
    depth, half_width, side = blend(x, 9, 1), blend(x, 2, 4), blend(x, 0.25, -0.03)
    bank = depth * np.tanh((np.hypot(from_axis, half_width) - half_width) / depth)
    return bed + bank + side * from_axis + hillside(x, y, from_axis)


def hillside(x, y, from_axis):
    """Gullies and ribs on the slopes, none in the channel: they only make the ground look like ground."""
    a, b = (x + 0.3 * y) / 5.5, (y - 0.4 * x) / 9
    away = (1 - np.exp(-(from_axis / 22) ** 4)) * blend(x, 1, 0.2)
    return 0.9 * away * (np.sin(a + 0.6 * np.sin(b)) + 0.5 * np.sin(2 * a + b))


def reference_system():
    crs = osr.SpatialReference()
    crs.SetLocalCS("valley of the gallery")
    crs.SetLinearUnits("metre", 1)
    return crs


def write_terrain(path):
    columns, rows = round(LENGTH / CELL), round(WIDTH / CELL)
    x, y = np.meshgrid(CELL * (np.arange(columns) + 0.5), WIDTH - CELL * (np.arange(rows) + 0.5))
    data = gdal.GetDriverByName("GTiff").Create(path, columns, rows, 1, gdal.GDT_Float32,
                                                ["COMPRESS=DEFLATE", "PREDICTOR=3", "ZLEVEL=9"])
    data.SetProjection(reference_system().ExportToWkt())
    data.SetGeoTransform((0, CELL, 0, WIDTH, 0, -CELL))
    data.GetRasterBand(1).SetNoDataValue(-9999)
    data.GetRasterBand(1).SetUnitType("m")
    data.GetRasterBand(1).WriteArray(np.round(ground(x, y), 2).astype(np.float32))
    data.FlushCache()


def write_geojson(path, kind, points):
    points = [[round(float(x), 2), round(float(y), 2)] for x, y in points]
    shape = {"type": kind, "coordinates": [points + points[:1]] if kind == "Polygon" else points}
    crs = {"type": "name", "properties": {"name": reference_system().ExportToWkt()}}
    feature = {"type": "Feature", "properties": {}, "geometry": shape}
    with open(path, "w", encoding="utf-8", newline="\n") as file:
        file.write(json.dumps({"type": "FeatureCollection", "crs": crs, "features": [feature]}) + "\n")


def scar():
    """An ellipse in the torrent's head, 28 m long and 14 m wide."""
    turn = np.linspace(-np.pi / 2, 1.5 * np.pi, 32, endpoint=False)
    x = 30 + 14 * np.cos(turn)
    return [*zip(x, axis(x) + 7 * np.sin(turn))]


def channel_bed():
    """The torrent's bed from x = 60 to 140 m, 8 m wide."""
    x = np.arange(60, 141, 5)
    return [*zip(x, axis(x) - 4), *zip(x[::-1], axis(x[::-1]) + 4)]


def house_corners(x, y, length, width, direction):
    turn = np.radians(direction)
    along = np.array([np.cos(turn), np.sin(turn)]) * length / 2
    across = np.array([-np.sin(turn), np.cos(turn)]) * width / 2
    middle = np.array([x, y])
    outline = [middle - along - across, middle + along - across, middle + along + across, middle - along + across]
    return outline + [middle - along, middle + along]


def write_village(path):
    """Houses with a gable roof (LoD2): on the ground the outline, above it the eaves and the two ends of the ridge."""
    faces = [[3, 2, 1, 0], [4, 5, 9, 8], [8, 9, 6, 7], [0, 1, 5, 4], [2, 3, 7, 6], [1, 2, 6, 9, 5], [3, 0, 4, 8, 7]]
    objects, vertices = {}, []
    for name, x, y, length, width, direction, eaves, ridge in HOUSES:
        corners = house_corners(x, y, length, width, direction)
        base = ground(x, y)
        first = len(vertices)
        heights = [(corners[:4], 0), (corners[:4], eaves), (corners[4:], ridge)]
        vertices += [[round(100 * v) for v in (*corner, base + height)] for part, height in heights for corner in part]
        solid = [[[first + i for i in face]] for face in faces]
        objects[name] = {"type": "Building", "attributes": {"name": name},
                         "geometry": [{"type": "Solid", "lod": "2", "boundaries": [solid]}]}
    city = {"type": "CityJSON", "version": "2.0", "transform": {"scale": [0.01] * 3, "translate": [0, 0, 0]},
            "CityObjects": objects, "vertices": vertices}
    with open(path, "w", encoding="utf-8", newline="\n") as file:
        file.write(json.dumps(city) + "\n")


def main(folder):
    gdal.UseExceptions()
    osr.UseExceptions()
    write_terrain(os.path.join(folder, "terrain.tif"))
    write_geojson(os.path.join(folder, "release.geojson"), "Polygon", scar())
    write_geojson(os.path.join(folder, "release_lower.geojson"), "Polygon", scar()[:17])
    write_geojson(os.path.join(folder, "release_upper.geojson"), "Polygon", [*scar()[16:], scar()[0]])
    write_geojson(os.path.join(folder, "bed.geojson"), "Polygon", channel_bed())
    along = np.arange(12, LENGTH - 3, 4)
    write_geojson(os.path.join(folder, "flow_path.geojson"), "LineString", zip(along, axis(along)))
    write_village(os.path.join(folder, "village.city.json"))


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else os.path.dirname(os.path.abspath(__file__)))
