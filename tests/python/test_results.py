"""What a run knows beside its maps, and many runs together."""

import contextlib
import io
import pathlib
import signal
import tempfile
import unittest
import warnings
from unittest import mock

import numpy as np

import talus
from talus import _workers
from test_talus import open_slope


class MeasuresTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with open_slope() as simulation:
            simulation.apply("put_barrier", line=[[30, 5], [30, 25]], height_m=1)
            simulation.advance(8)
            cls.house, cls.wall = simulation.structures
            cls.run_out, cls.energy, cls.series = simulation.run_out, simulation.energy, simulation.series
            cls.impacts, cls.results, cls.time = simulation.json("impacts"), simulation.results(), simulation.time

    def test_knows_what_went_over_a_barrier_and_what_it_retains(self):
        (row,) = self.impacts["barriers"]
        self.assertGreater(self.wall.overtopped_volume, 1)
        self.assertEqual(self.wall.overtopped_volume, row["overtopped_m3"])
        self.assertEqual(self.wall.retained_volume, row["retained_m3"])
        self.assertGreaterEqual(self.wall.first_overtopping_time, self.wall.first_hit_time)
        self.assertGreater(self.wall.peak_filling_height, 0.1)
        self.assertTrue(np.isnan(self.house.overtopped_volume))
        self.assertAlmostEqual(self.wall.peak_dynamic_pressure, row["peak_dynamic_pressure_kPa"] * 1e3, places=3)
        self.assertEqual(self.wall.intensity, row["intensity"])

    def test_has_the_run_out_of_the_report(self):
        figures = {figure["key"]: figure["value"] for figure in self.results["key_figures"]}
        self.assertAlmostEqual(self.run_out.along_flow, figures["run_out_along_flow_m"], places=3)
        self.assertAlmostEqual(self.run_out.runout_angle, figures["runout_angle_deg"], places=3)
        self.assertTrue(10 < self.run_out.straight < 60 and 15 < self.run_out.toe[0] < 60)
        self.assertAlmostEqual(np.degrees(np.arctan2(self.run_out.drop, self.run_out.straight)), self.run_out.runout_angle, delta=1)
        self.assertIs(self.run_out.at_least, bool(self.series["volume_left_m3"][-1] > 0))
        self.assertEqual(self.results["format"], "talus results")

    def test_has_energy_and_volumes_over_time(self):
        self.assertEqual(len(self.energy.time), len(self.series["volume_moving_m3"]))
        self.assertAlmostEqual(self.energy.time[-1], self.time, delta=0.2)
        self.assertEqual(self.energy.kinetic[0], 0)
        self.assertGreater(self.energy.kinetic.max(), 1e5)
        self.assertGreater(self.energy.lost[-1], 0)
        self.assertTrue((np.diff(self.energy.lost) > -1e-3 * self.energy.kinetic.max()).all(), "friction only takes")


class ReprTest(unittest.TestCase):
    def test_says_what_a_thing_is(self):
        with open_slope() as simulation:
            simulation.step(3)
            self.assertRegex(repr(simulation), r'^<talus.Simulation ".*": t = .* s after 3 steps, \d{3} particles, ready>$')
            self.assertRegex(repr(simulation.map("peak_depth")), r"^<talus.Map peak_depth: \d+ x \d+ cells of .* to .* m>$")
            self.assertRegex(repr(simulation.front), "^<talus.Front: ")
            self.assertRegex(repr(simulation.energy), "^<talus.Energy: .* rows to .* s")
        self.assertEqual(repr(simulation), "<talus.Simulation: closed>")
        nowhere = talus.Map("depth", np.full((1, 1), np.nan), 0, 0, 1)
        self.assertEqual(repr(nowhere), "<talus.Map depth: 1 x 1 cells of 1 m from (0, 0), no value>")
        none = np.zeros(0)
        self.assertEqual(repr(talus.Front(none, none, none)), "<talus.Front: not on the flow path>")
        self.assertEqual(repr(talus.Energy(none, none, none)), "<talus.Energy: no row>")
        table = repr(talus.Table({"run": [0, 1], "drop_m": [0.5, np.nan]}))
        self.assertEqual(table, "<talus.Table: 2 rows of 2 columns>\n  run     0, 1\n  drop_m  0.5, nan")


class TableTest(unittest.TestCase):
    def read(self, text):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "table.csv"
            file.write_text(text)
            return talus.Table.read(file)

    def test_columns_have_the_type_of_what_is_in_them(self):
        table = self.read('run,hash,name,drop_m,hit,notes\n0,0012,"a, b",1.5,yes,\n1,99,7,,no,\n')
        self.assertEqual(table.rows, 2)
        self.assertEqual(list(table), ["run", "hash", "name", "drop_m", "hit", "notes"])
        self.assertEqual([table[c].dtype.kind for c in table], ["i", "U", "U", "f", "b", "f"])
        self.assertEqual(table.row(0)["name"], "a, b")
        self.assertEqual(table["hash"][0], "0012")
        self.assertTrue(np.isnan(table["drop_m"][1]) and np.isnan(table["notes"]).all())

    def test_what_is_wrong_is_said(self):
        with self.assertRaisesRegex(talus.InputError, "table.csv, line 3: has 1 fields; it must have 2"):
            self.read("a,b\n1,2\n3\n")
        with self.assertRaisesRegex(talus.InputError, "cannot be read as CSV"):
            self.read("")
        with self.assertRaisesRegex(KeyError, "there is no column 'c'; there are a, b"):
            self.read("a,b\n1,2\n")["c"]
        with self.assertRaisesRegex(talus.InputError, "must be alike"):
            talus.Table({"a": [1], "b": [1, 2]})


class RunsTest(unittest.TestCase):
    def test_runs_are_stacked_and_told_in_a_table(self):
        key, count = "material.friction_coefficient", "solver.target_particle_count"
        with tempfile.TemporaryDirectory() as name, warnings.catch_warnings():
            warnings.simplefilter("ignore")
            scene = pathlib.Path(name) / "scene"
            open_slope(scene).close()
            # Every number as NumPy has it.
            runs = talus.study(
                scene / "scene.toml", {key: np.array([0.2, 0.5], np.float32), count: [np.int64(300), np.uint16(500)]},
                {"outputs.peak_thickness": np.bool_(False)}, end_time=np.float32(3), cell_m=np.float64(2), processes=np.int32(2),
            )  # fmt: skip
            loose = talus.study(scene / "scene.toml", {count: [300, 2000]}, end_time=0.5, processes=2)
        self.assertRegex(repr(runs), "^<talus.Study: 4 runs, . beyond a limit>$")
        self.assertRegex(repr(runs[0]), "^<talus.Result: .*friction_coefficient = 0.2, .*run-out .* m, . of 1 structures hit; ")
        depth = runs.stack("peak_depth")
        self.assertEqual(depth.shape, (4, 15, 30))
        np.testing.assert_array_equal(depth[3], runs[3].maps["peak_depth"].values)
        self.assertEqual(runs.stack("erosion_depth").shape, depth.shape)
        table = runs.table()
        self.assertEqual(table.rows, 4)
        np.testing.assert_array_equal(table[count], [300, 500, 300, 500])
        self.assertGreater(table["run_out_along_flow_m"][0], table["run_out_along_flow_m"][2])
        np.testing.assert_array_equal(table["hash"], [result.hash for result in runs])
        with self.assertRaisesRegex(talus.InputError, "^peak_depth of run 1 has other cells than that of run 0; give study"):
            loose.stack("peak_depth")
        with self.assertRaisesRegex(talus.InputError, "^name = 'depht': must be one of depth, "):
            runs.stack("depht")

    def test_a_refusal_in_a_process_of_a_study_is_raised_here(self):
        said = io.StringIO()
        with contextlib.redirect_stderr(said), self.assertRaisesRegex(talus.InputError, "friction_coefficient = -1"):
            talus.study(None, {"material.friction_coefficient": [-1, -2]}, processes=1)
        self.assertEqual(said.getvalue(), "")

    def test_ctrl_c_ends_the_processes_of_a_study(self):
        started = []

        class Worker(_workers._Worker):
            def __init__(self):
                super().__init__()
                started.append(self.process)

        with mock.patch.object(_workers, "_Worker", Worker), mock.patch.object(_workers, "wait", side_effect=KeyboardInterrupt):
            with self.assertRaises(KeyboardInterrupt):
                talus.study(None, {"material.friction_coefficient": [0.2, 0.3, 0.4]}, processes=2)
        self.assertEqual([process.returncode for process in started], [-signal.SIGKILL] * 2)


if __name__ == "__main__":
    unittest.main()
