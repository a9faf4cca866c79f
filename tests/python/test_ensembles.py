"""Ensembles and calibrations, by the program of the same build."""

import io
import pathlib
import tempfile
import unittest
import warnings
from unittest import mock

import numpy as np

import talus
from talus import _program

try:
    _program.find()
    MISSING = ""
except talus.TalusError as error:
    MISSING = str(error)

KEY = "material.friction_coefficient"
SMALL = {"solver.target_particle_count": np.int64(200), "solver.end_time_s": np.float32(10)}


@unittest.skipIf(MISSING, MISSING)
class EnsembleTest(unittest.TestCase):
    def setUp(self):
        caught = warnings.catch_warnings()
        caught.__enter__()
        self.addCleanup(caught.__exit__, None, None, None)
        warnings.simplefilter("ignore")

    def test_ctrl_c_keeps_what_is_complete_and_the_same_call_goes_on(self):
        def interrupt(share):
            if share > 0.1:
                raise KeyboardInterrupt

        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name) / "ensemble"
            call = dict(runs=np.int64(12), threads=1, depth_m=[np.float32(0.5)], folder=folder)
            with self.assertRaises(KeyboardInterrupt):
                talus.ensemble(None, {KEY: (0.2, np.float64(0.4))}, SMALL, progress=interrupt, **call)
            kept = {path.name: path.stat().st_mtime_ns for path in (folder / "runs").glob("*.run")}
            self.assertTrue(0 < len(kept) < 12)
            told = []
            ensemble = talus.ensemble(None, {KEY: (0.2, np.float64(0.4))}, SMALL, progress=told.append, **call)
            self.assertEqual(told[-1], 1)
            self.assertTrue(all(0 <= share <= 1 for share in told))
            for run, made in kept.items():
                self.assertEqual((folder / "runs" / run).stat().st_mtime_ns, made, "was not made again")
            self.assertRegex(repr(ensemble), "^<talus.Ensemble: 12 of 12 runs complete, in ")
            runs = ensemble.runs
            self.assertEqual(runs.rows, 12)
            self.assertTrue(((runs[KEY] >= 0.2) & (runs[KEY] <= 0.4)).all())
            self.assertLess(np.corrcoef(runs[KEY], runs["run_out_along_flow_m"])[0, 1], -0.5)
            rows = list(ensemble.distributions["result"])
            self.assertAlmostEqual(ensemble.distributions["mean"][rows.index("run_out_along_flow_m")], runs["run_out_along_flow_m"].mean(), places=3)
            self.assertEqual(set(ensemble.sensitivity["factor"]), {KEY})
            self.assertIn("House 38", ensemble.buildings["name"])
            self.assertEqual(ensemble.results["format"], "talus ensemble")
            reached = ensemble.map("probability_depth_0.5m")
            self.assertNotIn("probability_depth_1m", ensemble.map_names)
            self.assertEqual((reached.crs, reached.unit, np.nanmax(reached.values)), ("EPSG:2326", "%", 100))
            with self.assertRaisesRegex(talus.InputError, "^name = 'depth': must be one of arrival_time_p05, "):
                ensemble.map("depth")

    def test_results_in_a_temporary_folder_go_with_the_object(self):
        with mock.patch("sys.stderr", io.StringIO()) as said:
            ensemble = talus.ensemble(None, {KEY: [0.2, 0.4]}, SMALL, design="grid", progress=True)
        self.assertRegex(said.getvalue(), r"\r\[#{40}\] 100 %\n$")
        np.testing.assert_array_equal(ensemble.runs[KEY], [0.2, 0.4])
        folder = ensemble.folder
        self.assertTrue(folder.exists())
        del ensemble
        self.assertFalse(folder.exists())

    def test_calibrates_against_the_observations_of_the_scene(self):
        found = talus.calibrate(None, {KEY: (0.1, 0.4)}, {**SMALL, "solver.end_time_s": 20}, design=4, runs=6, checks=1)
        self.assertEqual(set(found.best), {KEY})
        runs = found.runs
        self.assertEqual(found.misfit, found.numbers["best_misfit"])
        self.assertAlmostEqual(found.misfit, np.nanmin(runs["misfit"]), places=4)
        self.assertEqual(found.factors["factor"].tolist(), [KEY])
        self.assertTrue(0.1 <= found.factors["low_95"][0] <= found.factors["median"][0] <= found.factors["high_95"][0] <= 0.4)
        self.assertGreater(found.posterior.rows, 100)
        self.assertEqual(found.observations["observed"].tolist(), [11, 7])
        self.assertTrue(found.best_scene.exists() and found.misfit_map.rows > 10 and found.warnings)
        self.assertEqual(found.results["format"], "talus calibration")
        self.assertRegex(repr(found), "^<talus.Calibration: . runs, least misfit .* at material.friction_coefficient = 0.")

    def test_counts_what_is_at_risk_and_compares_options(self):
        scene = pathlib.Path(__file__).parents[2] / "examples" / "risk" / "scene.toml"
        call = dict(runs=2, threads=1, settings={"solver.end_time_s": 40})
        risk = talus.risk(scene, {KEY: (0.15, 0.3)}, **call)
        self.assertGreater(risk.total["deaths"]["value"], 0)
        self.assertIn("House 38", risk.items["name"])
        self.assertIn("individual_risk", risk.map_names)
        self.assertIn("licensed engineer", risk.limits[-1])
        self.assertRegex(repr(risk), "^<talus.Risk: .* impacts per year, .* deaths per year, in ")
        options = talus.options(scene, {KEY: (0.15, 0.3)}, only=["move House 38"], **call)
        self.assertEqual(list(options.options["option"]), ["move House 38"])
        self.assertLess(options.options["deaths_per_year"][0], 0)
        with self.assertRaisesRegex(talus.InputError, "--option dam: there is no such option; options of the scene"):
            talus.options(scene, {KEY: (0.15, 0.3)}, only="dam", **call)
        with self.assertRaisesRegex(talus.InputError, r"\[\[risk_scenario\]\] is missing"):
            talus.risk(None, {KEY: (0.15, 0.3)}, **call)

    def test_finds_the_least_height_of_a_barrier_on_two_lines(self):
        scene = pathlib.Path(__file__).parents[2] / "examples" / "risk" / "scene.toml"
        call = dict(runs=2, threads=1, settings={"scene.option": "gully barrier", "release.volume_m3": 1500, "solver.end_time_s": 40})
        other = [(824236.0, 825763.0), (824264.0, 825753.0)]
        found = talus.design(scene, "gully barrier", {KEY: (0.1, 0.2)}, share=0, heights_m=(2, 14), height_step_m=6, lines={"other": other}, **call)
        self.assertEqual([line["name"] for line in found.lines], ["gully barrier", "other"])
        np.testing.assert_allclose(found.lines[1]["line_m"], other)
        # Of the heights that were tried, the least that lets nothing pass.
        own = found.heights["line"] == "gully barrier"
        enough = found.heights["height_m"][own & (found.heights["passing_share_of_runs"] == 0)]
        self.assertEqual(found.least_height, enough.min() if len(enough) else None)
        self.assertGreater(found.lines[0]["undisturbed"]["velocity_mps"]["p95"], 0)
        self.assertIn("kwan_2012_rigid", found.loads["method"])
        self.assertIn("licensed engineer", found.limits[-1])
        self.assertTrue(found.sheet.exists())
        self.assertRegex(repr(found), "^<talus.Design: gully barrier, ")
        for sentence, wrong in {
            "there is no barrier \"dam\"": dict(barrier="dam"),
            "--share 2 is refused": dict(share=2),
            r"^heights_m = 3: must be \(least, greatest\)": dict(heights_m=3),
            r"^lines\['a'\] = \[1, 2\]: must be a list of \(x, y\)": dict(lines={"a": [1, 2]}),
        }.items():
            with self.assertRaisesRegex(talus.InputError, sentence):
                talus.design(scene, **{"barrier": "gully barrier", "vary": {KEY: (0.15, 0.3)}, **call, **wrong})

    def test_refuses_in_one_sentence(self):
        for sentence, call in {
            "^vary = None: must be keys of the scene": lambda: talus.ensemble(),
            r"^vary\['k'\] = 3: must be \(low, high\), a list": lambda: talus.ensemble(None, {"k": 3}),
            r"^vary\['k'\] = nan: must be a finite": lambda: talus.ensemble(None, {"k": (0, np.nan)}),
            "^runs = -1: must be a whole number": lambda: talus.ensemble(None, {KEY: (0, 1)}, runs=-1),
            "^depth_m = 'x': must be a finite": lambda: talus.ensemble(None, {KEY: (0, 1)}, depth_m=["x"]),
            "material.frictoin": lambda: talus.ensemble(None, {"material.frictoin": (0, 1)}),
            "nowhere.toml": lambda: talus.ensemble("nowhere.toml", {KEY: (0, 1)}),
            "^design = -1: must be a whole number": lambda: talus.calibrate(None, {KEY: (0, 1)}, design=-1),
            "statistics.json: cannot be read: No such file": lambda: talus.Ensemble("nowhere"),
            "calibration.json: cannot be read: No such file": lambda: talus.Calibration("nowhere"),
        }.items():
            with self.assertRaisesRegex(talus.InputError, sentence) as caught:
                call()
            self.assertNotRegex(str(caught.exception), "\n|talus: error")


class ProgramTest(unittest.TestCase):
    def test_one_of_another_version_is_not_taken(self):
        with tempfile.TemporaryDirectory() as folder:
            other = pathlib.Path(folder) / "talus"
            other.write_text("#!/bin/sh\necho talus 9.9.9\n")
            other.chmod(0o755)
            with mock.patch.object(_program, "_candidates", lambda: iter(["/nowhere/talus", str(other)])):
                with self.assertRaisesRegex(talus.TalusError, f"is not found: {other} is 9.9.9; install both from one version"):
                    _program.find()


if __name__ == "__main__":
    unittest.main()
