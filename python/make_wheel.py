#!/usr/bin/env python3
"""Makes a wheel of the Python package with the library and the program of a build in it, without any other package.

    python/make_wheel.py build/release/apps/embed/libtalus.so build/release/bin/talus build/package
"""

import argparse
import base64
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sysconfig
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
TIME = (1980, 1, 1, 0, 0, 0)  # the same files make the same wheel


def stripped(file):
    """The bytes of a binary without the names that only debuggers want."""
    if not shutil.which("strip"):
        return file.read_bytes()
    with tempfile.TemporaryDirectory() as folder:
        smaller = pathlib.Path(folder) / file.name
        subprocess.run(["strip", "--strip-unneeded", "-o", smaller, file.resolve()], check=True)
        return smaller.read_bytes()


def metadata(version):
    return f"""Metadata-Version: 2.1
Name: talus
Version: {version}
Summary: Landslides and debris flows on real terrain, with position-based dynamics
License: Apache-2.0
Requires-Python: >=3.9
Requires-Dist: numpy
Provides-Extra: all
Requires-Dist: geopandas; extra == "all"
Requires-Dist: matplotlib; extra == "all"
Requires-Dist: pandas; extra == "all"
Requires-Dist: xarray; extra == "all"
License-File: LICENSE
"""


def make(library, program, folder):
    """Writes the wheel into `folder` and returns its path."""
    version = subprocess.run([program, "--version"], check=True, capture_output=True, text=True).stdout.split()[1]
    interface = re.search(r'^INTERFACE = "(.*?)"', (ROOT / "python/talus/_library.py").read_text(), re.MULTILINE)[1]
    tag = "py3-none-" + re.sub(r"[-.]", "_", sysconfig.get_platform())
    about = f"talus-{version}.dist-info"
    files = {f"talus/{path.name}": path.read_bytes() for path in sorted((ROOT / "python/talus").glob("*.py"))}
    files["talus/py.typed"] = b""
    files[f"talus/libtalus.so.{interface}"] = stripped(library)
    files[f"talus-{version}.data/scripts/talus"] = stripped(program)
    files[f"{about}/LICENSE"] = (ROOT / "LICENSE").read_bytes()
    files[f"{about}/METADATA"] = metadata(version).encode()
    files[f"{about}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: talus\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
    record = "".join(
        f"{name},sha256={base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b'=').decode()},{len(content)}\n"
        for name, content in files.items()
    )
    files[f"{about}/RECORD"] = (record + f"{about}/RECORD,,\n").encode()

    folder.mkdir(parents=True, exist_ok=True)
    wheel = folder / f"talus-{version}-{tag}.whl"
    unfinished = wheel.with_suffix(".unfinished")
    with zipfile.ZipFile(unfinished, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            entry = zipfile.ZipInfo(name, TIME)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o100755 if "/scripts/" in name or ".so" in name else 0o100644) << 16
            archive.writestr(entry, content)
    os.replace(unfinished, wheel)
    return wheel


if __name__ == "__main__":
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("library", type=pathlib.Path)
    arguments.add_argument("program", type=pathlib.Path)
    arguments.add_argument("folder", type=pathlib.Path)
    given = arguments.parse_args()
    for binary in (given.library, given.program):
        if not binary.is_file():
            arguments.error(f"{binary}: is not there; build it first")
    print(make(given.library, given.program, given.folder))
