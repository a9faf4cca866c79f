#!/usr/bin/env python3
"""Makes the terrain, release area, buildings and flow path of the built-in scene.

    python3 scenes/sham_tseng/make_terrain.py [FOLDER]

writes terrain.tif, release.geojson, release_lower, release_long and release_wide.geojson (other shapes of the scar, to
compare), buildings.geojson and flow_path.geojson into FOLDER (by default the folder of this script). Needs numpy and
GDAL's Python bindings. The same input gives the same values on every machine: the roughness
comes from an integer hash, not from a random generator.

This is a reconstruction. KNOWN below holds what sources say about the landslide of 23 August 1999 at Sham Tseng San
Tsuen, and its trail as read at single points; everything under ASSUMED was chosen by us so that the ground agrees with
it. No elevation model is read.
Coordinates are metres in the Hong Kong 1980 Grid (EPSG:2326), elevations metres above the Principal Datum (mPD).
docs/scenes.md explains both.
"""

import json
import os
import sys

import numpy as np
from osgeo import gdal, osr

# -------------------------------------------------------------------------------------------------------------- KNOWN

# Plan of the trail (+-30 m) with the elevation of the bed: the crown, the bend of the gully, and down the gully.
CROWN = (824355.0, 825830.0)
TRAIL_POINTS = [  # after the bend near (824262, 825805)
    (824255.0, 825780.0, 102.0),
    (824240.0, 825750.0, 88.0),
    (824230.0, 825720.0, 62.0),
    (824220.0, 825690.0, 44.0),
    (824205.0, 825660.0, 29.0),
    (824195.0, 825630.0, 18.0),
]
# Elevation of the bed against chainage. Two neighbours are listed as 112; 0.4 m up and down keeps both within their
# rounding and lets the bed descend.
PROFILE = [(0, 153.0), (22, 146.0), (45, 132.0), (67, 119.0), (88, 112.4), (98, 111.6),
           (130, 102.0), (162, 88.0), (193, 62.0), (225, 44.0), (258, 29.0), (290, 18.0)]
WATERFALL_HEIGHT = 10.0
HOUSE_21A = (824262.0, 825554.0)

# ------------------------------------------------------------------------------------------------------------ ASSUMED

WEST, SOUTH, EAST, NORTH, CELL = 824090.0, 825520.0, 824440.0, 825920.0, 1.0

# Corners of the trail, within 3 m of the known places; each is then rounded. From the bend to the first of TRAIL_POINTS
# it is 26 m in plan but 32 m by the chainages of PROFILE, which the bed follows.
TRAIL_CORNERS = [CROWN, (824318.0, 825822.0), (824283.0, 825813.5), (824252.5, 825804.0), (824253.5, 825779.0),
                 *[(easting, northing) for easting, northing, _ in TRAIL_POINTS[1:]],
                 (824180.0, 825600.0), (824166.0, 825570.0)]
# Below the published profile: the apron on which the village stands.
APRON_PROFILE = [(310, 14.3), (335, 11.0), (365, 8.0)]
# The 10 m fall as a step 2 m long between the bend and the marks at 121 m, in the order in which debris came to them. The
# published profile shows no fall there, and is good to 5 m: half of the fall stands above it and half below, and so
# the bed lies higher than published from the bend on and lower after the fall.
WATERFALL_LIP = (114.0, 112.2)
WATERFALL_FOOT_CHAINAGE = 116.0
ADAPTED = {88: 114.0, 98: 113.2, 130: 98.6, 162: 86.8}
BED = [(s, ADAPTED.get(s, z)) for s, z in PROFILE]
# The rugged channel between both marks: steps and boulders as roughness of the bed.
RUGGED_REACH = (121.0, 217.0)
RUGGED_BED = [(5.0, 0.6), (2.5, 0.3)]  # wavelength m, amplitude m

# Cross-section by chainage: half width of the rounded bed, gradient of the banks, and how far the bed lies below the
# smooth hillside.
SECTIONS = [  # chainage, half width m, bank gradient, incision m
    (0, 5.0, 0.55, 2.5), (30, 5.0, 0.50, 2.0), (70, 4.0, 0.50, 2.5), (88, 3.0, 0.65, 4.0), (105, 2.2, 0.85, 6.5),
    (130, 2.0, 0.85, 7.0), (195, 2.2, 0.85, 7.5),
    (225, 2.2, 0.75, 5.5), (245, 2.5, 0.60, 3.8), (260, 4.0, 0.40, 2.0), (285, 7.0, 0.25, 0.6), (365, 15.0, 0.10, -0.5)]

# The gully above the bend and four shallow hollows beside it: corners of the line, and how far it is cut into the
# hillside at its top, middle and foot. The gully joins half a metre above the trail's bed, as side channels do.
SIDE_CHANNELS = [
    # corners, incision m, half width m, bank gradient
    ([(824203.0, 825918.0), (824212.0, 825893.0), (824206.0, 825868.0), (824221.0, 825849.0), (824226.0, 825833.0),
      (824243.0, 825821.0), (824259.0, 825803.5)], (-0.5, 3.0, 4.6), 1.5, 0.75),
    ([(824147.0, 825868.0), (824154.0, 825830.0), (824141.0, 825795.0), (824144.0, 825752.0), (824127.0, 825705.0),
      (824130.0, 825662.0), (824118.0, 825622.0)], (-0.5, 1.8, -0.3), 2.0, 0.6),
    ([(824398.0, 825846.0), (824390.0, 825806.0), (824396.0, 825772.0), (824377.0, 825733.0), (824374.0, 825692.0),
      (824357.0, 825655.0), (824358.0, 825612.0)], (-0.5, 2.0, -0.3), 2.0, 0.6),
    ([(824328.0, 825762.0), (824314.0, 825728.0), (824306.0, 825698.0), (824296.0, 825668.0), (824291.0, 825626.0)],
     (-1.0, 1.0, -0.5), 2.5, 0.5),
    ([(824283.0, 825905.0), (824293.0, 825880.0), (824289.0, 825858.0), (824295.0, 825838.0), (824290.0, 825822.0)],
     (-0.8, 0.8, 0.5), 2.5, 0.5),
]

# The smooth hillside away from the trail (E, N, elevation), chosen by us: interfluves some 30 m beside the trail that
# stand above it, among them the spur south of the hillside reach without which debris could not have run WSW across the
# slope; the slope above; the apron and the village.
HILLSIDE = [
    # spur south and east of the trail
    (824376.0, 825810.0, 156.0), (824345.0, 825797.0, 150.5), (824318.0, 825786.0, 141.0), (824292.0, 825776.0, 129.0),
    (824280.0, 825752.0, 113.0), (824266.0, 825722.0, 90.0), (824252.0, 825690.0, 64.0), (824240.0, 825658.0, 42.0),
    (824228.0, 825628.0, 23.5),
    # opposite bank at the bend and west interfluve
    (824226.0, 825803.0, 124.5), (824214.0, 825778.0, 116.0), (824203.0, 825748.0, 100.0), (824193.0, 825716.0, 77.5),
    (824183.0, 825688.0, 56.0), (824170.0, 825660.0, 37.0), (824163.0, 825630.0, 20.5), (824180.0, 825835.0, 139.0),
    (824178.0, 825795.0, 119.5),
    # north of the hillside reach
    (824352.0, 825858.0, 163.0), (824322.0, 825852.0, 156.0), (824296.0, 825845.0, 147.0), (824268.0, 825842.0, 139.0),
    (824245.0, 825868.0, 153.0), (824300.0, 825890.0, 172.0), (824370.0, 825895.0, 178.0), (824250.0, 825915.0, 179.0),
    (824430.0, 825900.0, 178.0), (824430.0, 825850.0, 160.0), (824160.0, 825890.0, 166.0), (824100.0, 825900.0, 168.0),
    # east of the spur
    (824392.0, 825820.0, 150.0), (824384.0, 825770.0, 124.0), (824372.0, 825720.0, 93.0), (824358.0, 825670.0, 59.0),
    (824342.0, 825628.0, 31.0), (824346.0, 825770.0, 133.0), (824326.0, 825720.0, 100.0), (824305.0, 825670.0, 63.0),
    (824285.0, 825622.0, 27.0), (824430.0, 825790.0, 133.0), (824422.0, 825720.0, 95.0), (824412.0, 825660.0, 56.0),
    (824400.0, 825608.0, 24.0),
    # west of the west interfluve
    (824148.0, 825840.0, 139.0), (824142.0, 825790.0, 111.0), (824134.0, 825740.0, 82.0), (824130.0, 825690.0, 51.0),
    (824122.0, 825655.0, 30.0), (824095.0, 825830.0, 138.0), (824095.0, 825770.0, 106.0), (824092.0, 825710.0, 70.0),
    (824092.0, 825665.0, 40.0), (824095.0, 825615.0, 16.0),
    # apron and village
    (824130.0, 825605.0, 14.0), (824215.0, 825596.0, 14.5), (824260.0, 825592.0, 17.0), (824310.0, 825585.0, 18.0),
    (824370.0, 825575.0, 17.0), (824430.0, 825560.0, 15.0), (824095.0, 825560.0, 8.5), (824140.0, 825540.0, 6.5),
    (824200.0, 825550.0, 8.5), (824262.0, 825554.0, 12.0), (824330.0, 825535.0, 12.0), (824410.0, 825525.0, 10.5),
    (824240.0, 825522.0, 7.5), (824130.0, 825522.0, 5.5)]

ROUGHNESS = [(47.0, 1.6), (23.0, 0.8), (11.0, 0.35), (5.0, 0.14)]  # wavelength m, amplitude m, on the hillside
CHANNEL_ROUGHNESS = 0.2  # share of it on the bed

# The scar, by chainage: its upper edge lies where the published profile passes 149 mPD.
SCAR = {"start": 14.0, "end": 41.0, "width": 18.0}
# Other shapes of the same plan area, to see how much depends on the scar's: (metres farther down, times as long and narrow).
OTHER_SCARS = {"lower": (10.0, 1.0), "long": (0.0, 1.5), "wide": (0.0, 1 / 1.5)}

# Village houses: name, height m, centre E and N, bearing of the long side in degrees north of east, length and width m.
HOUSES = [
    ("House 38", 6.5, 824205.2, 825652.2, -18, 10.0, 8.0),
    ("House 38, kitchen", 3.0, 824205.5, 825657.9, -18, 4.5, 3.0),
    ("House 21A", 6.5, HOUSE_21A[0], HOUSE_21A[1], -12, 9.0, 8.0),
    ("village house 1", 6.5, 824184.0, 825641.0, -24, 9.0, 7.5),
    ("village house 2", 6.5, 824221.0, 825640.0, -10, 9.0, 8.0),
    ("village house 3", 6.5, 824210.0, 825627.0, -15, 10.0, 7.5),
    ("village house 4", 4.0, 824176.0, 825622.0, -28, 8.0, 6.5),
    ("village house 5", 8.5, 824230.0, 825618.0, -8, 9.0, 8.0),
    ("village house 6", 6.5, 824200.0, 825608.0, -22, 9.5, 7.5),
    ("village house 7", 6.5, 824166.0, 825604.0, -30, 9.0, 7.0),
    ("village house 8", 8.5, 824218.0, 825600.0, -14, 9.0, 8.0),
    ("village house 9", 6.5, 824189.0, 825587.0, -20, 9.0, 7.5),
    ("village house 10", 4.0, 824153.0, 825588.0, -32, 8.0, 6.0),
    ("village house 11", 6.5, 824208.0, 825579.0, -12, 9.0, 8.0),
    ("village house 12", 6.5, 824236.0, 825592.0, -6, 9.5, 7.5),
    ("village house 13", 8.5, 824148.0, 825565.0, -25, 9.0, 8.0),
    ("village house 14", 6.5, 824186.0, 825562.0, -18, 9.0, 8.0),
    ("village house 15", 6.5, 824240.0, 825569.0, -8, 9.0, 7.5),
    ("village house 16", 6.5, 824214.0, 825555.0, -14, 9.0, 8.0),
]


# ------------------------------------------------------------------------------------------------------------ geometry

def rounded(corners, passes=4):
    """Corner cutting (Chaikin 1974); the ends stay."""
    points = np.array(corners, float)
    for _ in range(passes):
        cut = [points[0]]
        for a, b in zip(points[:-1], points[1:]):
            cut += [0.75 * a + 0.25 * b, 0.25 * a + 0.75 * b]
        points = np.array(cut + [points[-1]])
    return points


def chainages(points):
    return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])


def monotone_curve(known, x):
    """Cubic Hermite interpolation that does not overshoot (Fritsch and Butland 1984)."""
    xs, ys = (np.array(column, float) for column in zip(*known))
    step = np.diff(xs)
    slope = np.diff(ys) / step
    tangent = np.concatenate([[slope[0]], np.zeros(len(xs) - 2), [slope[-1]]])
    for i in range(1, len(xs) - 1):
        if slope[i - 1] * slope[i] > 0:
            w1, w2 = 2 * step[i] + step[i - 1], step[i] + 2 * step[i - 1]
            tangent[i] = (w1 + w2) / (w1 / slope[i - 1] + w2 / slope[i])
    x = np.clip(x, xs[0], xs[-1])
    i = np.clip(np.searchsorted(xs, x, side="right") - 1, 0, len(xs) - 2)
    t = (x - xs[i]) / step[i]
    return ((1 + 2 * t) * (1 - t) ** 2 * ys[i] + t * (1 - t) ** 2 * step[i] * tangent[i]
            + t * t * (3 - 2 * t) * ys[i + 1] + t * t * (t - 1) * step[i] * tangent[i + 1])


def project(points, easting, northing):
    """Chainage of, and distance from, the nearest point of a line."""
    along = chainages(points)
    nearest = np.full(easting.shape, np.inf)
    chainage = np.zeros(easting.shape)
    for (ax, ay), (bx, by), start in zip(points[:-1], points[1:], along[:-1]):
        length = np.hypot(bx - ax, by - ay)
        ux, uy = (bx - ax) / length, (by - ay) / length
        t = np.clip((easting - ax) * ux + (northing - ay) * uy, 0, length)
        distance = np.hypot(easting - ax - t * ux, northing - ay - t * uy)
        closer = distance < nearest
        nearest[closer] = distance[closer]
        chainage[closer] = start + t[closer]
    return chainage, nearest


def thin_plate(known, easting, northing):
    """The smoothest surface through known points (Duchon 1977)."""
    known = np.array(known)
    origin = known[:, :2].mean(axis=0)
    plan = (known[:, :2] - origin) / 100

    def basis(squared):
        return np.where(squared > 0, squared * np.log(np.maximum(squared, 1e-30)), 0.0)

    count = len(known)
    squared = ((plan[:, None, :] - plan[None, :, :]) ** 2).sum(axis=2)
    flat = np.column_stack([np.ones(count), plan])
    # A little smoothing on the diagonal: the assumed points need not be met to the centimetre.
    system = np.block([[basis(squared) + 2e-3 * np.eye(count), flat], [flat.T, np.zeros((3, 3))]])
    weights = np.linalg.solve(system, np.concatenate([known[:, 2], np.zeros(3)]))
    x, y = (easting - origin[0]) / 100, (northing - origin[1]) / 100
    surface = weights[count] + weights[count + 1] * x + weights[count + 2] * y
    for (px, py), weight in zip(plan, weights):
        surface = surface + weight * basis((x - px) ** 2 + (y - py) ** 2)
    return surface


def smooth_minimum(a, b, width):
    """The lower of two surfaces, their edge rounded over `width` metres of height difference."""
    overlap = np.maximum(width - np.abs(a - b), 0) / width
    return np.minimum(a, b) - overlap ** 2 * width / 4


def hashed(column, row, seed):
    """A value in [-1, 1) for a lattice point, the same on every machine."""
    h = (column.astype(np.uint64) * np.uint64(0x9E3779B1) + row.astype(np.uint64) * np.uint64(0x85EBCA77)
         + np.uint64(seed) * np.uint64(0xC2B2AE3D)) & np.uint64(0xFFFFFFFF)
    for shift, factor in ((16, 0x7FEB352D), (15, 0x846CA68B)):
        h = ((h ^ (h >> np.uint64(shift))) * np.uint64(factor)) & np.uint64(0xFFFFFFFF)
    h ^= h >> np.uint64(16)
    return h.astype(float) / 2.0 ** 31 - 1


def noise(easting, northing, wavelength, seed):
    """Lattice noise with smooth interpolation, on axes turned against the grid so that no lattice shows."""
    x = (0.8 * (easting - WEST) + 0.6 * (northing - SOUTH)) / wavelength + 1000
    y = (-0.6 * (easting - WEST) + 0.8 * (northing - SOUTH)) / wavelength + 1000
    column, row = np.floor(x), np.floor(y)
    u, v = x - column, y - row
    u, v = u ** 3 * (10 - 15 * u + 6 * u * u), v ** 3 * (10 - 15 * v + 6 * v * v)
    south = (1 - u) * hashed(column, row, seed) + u * hashed(column + 1, row, seed)
    north = (1 - u) * hashed(column, row + 1, seed) + u * hashed(column + 1, row + 1, seed)
    return (1 - v) * south + v * north


# ---------------------------------------------------------------------------------------------------------- the ground

def bed_elevation(chainage):
    """The trail's bed: the published profile adapted to the waterfall, then the apron."""
    lip, height = WATERFALL_LIP
    above = [p for p in BED if p[0] < lip] + [WATERFALL_LIP]
    below = [(WATERFALL_FOOT_CHAINAGE, height - WATERFALL_HEIGHT)]
    below += [p for p in BED if p[0] > WATERFALL_FOOT_CHAINAGE] + APRON_PROFILE
    step = [WATERFALL_LIP, below[0]]
    return np.where(chainage <= lip, monotone_curve(above, chainage),
                    np.where(chainage < WATERFALL_FOOT_CHAINAGE, np.interp(chainage, *zip(*step)),
                             monotone_curve(below, chainage)))


def bed_without_fall(chainage):
    return monotone_curve(BED + APRON_PROFILE, chainage)


def rugged_bed(chainage, distance, easting, northing):
    """Steps and boulders on the bed between the marks; they fade out over 4 m along and 6 m across the trail."""
    start, end = RUGGED_REACH
    along = np.clip((chainage - start) / 4, 0, 1) * np.clip((end - chainage) / 4, 0, 1)
    across = np.clip((10 - distance) / 6, 0, 1)
    return along * across * sum(amplitude * noise(easting, northing, wavelength, seed)
                                for seed, (wavelength, amplitude) in enumerate(RUGGED_BED, 41))


def bank_rise(distance, half_width, gradient):
    """A rounded bed about two half widths wide between banks that tend to a gradient and steepen away from the bed."""
    hyperbola = gradient * (np.sqrt(distance ** 2 + half_width ** 2) - half_width)
    return hyperbola + 0.025 * np.maximum(distance - half_width - 5, 0) ** 2


def section(column, chainage):
    return np.interp(chainage, [row[0] for row in SECTIONS], [row[column] for row in SECTIONS])


def side_channel(points, incision, half_width, gradient, smooth_hillside, easting, northing):
    """A channel cut into the hillside by `incision` at its top, middle and foot; its bed never rises."""
    points = rounded(points)
    along = chainages(points)
    depth = np.interp(along / along[-1], (0, 0.6, 1), incision)
    bed = np.minimum.accumulate(smooth_hillside(points[:, 0], points[:, 1]) - depth)
    chainage, distance = project(points, easting, northing)
    return np.interp(chainage, along, bed) + bank_rise(distance, half_width, gradient)


def make_ground(trail, easting, northing):
    along = chainages(trail)
    above_trail = [(np.interp(s, along, trail[:, 0]), np.interp(s, along, trail[:, 1]),
                    float(bed_without_fall(np.float64(s)) + section(3, s))) for s in np.arange(0.0, along[-1], 10.0)]

    def smooth_hillside(e, n):
        return thin_plate(HILLSIDE + above_trail, e, n)

    chainage, distance = project(trail, easting, northing)
    ground = smooth_hillside(easting, northing)
    # Gardens and lanes are smoother than scrub, the trail smoother than the hillside.
    calm = np.clip((ground - 10) / 20, 0.15, 1) * (CHANNEL_ROUGHNESS
                                                  + (1 - CHANNEL_ROUGHNESS) * np.clip((distance - 4) / 30, 0, 1))
    rough = calm * sum(amplitude * noise(easting, northing, wavelength, seed)
                       for seed, (wavelength, amplitude) in enumerate(ROUGHNESS, 1))
    # Streams wander: the side channels are drawn on slightly displaced coordinates.
    wander = np.clip((distance - 10) / 30, 0, 1)
    shifted = [axis + wander * (7.0 * noise(easting, northing, 38.0, seed)
                                + 2.0 * noise(easting, northing, 9.0, seed + 1))
               for axis, seed in ((easting, 21), (northing, 31))]
    for channel in SIDE_CHANNELS:
        ground = smooth_minimum(ground, side_channel(*channel, smooth_hillside, *shifted), 3.0)
    ground = ground + rough
    # The fall is a wall across the bed and dies out in the banks.
    beside = np.clip((distance - 4) / 8, 0, 1)
    bed = (1 - beside) * bed_elevation(chainage) + beside * bed_without_fall(chainage)
    bank = bank_rise(distance, section(1, chainage), section(2, chainage))
    # Outside the rugged reach the bed is as smooth as its profile; its banks are a little uneven.
    uneven = 0.15 * noise(easting, northing, 7.0, 11) + 0.08 * noise(easting, northing, 3.5, 12)
    cut = bed + bank + uneven * np.clip(distance / 4, 0, 1) + rugged_bed(chainage, distance, easting, northing)
    return smooth_minimum(ground, cut, 1.2 + 0.15 * np.clip(distance, 0, 20))


# ---------------------------------------------------------------------------------------------------------------- files

def rectangle(easting, northing, bearing, length, width):
    angle = np.radians(bearing)
    along, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    return [np.array([easting, northing]) + a * length / 2 * along + b * width / 2 * across
            for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]


def feature(kind, points, properties):
    points = [[round(float(e), 2), round(float(n), 2)] for e, n in points]
    if kind == "Polygon":
        points = [points + points[:1]]
    return {"type": "Feature", "properties": properties, "geometry": {"type": kind, "coordinates": points}}


def write_geojson(path, name, features):
    """One feature a line; the crs member (GeoJSON 2008) because the coordinates are not longitude and latitude."""
    crs = {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::2326"}}
    head = json.dumps({"type": "FeatureCollection", "name": name, "crs": crs})[:-1]
    with open(path, "w", encoding="utf-8", newline="\n") as file:
        file.write(head + ', "features": [\n' + ",\n".join(map(json.dumps, features)) + "\n]}\n")


def write_terrain(path, elevation):
    rows, columns = elevation.shape
    data = gdal.GetDriverByName("GTiff").Create(
        path, columns, rows, 1, gdal.GDT_Float32,
        ["COMPRESS=DEFLATE", "PREDICTOR=3", "ZLEVEL=9", "TILED=YES", "BLOCKXSIZE=256", "BLOCKYSIZE=256"])
    crs = osr.SpatialReference()
    crs.ImportFromEPSG(2326)
    data.SetProjection(crs.ExportToWkt())
    data.SetGeoTransform((WEST, CELL, 0, NORTH, 0, -CELL))
    data.SetMetadata({"TIFFTAG_IMAGEDESCRIPTION": "Reconstruction for the scene Sham Tseng San Tsuen 1999: no survey"})
    band = data.GetRasterBand(1)
    band.SetNoDataValue(-9999)
    band.SetUnitType("m")
    band.SetDescription("elevation, mPD (reconstruction)")
    band.WriteArray(elevation)
    data.FlushCache()


def scar_outline(trail, start, end, width):
    """A rounded outline along the trail, narrower at both ends."""
    along = chainages(trail)
    middle, half_length = (start + end) / 2, (end - start) / 2
    outline = []
    for k in range(32):
        turn = 2 * np.pi * k / 32
        # A superellipse: fuller than an ellipse, as scars are.
        a, b = np.cos(turn), np.sin(turn)
        s = middle + half_length * np.sign(a) * abs(a) ** 0.7
        offset = width / 2 * np.sign(b) * abs(b) ** 0.7
        here = np.array([np.interp(s, along, trail[:, i]) for i in (0, 1)])
        ahead = np.array([np.interp(s + 1, along, trail[:, i]) for i in (0, 1)]) - here
        left = np.array([-ahead[1], ahead[0]]) / np.hypot(*ahead)
        outline.append(here + offset * left)
    return outline


def other_scar(scar, shift, stretch):
    start = scar["start"] + shift
    return {"start": start, "end": start + stretch * (scar["end"] - scar["start"]), "width": scar["width"] / stretch}


def write_vectors(folder, trail, scar, trail_name):
    write_geojson(os.path.join(folder, "flow_path.geojson"), "flow_path",
                  [feature("LineString", trail, {"name": trail_name})])
    write_geojson(os.path.join(folder, "release.geojson"), "release",
                  [feature("Polygon", scar_outline(trail, **scar), {"name": "main failure"})])
    for name, change in OTHER_SCARS.items():
        write_geojson(os.path.join(folder, f"release_{name}.geojson"), "release",
                      [feature("Polygon", scar_outline(trail, **other_scar(scar, *change)), {"name": "main failure"})])
    write_geojson(os.path.join(folder, "buildings.geojson"), "buildings",
                  [feature("Polygon", rectangle(*shape), {"name": name, "height_m": height})
                   for name, height, *shape in HOUSES])


def main(folder):
    gdal.UseExceptions()
    osr.UseExceptions()
    trail = rounded(TRAIL_CORNERS)
    columns, rows = round((EAST - WEST) / CELL), round((NORTH - SOUTH) / CELL)
    easting, northing = np.meshgrid(WEST + CELL * (np.arange(columns) + 0.5), NORTH - CELL * (np.arange(rows) + 0.5))
    ground = make_ground(trail, easting, northing)
    write_terrain(os.path.join(folder, "terrain.tif"), np.round(ground, 2).astype(np.float32))
    write_vectors(folder, trail, SCAR, "trail of the 1999 landslide, reconstructed")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else os.path.dirname(os.path.abspath(__file__)))
