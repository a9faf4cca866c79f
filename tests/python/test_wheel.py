"""The wheel installs into an environment of its own and runs there, with its own library and program."""

import importlib.util
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import zipfile

import talus
from talus import _program

MAKER = pathlib.Path(talus.__file__).resolve().parents[1] / "make_wheel.py"

CHECK = """
import pathlib, sys
import talus
from talus import _library, _program
for file in (talus.__file__, _library.library._name, _program.find()):
    assert pathlib.Path(file).is_relative_to(sys.prefix), file
with talus.Simulation(settings={"solver.target_particle_count": 200}) as simulation:
    simulation.step(2)
    print(talus.__version__, simulation.steps)
"""


def missing():
    for module in ("pip", "venv"):
        if importlib.util.find_spec(module) is None:
            return f"{module} is not installed"
    if not MAKER.exists():
        return "this is not a source tree"
    try:
        _program.find()
    except talus.TalusError as error:
        return str(error)
    return ""


def loaded_library():
    """The file of the library that this process uses."""
    maps = pathlib.Path("/proc/self/maps").read_text()
    return pathlib.Path(re.search(r"\S*/libtalus\.so\S*", maps)[0])


@unittest.skipIf(missing(), missing())
class WheelTest(unittest.TestCase):
    def test_installs_without_an_index_and_runs(self):
        environment = {key: value for key, value in os.environ.items() if key not in ("PYTHONPATH", "LD_LIBRARY_PATH")}

        def run(*command):
            done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment, cwd=folder)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            return done.stdout

        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            made = subprocess.run(
                [sys.executable, MAKER, loaded_library(), _program.find(), folder], check=True, capture_output=True, text=True
            )
            wheel = pathlib.Path(made.stdout.strip())
            self.assertRegex(wheel.name, r"^talus-[0-9.]+-py3-none-linux_\w+\.whl$")
            # NumPy, and pip itself, are the system's.
            run(sys.executable, "-m", "venv", "--without-pip", "--system-site-packages", folder / "venv")
            python = folder / "venv" / "bin" / "python3"
            run(python, "-m", "pip", "install", "--no-index", "--no-deps", "--disable-pip-version-check", wheel)
            self.assertEqual(run(python, "-c", CHECK).split(), [talus.__version__, "2"])
            self.assertIn(f"talus {talus.__version__}", run(folder / "venv" / "bin" / "talus", "--version"))
            with zipfile.ZipFile(wheel) as archive:
                self.assertIn(b"Requires-Dist: numpy", archive.read(f"talus-{talus.__version__}.dist-info/METADATA"))


if __name__ == "__main__":
    unittest.main()
