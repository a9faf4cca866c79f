"""The Python package on the library that was built."""

import contextlib
import dataclasses
import enum
import importlib.util
import inspect
import io
import pathlib
import tempfile
import unittest

import numpy as np

import talus

ROWS, COLUMNS = 30, 60


def slope(**settings):
    """A slope of 1 : 2 that falls to the east, with a scar 1 m deep and a house below it."""
    elevation = np.broadcast_to(200 - 0.5 * np.arange(COLUMNS), (ROWS, COLUMNS))
    release = np.zeros((ROWS, COLUMNS))
    release[10:20, 5:15] = 1
    house = talus.Building([(40, 12), (46, 12), (46, 18), (40, 18)], 4, "house")
    keys = {"solver.target_particle_count": 600, "material.friction_coefficient": 0.2, "solver.thread_count": 1}
    return elevation, release, dict(crs="EPSG:32650", cell=1, buildings=[house], settings={**keys, **settings})


def open_slope(folder=None, **settings):
    elevation, release, rest = slope(**settings)
    return talus.Simulation.from_arrays(elevation, release, folder=folder, **rest)


class SimulationTest(unittest.TestCase):
    def test_reads_debris_as_views_without_copies(self):
        with open_slope() as simulation:
            x, _, _ = simulation.position
            again, _, _ = simulation.position
            self.assertEqual(x.ctypes.data, again.ctypes.data)
            self.assertFalse(x.flags.owndata)
            self.assertRaises(ValueError, x.fill, 0)
            self.assertAlmostEqual(len(x) * simulation.particle_volume, 100, delta=1)
            self.assertAlmostEqual(float(x.mean()) + simulation.origin[0], 10, delta=0.3)
            self.assertEqual(len(np.unique(simulation.id)), len(x))
            simulation.advance(2)
            self.assertGreater(max(float(v.max()) for v in simulation.velocity), 1)

    def test_reads_maps_front_and_structures(self):
        with open_slope() as simulation:
            simulation.advance(6)
            speed = simulation.map("peak_speed")
            self.assertGreater(np.nanmax(speed.values), 2)
            row, column = np.unravel_index(np.nanargmax(simulation.map("peak_depth").values), speed.values.shape)
            self.assertTrue(5 < speed.x[column] < 45 and 8 < speed.y[row] < 22)
            self.assertTrue(np.all(np.diff(simulation.front.chainage) > 0))
            (house,) = simulation.structures
            self.assertTrue(house.hit and house.name == "house" and house.peak_force > 1000)
            self.assertEqual(simulation.json("state")["time_s"], simulation.time)

    def test_changes_material_and_obstacles(self):
        with open_slope() as simulation:
            simulation.advance(1)
            simulation.set("material.friction_coefficient", 0.3)
            created = simulation.apply("put_barrier", line=[[35, 5], [35, 25]], height_m=4)
            self.assertNotEqual(created, "")
            simulation.advance(5)
            house, wall = simulation.structures
            self.assertTrue(wall.is_barrier and wall.hit and not house.hit)

    def test_refuses_with_the_sentence_of_the_program(self):
        with self.assertRaisesRegex(talus.InputError, "friction_coefficient"):
            open_slope(**{"material.friction_coefficient": -1})
        with self.assertRaisesRegex(talus.InputError, "nowhere.toml"):
            talus.Simulation("nowhere.toml")
        elevation, release, rest = slope()
        with self.assertRaisesRegex(talus.InputError, "shape"):
            talus.Simulation.from_arrays(elevation, release[1:], **rest)
        with open_slope() as simulation:
            with self.assertRaisesRegex(talus.InputError, "peak_depth"):
                simulation.map("depht")
        with self.assertRaisesRegex(talus.InputError, "closed"):
            simulation.step()

    def test_opens_what_was_saved_and_writes_results(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            with open_slope(folder / "scene") as simulation:
                simulation.advance(1)
                simulation.set("material.friction_coefficient", 0.4)
                simulation.advance(1.5)
                simulation.save(folder / "saved.json")
                with talus.Simulation.from_saved(folder / "saved.json") as again:
                    self.assertEqual(again.hash, simulation.hash)
                simulation.write_results(folder / "results")
            self.assertTrue((folder / "results" / "report.html").exists())


def needs(library):
    try:
        found = importlib.util.find_spec(library) is not None
    except ValueError:
        found = False  # what stands in for it in test_notebooks.py
    return unittest.skipUnless(found, f"{library} is not installed")


class OtherLibrariesTest(unittest.TestCase):
    """Results in the hands of other packages, where those are installed."""

    @classmethod
    def setUpClass(cls):
        settings = {"solver.target_particle_count": 400, "solver.thread_count": 1}
        cls.result = talus.run(settings=settings, end_time=15, progress=False)
        cls.depth = cls.result.maps["peak_depth"]

    @needs("xarray")
    def test_xarray(self):
        maps = self.result.to_xarray()
        self.assertIn("peak_speed", maps)
        self.assertNotIn("erosion_depth", maps)  # no value anywhere
        self.assertEqual(maps.peak_depth.attrs["units"], "m")
        self.assertEqual(maps.attrs["crs"], "EPSG:2326")
        np.testing.assert_array_equal(maps.peak_depth.values, self.depth.values)
        deepest = maps.peak_depth.where(maps.peak_depth == maps.peak_depth.max(), drop=True)
        row, column = np.unravel_index(np.nanargmax(self.depth.values), self.depth.values.shape)
        self.assertEqual((float(deepest.x[0]), float(deepest.y[0])), (self.depth.x[column], self.depth.y[row]))

    @needs("geopandas")
    def test_geopandas(self):
        cells = self.result.to_geopandas(threshold=0.2)
        self.assertEqual(len(cells), np.count_nonzero(self.depth.values > 0.2))
        self.assertEqual(cells.crs.to_epsg(), 2326)
        self.assertTrue((cells.peak_depth > 0.2).all())
        self.assertAlmostEqual(cells.area.sum(), len(cells) * self.depth.cell**2, places=3)
        first = cells.iloc[0]
        column = int((first.geometry.centroid.x - self.depth.x_min) / self.depth.cell)
        row = int((first.geometry.centroid.y - self.depth.y_min) / self.depth.cell)
        self.assertEqual(first.peak_depth, self.depth.values[row, column])

    @needs("matplotlib")
    def test_plot(self):
        import matplotlib

        matplotlib.use("Agg")
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots()
        self.addCleanup(plt.close, figure)
        self.assertIs(self.result.plot(axes), axes)
        (image,) = axes.get_images()
        np.testing.assert_array_equal(image.get_array().filled(np.nan), self.depth.values)
        self.assertEqual(image.get_extent()[0], self.depth.x_min)
        self.assertEqual(figure.axes[1].get_ylabel(), "peak depth, m")


class InterfaceTest(unittest.TestCase):
    def test_everything_public_has_a_docstring_and_type_hints(self):
        for name in talus.__all__:
            thing = getattr(talus, name)
            if not callable(thing):
                continue
            self.assertTrue(inspect.getdoc(thing), name)
            functions = [(name, thing)]
            if inspect.isclass(thing):
                if issubclass(thing, (enum.Enum, Exception)):
                    continue
                functions = [(f"{name}.{n}", f) for n, f in vars(thing).items() if not n.startswith("_")]
                if dataclasses.is_dataclass(thing):
                    self.assertTrue(thing.__annotations__, name)
                    functions = [(n, f) for n, f in functions if inspect.isfunction(f)]
            for label, function in functions:
                function = getattr(function, "fget", None) or getattr(function, "__func__", function)
                if not inspect.isfunction(function):
                    continue
                self.assertTrue(inspect.getdoc(function), label)
                hints = inspect.signature(function)
                self.assertIsNot(hints.return_annotation, inspect.Signature.empty, label)
                for parameter in list(hints.parameters.values()):
                    if parameter.name not in ("self", "cls"):
                        self.assertIsNot(parameter.annotation, inspect.Parameter.empty, f"{label}({parameter.name})")


class StudyTest(unittest.TestCase):
    def test_runs_every_combination_in_processes_of_their_own(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name) / "scene"
            open_slope(folder).close()
            key, count = "material.friction_coefficient", {"solver.target_particle_count": 400}
            with self.assertWarnsRegex(UserWarning, "^2 of 2 runs are beyond a limit; the first: Resolution"):
                results = talus.study(folder / "scene.toml", {key: [0.2, 0.5]}, count, end_time=4, processes=2)
            self.assertEqual([r.settings[key] for r in results], [0.2, 0.5])
            reached = [np.nanmax(r.front.chainage) for r in results]
            self.assertGreater(reached[0], reached[1] + 1)
            said = io.StringIO()
            with contextlib.redirect_stderr(said), self.assertWarnsRegex(UserWarning, "particles thick"):
                alone = talus.run(folder / "scene.toml", {key: 0.2, **count}, end_time=4, progress=True)
                talus.run(folder / "scene.toml", {"solver.end_time_s": 1.003, **count}, progress=True)  # to its own end
            lines = [line for line in said.getvalue().replace("\x1b[K", "").split("\r") if line]
            for line in lines:
                self.assertRegex(line, r"^\[#* *\] \d+\.\d s, about \d+:\d\d left")
            first = [k for k, line in enumerate(lines) if k > 0 and line.count("#") < lines[k - 1].count("#")]
            self.assertEqual(len(first), 1, "each bar only grows")
            for bar in (lines[: first[0]], lines[first[0] :]):
                self.assertEqual(bar[-1].count("#"), 40)
            self.assertEqual(alone.hash, results[0].hash)
            self.assertEqual(set(alone.maps), set(talus.UNITS))


if __name__ == "__main__":
    unittest.main()
