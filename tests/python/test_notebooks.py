"""Every cell of the notebooks runs. Their parameters, the cell tagged so, are made coarse first. Without matplotlib, what
they draw is not looked at."""

import importlib.util
import json
import pathlib
import sys
import unittest
from unittest import mock

MATPLOTLIB = importlib.util.find_spec("matplotlib") is not None
if MATPLOTLIB:
    import matplotlib

    matplotlib.use("Agg")
else:
    sys.modules["matplotlib"] = sys.modules["matplotlib.pyplot"] = mock.MagicMock()

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "examples/notebooks"


def run_notebook(name, pictures=None, **coarse):
    """The variables after all cells. `pictures`: a folder for what was drawn."""
    cells = [cell for cell in json.loads((FOLDER / f"{name}.ipynb").read_text())["cells"] if cell["cell_type"] == "code"]
    variables = {}
    for cell in cells:
        exec(compile("".join(cell["source"]), f"{name}.ipynb", "exec"), variables)
        if "parameters" in cell["metadata"].get("tags", []):
            unknown = set(coarse) - set(variables)
            assert not unknown, f"{name}.ipynb has no parameters {unknown}"
            variables.update(coarse)
    if MATPLOTLIB:
        plt = variables["plt"]
        for number in plt.get_fignums() if pictures else []:
            plt.figure(number).savefig(pathlib.Path(pictures) / f"{name}_{number}.png")
        plt.close("all")
    return variables


class NotebookTest(unittest.TestCase):
    def setUp(self):
        printed = mock.patch("builtins.print")
        printed.start()
        self.addCleanup(printed.stop)

    def test_first_map(self):
        after = run_notebook("first_map", PARTICLES=400, END_TIME=45)
        self.assertGreater(after["flooded"].sum(), 100)
        self.assertIn("House 38", [house.name for house in after["hit"]])

    def test_barrier_study(self):
        runs = run_notebook("barrier_study", PARTICLES=400, HEIGHTS=[0, 4], END_TIME=45)["runs"]
        (bare, _, _), (behind, wall, _) = runs[0], runs[4]
        self.assertTrue(wall.hit and wall.is_barrier)
        self.assertLess(behind.peak_force, 0.7 * bare.peak_force)

    def test_back_analysis(self):
        after = run_notebook(
            "back_analysis", PARTICLES=300, FRICTION=[0.1, 0.3], TURBULENT_FRICTION=[500], END_TIME=30, PROCESSES=2
        )
        self.assertEqual(after["table"].shape, (2, 1))
        self.assertLess(after["table"][0, 0], after["table"][1, 0])


if __name__ == "__main__":
    unittest.main()
