"""Writes the avalanche with which docs/performance.md measures the depth-averaged model: python3 benchmarks/avalanche.py FOLDER

A face of up to 55 degrees with gullies that flattens: 680 x 400 cells of 5 m, 330,000 m3, 300 s, Voellmy's friction.
"""

import json
import math
import pathlib
import sys

COLUMNS, ROWS, CELL = 680, 400, 5.0  # m


def elevation(x: float, y: float) -> float:
    face = 1600 * math.exp(-x / 1100) + 0.06 * (COLUMNS * CELL - x)
    gullies = 8 * math.sin(x / 140) * math.cos(y / 90)
    bowl = 60 * ((y - 1000) / 1000) ** 2 * math.exp(-x / 1800)
    return face + gullies + bowl


def main(folder: pathlib.Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / "terrain.asc", "w", encoding="ascii") as file:
        file.write(f"ncols {COLUMNS}\nnrows {ROWS}\nxllcorner 0\nyllcorner 0\ncellsize {CELL}\nNODATA_value -9999\n")
        for row in range(ROWS):
            y = (ROWS - row - 0.5) * CELL
            file.write(" ".join(f"{elevation((column + 0.5) * CELL, y):.2f}" for column in range(COLUMNS)) + "\n")
    outline = [[100, 650], [500, 650], [500, 1350], [100, 1350], [100, 650]]
    feature = {"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [outline]}}
    (folder / "release.geojson").write_text(json.dumps({"type": "FeatureCollection", "features": [feature]}))
    (folder / "scene.toml").write_text(
        '[scene]\ntitle = "Generated avalanche"\n\n[terrain]\nfile = "terrain.asc"\ncrs = "local"\n\n'
        '[[release]]\nname = "avalanche"\nfile = "release.geojson"\nvolume_m3 = 330000\n\n'
        "[material]\nfriction_coefficient = 0.2\nturbulent_friction_mps2 = 1500\n\n"
        '[solver]\nmodel = "depth_averaged"\ngrid_cell_m = 5\nend_time_s = 300\nstop_moving_share = 0\n'
    )


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("python3 benchmarks/avalanche.py FOLDER")
    main(pathlib.Path(sys.argv[1]))
