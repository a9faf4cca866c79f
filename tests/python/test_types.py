"""mypy finds nothing in the package."""

import importlib.util
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import talus

PACKAGE = pathlib.Path(talus.__file__).parent
CONFIGURATION = PACKAGE.parent / "mypy.ini"
MYPY = [sys.executable, "-m", "mypy"] if importlib.util.find_spec("mypy") else [shutil.which("mypy") or ""]


@unittest.skipUnless(MYPY[0], "mypy is not installed")
@unittest.skipUnless(CONFIGURATION.exists(), "this is not a source tree")
class TypesTest(unittest.TestCase):
    def test_the_package_is_typed(self):
        self.assertTrue((PACKAGE / "py.typed").exists())
        with tempfile.TemporaryDirectory() as cache:
            checked = subprocess.run(
                [*MYPY, "--config-file", CONFIGURATION, "--cache-dir", cache, "--python-executable", sys.executable, PACKAGE],
                capture_output=True, text=True, check=False,
            )  # fmt: skip
        self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)


if __name__ == "__main__":
    unittest.main()
