"""The Python package on the library that was built."""

import contextlib
import copy
import ctypes
import dataclasses
import enum
import gc
import importlib.util
import inspect
import io
import os
import pathlib
import pickle
import signal
import tempfile
import threading
import unittest
import weakref

import numpy as np

import talus
from talus import _library

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
    def test_reads_debris_as_arrays_that_stay_as_they_are(self):
        with open_slope() as simulation:
            x, _, _ = simulation.position
            before = x.copy()
            self.assertAlmostEqual(len(x) * simulation.particle_volume, 100, delta=1)
            self.assertAlmostEqual(float(x.mean()) + simulation.origin[0], 10, delta=0.3)
            self.assertEqual(len(np.unique(simulation.id)), len(x))
            simulation.advance(2)
            self.assertGreater(max(float(v.max()) for v in simulation.velocity), 1)
            depth, y = simulation.map("depth").values, simulation.position[1]
        self.assertTrue(x.flags.owndata and depth.flags.owndata and y.flags.owndata)
        np.testing.assert_array_equal(x, before)
        self.assertTrue(np.isfinite(y.sum()))

    def test_is_neither_copied_nor_pickled(self):
        with open_slope() as simulation:
            for copied in (copy.copy, copy.deepcopy, pickle.dumps):
                with self.assertRaisesRegex(TypeError, "save"):
                    copied(simulation)
            simulation.step()

    def test_goes_on_after_ctrl_c_as_if_nothing_had_been(self):
        told = []

        def interrupt(share):
            told.append(share)
            os.kill(os.getpid(), signal.SIGINT)

        with open_slope() as simulation, open_slope() as undisturbed:
            with self.assertRaises(KeyboardInterrupt):
                simulation.advance(1000, progress=interrupt)
            self.assertEqual(len(told), 1)
            self.assertLess(simulation.time, 1000)
            simulation.advance(max(5, simulation.time), told.append)
            undisturbed.advance(simulation.time)
            self.assertEqual(simulation.hash, undisturbed.hash)
            self.assertEqual(told[-1], 1)
            self.assertTrue(all(0 <= share <= 1 for share in told))
        with self.assertRaises(KeyboardInterrupt):
            talus.Simulation(settings={"solver.target_particle_count": 100_000}, progress=interrupt)

    def test_ctrl_c_does_not_wait_for_a_long_step(self):
        caller, interrupted, ended, after = _library.Caller(), threading.Event(), [], []

        def long_step(_):
            os.kill(os.getpid(), signal.SIGINT)
            ended.append(interrupted.wait(30))

        with self.assertRaises(KeyboardInterrupt):
            caller(long_step)
        self.assertEqual(ended, [])
        interrupted.set()
        caller(lambda _: after.append(list(ended)))
        self.assertEqual(after, [[True]], "the next call waits for the one before it")
        caller.close()

    def test_ctrl_c_while_a_call_is_handed_over_cancels_it(self):
        caller, interrupted, ended, after = _library.Caller(), threading.Event(), [], []
        hand_over = caller._threads.submit

        def interrupted_hand_over(*call):
            caller._threads.submit = hand_over
            hand_over(*call)
            raise KeyboardInterrupt

        def long_step(_):
            ended.append(interrupted.wait(30))

        caller._threads.submit = interrupted_hand_over
        with self.assertRaises(KeyboardInterrupt):
            caller(long_step, abandoned=lambda: after.append("freed"))
        interrupted.set()
        caller(lambda _: after.append(list(ended)))
        self.assertEqual(after, ["freed", [True]])
        caller.close()

    def test_the_collector_takes_one_that_was_refused(self):
        def refused():
            try:
                open_slope(**{"material.friction_coefficient": -1})
            except talus.InputError as error:
                error.cycle = error  # and in its frames the simulation that was not opened
                return weakref.ref(error)

        made = refused()
        self.assertIsNotNone(made())
        collected = threading.Thread(target=gc.collect, daemon=True)
        collected.start()
        collected.join(30)
        self.assertFalse(collected.is_alive(), "waits for a thread that has ended")
        self.assertIsNone(made())

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

    def test_refuses_arguments_in_one_sentence_that_names_them(self):
        elevation, release, rest = slope()
        nan, outline = float("nan"), rest["buildings"][0].outline

        def refused(sentence, **changed):
            with self.assertRaises(talus.InputError) as caught:
                talus.Simulation.from_arrays(**{"elevation": elevation, "release": release, **rest, **changed})
            self.assertRegex(str(caught.exception), "^" + sentence)
            self.assertNotRegex(str(caught.exception), "/tmp|scene.toml|\\n")

        for height in (0, -3, nan, float("inf"), "6", None, True, 1e9):
            refused(r"buildings\[0\].height = .*: must be a finite number above 0", buildings=[talus.Building(outline, height)])
        refused(r"buildings\[0\].name = .*NUL", buildings=[talus.Building(outline, 6, "a\0b")])
        refused(r"buildings\[0\].outline has shape", buildings=[talus.Building(outline[:2], 6)])
        refused(r"buildings\[0\].outline .*finite", buildings=[talus.Building([(nan, 0), (1, 0), (1, 1)], 6)])
        refused(r"buildings\[0\] must be a talus.Building", buildings=[outline])
        refused("elevation is a masked array", elevation=np.ma.masked_array(elevation, elevation > 190))
        refused("release has values of type complex128", release=release + 1j)
        refused("elevation has values of type object", elevation=np.full((ROWS, COLUMNS), None))
        refused(r"elevation\[0, 0\] = inf", elevation=np.full((ROWS, COLUMNS), 1e300))
        refused(r"release\[2, 1\] = -1", release=np.where(np.arange(ROWS * COLUMNS).reshape(ROWS, -1) == 121, -1, release))
        refused("cell = nan", cell=nan)
        refused("cell = -1", cell=-1)
        refused("x_min = nan", x_min=nan)
        refused("crs = .*NUL", crs="EPSG:32650\0")
        refused("crs = 32650: must be a text", crs=32650)
        refused('crs = "EPSG:0"', crs="EPSG:0")
        refused("folder = .*NUL", folder="a\0b")
        refused(r"settings\['scene.title'\] = .*NUL", settings={"scene.title": "a\0b"})
        refused(r"settings\['solver.end_time_s'\] = None", settings={"solver.end_time_s": None})
        refused(".*solver.end_time_s", settings={"solver.end_time_s": nan})
        with self.assertRaisesRegex(talus.InputError, "^scene = .*NUL"):
            talus.Simulation("a\0b")
        with self.assertRaisesRegex(talus.InputError, "/dev/zero: is a pipe, a socket or a device"):
            talus.Simulation.from_saved("/dev/zero")
        with open_slope() as simulation:
            for count in (-1, 2**64, 1.5, nan, True, "1"):
                with self.assertRaisesRegex(talus.InputError, "^count = .*: must be a whole number"):
                    simulation.step(count)
            for time in (-1, nan, float("inf"), "1", None, 1j, [1]):
                with self.assertRaisesRegex(talus.InputError, "^time = .*: must be"):
                    simulation.advance(time)
            with self.assertRaisesRegex(talus.InputError, "^value = nan: must be a finite number"):
                simulation.set("material.friction_coefficient", nan)
            with self.assertRaisesRegex(talus.InputError, "^key = "):
                simulation.set("material.friction_coefficient\0", 0.3)
            with self.assertRaisesRegex(talus.InputError, "^height_m = nan: must be"):
                simulation.apply("put_barrier", line=[[35, 5], [35, 25]], height_m=nan)
            self.assertNotEqual(simulation.apply("put_barrier", line=np.array([[35, 5], [35, 25]]), height_m=np.float32(4)), "")
            with self.assertRaisesRegex(talus.InputError, "^name = 3: must be a text"):
                simulation.map(3)
            self.assertEqual(simulation.step(0), talus.Phase.READY)
            self.assertEqual(simulation.steps, 0)

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
    def test_declares_the_structs_of_the_library_that_it_has_loaded(self):
        self.assertEqual(talus.__version__.split(".")[:2], _library.INTERFACE.split("."))
        with self.assertRaisesRegex(ImportError, "libtalus is 0.99.1, and this package is for"):
            _library.check_version("0.99.1")
        with open_slope() as simulation:
            for function, struct in {
                "talus_get_state": _library.State, "talus_get_debris": _library.Debris, "talus_get_front": _library.Front,
            }.items():  # fmt: skip
                wrong = struct()
                wrong.size = 8
                with self.assertRaisesRegex(talus.InputError, rf"size = 8: must be sizeof, {ctypes.sizeof(struct)} "):
                    _library.call(function, simulation._handle, ctypes.byref(wrong))
            for wrong, function, arguments in (
                (_library.Map(), "talus_get_map", [b"depth"]), (_library.Structure(), "talus_get_structure", [0]),
            ):  # fmt: skip
                size, wrong.size = wrong.size, 8
                with self.assertRaisesRegex(talus.InputError, rf"size = 8: must be sizeof, {size} "):
                    _library.call(function, simulation._handle, *arguments, ctypes.byref(wrong))

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
            for line in lines:  # on a fast machine too little is done at first to say what is left
                self.assertRegex(line, r"^\[#* *\] \d+\.\d s(, about \d+:\d\d left)?$")
            first = [k for k, line in enumerate(lines) if k > 0 and line.count("#") < lines[k - 1].count("#")]
            self.assertEqual(len(first), 1, "each bar only grows")
            for bar in (lines[: first[0]], lines[first[0] :]):
                self.assertEqual(bar[-1].count("#"), 40)
                self.assertRegex(bar[-1], r", about 0:00 left$")
            self.assertEqual(alone.hash, results[0].hash)
            self.assertEqual(set(alone.maps), set(talus.UNITS))


if __name__ == "__main__":
    unittest.main()
