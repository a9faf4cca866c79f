"""The scenes of the gallery (docs/gallery.md) through the program, with few particles: each must show what it is there to show.

EXAMPLES_PROGRAM names the program."""

import csv
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

EXAMPLES = pathlib.Path(__file__).parents[2] / "examples"
PARTICLES = 1200


class Result:
    """What a run printed last, and its tables."""

    def __init__(self, folder, printed):
        self.folder = folder
        self.printed = json.loads(printed.splitlines()[-1])

    def table(self, name):
        with open(self.folder / name, encoding="utf-8", newline="") as file:
            return [{key: number(text) for key, text in row.items()} for row in csv.DictReader(file)]

    def structure(self, name):
        return next(row for row in self.table("buildings.csv") if row["name"] == name)

    def houses_hit(self):
        return {row["name"] for row in self.table("buildings.csv") if row["hit"] == "yes" and row["kind"] == "building"}

    def front(self, time):
        return max(row["front_chainage_m"] for row in self.table("timeseries.csv") if row["time_s"] <= time)


def number(text):
    try:
        return float(text)
    except ValueError:
        return text


class Gallery(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def program(self, *arguments):
        done = subprocess.run([os.environ["EXAMPLES_PROGRAM"], *map(str, arguments)], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def run_scene(self, name, *more, particles=PARTICLES):
        out = pathlib.Path(self.folder.name) / f"result{len(os.listdir(self.folder.name))}"
        return Result(out, self.program("run", EXAMPLES / name / "scene.toml", "-o", out, "--json", "--threads", 1, "--set",
                                        f"solver.target_particle_count={particles}", *more))

    def between(self, low, value, high):
        self.assertGreater(value, low)
        self.assertLess(value, high)

    def test_barrier(self):
        barrier = self.run_scene("barrier").structure("barrier")
        self.assertEqual(barrier["overtopped_m3"], 0)
        self.between(600, barrier["retained_m3"], 800)

    def test_check_dam(self):
        dam = self.run_scene("check_dam").structure("check dam")
        self.between(550, dam["retained_m3"], 850)
        self.between(150, dam["passed_m3"], 400)

    def test_flexible_net(self):
        net = self.run_scene("flexible_net", particles=2000).structure("net")
        self.assertEqual(net["failed_s"], "")
        self.between(430, net["retained_m3"], 570)
        self.between(40, net["passed_m3"], 150)

    def test_deflection_dam(self):
        result = self.run_scene("deflection_dam")
        self.assertEqual(result.houses_hit(), set())
        self.between(300, result.structure("dam")["peak_force_kN"], 5000)

    def test_village(self):
        self.assertEqual(self.run_scene("village").houses_hit(), {"House 1", "House 2", "House 4"})

    def test_entrainment(self):
        self.between(220, self.run_scene("entrainment").printed["volume_entrained_m3"], 380)

    def test_hydrograph(self):
        result = self.run_scene("hydrograph")
        self.assertAlmostEqual(result.printed["volume_released_m3"], 1998.5, delta=5)
        first = {}
        for row in result.table("gauges.csv"):
            if row["depth_m"] > 0.5:
                first.setdefault(row["name"], row["time_s"])
        self.between(10, first["middle of the channel"], 20)
        self.between(first["middle of the channel"] + 10, first["top of the fan"], 50)

    def test_two_surges(self):
        result = self.run_scene("two_surges")
        self.assertLess(result.front(65) - result.front(44), 1, "the first surge lies")
        self.between(result.front(65) + 2, result.printed["front_chainage_m"], result.front(65) + 15)

    def test_forest(self):
        forest = self.run_scene("forest").printed["run_out_along_flow_m"]
        without = self.run_scene("forest", "--variant", "without_forest").printed["run_out_along_flow_m"]
        self.between(10, without - forest, 40)

    def test_hazard_zones(self):
        out = pathlib.Path(self.folder.name) / "ensemble"
        scene = EXAMPLES / "hazard_zones"
        self.program("ensemble", scene / "scene.toml", "--plan", scene / "plan.toml", "-o", out, "--quiet", "--runs", 4,
                     "--threads", 1)
        result = Result(out, (out / "results.json").read_text(encoding="utf-8").replace("\n", " "))
        zones = {row["zone"]: row["area_m2"] for row in result.printed["zones"]["areas"]["rows"]}
        self.between(800, zones["high (red)"], 2000)
        self.assertGreater(zones["residual (yellow-white)"], 500)
        hit = {row["name"]: row["probability_hit"] for row in result.table("buildings.csv")}
        self.assertGreater(hit["House 1"], hit["Church"])

    def test_risk(self):
        out = pathlib.Path(self.folder.name) / "options"
        arguments = (EXAMPLES / "risk" / "scene.toml", "--vary", "material.friction_coefficient=0.15:0.3", "--runs", 3,
                     "--threads", 1, "--quiet", "-o", out)  # fmt: skip
        self.program("options", *arguments)
        results = json.loads((out / "results.json").read_text(encoding="utf-8"))
        as_it_is, barrier, _, moved = results["options"]
        # At most the frequency of the large events: the small ones stop above the houses.
        self.between(0.0005, as_it_is["total"]["impacts"]["value"], 0.0021)
        self.assertLess(barrier["difference"]["deaths"]["value"], 0)
        self.assertEqual(next(item for item in moved["items"] if item["name"] == "House 38")["impacts"]["value"], 0)
        self.assertGreater(moved["cost_per_year"], 0.03 * 8e6)
        before = (out / "risk.csv").read_bytes()
        self.program("options", *arguments)  # again: nothing is computed, and it is the same
        self.assertEqual(before, (out / "risk.csv").read_bytes())

    def test_valley(self):
        """Its script makes exactly the committed files."""
        try:
            import numpy as np
            from osgeo import gdal
        except ImportError:
            self.skipTest("the valley is not checked: numpy or GDAL is missing (install python3-gdal)")
        gdal.UseExceptions()
        valley = EXAMPLES / "valley"
        made = pathlib.Path(self.folder.name)
        subprocess.run([sys.executable, valley / "make_valley.py", made], check=True)
        names = sorted(file.name for file in made.iterdir())
        self.assertEqual(names, sorted(file.name for file in valley.iterdir() if file.suffix in (".tif", ".geojson", ".json")))
        for name in names:
            if name != "terrain.tif":
                self.assertEqual((made / name).read_text(encoding="utf-8"), (valley / name).read_text(encoding="utf-8"), name)
        rasters = [gdal.Open(str(where / "terrain.tif")) for where in (made, valley)]
        self.assertEqual(*(raster.GetGeoTransform() for raster in rasters))
        self.assertEqual(*(raster.GetProjection() for raster in rasters))
        self.assertTrue(np.array_equal(*(raster.ReadAsArray() for raster in rasters)))


if __name__ == "__main__":
    unittest.main()
