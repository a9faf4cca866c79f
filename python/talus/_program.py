"""The program `talus`, for what the library does not do: found, driven, stopped by Ctrl-C."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import sysconfig
import tempfile
from functools import lru_cache
from pathlib import Path
from typing import Any, Callable, Iterator, Sequence

from ._library import FaultError, InputError, TalusError, version

_patience = 60.0  # s, that a program which was told to stop has for the step that it is in and for its files


def _candidates() -> Iterator[str]:
    # Installed together: PREFIX/lib/python3/dist-packages/talus and PREFIX/bin/talus; or a wheel, in an environment.
    for folder in Path(__file__).resolve().parents:
        if folder.name in ("lib", "lib64"):
            yield str(folder.parent / "bin" / "talus")
    yield os.path.join(sysconfig.get_path("scripts"), "talus")
    yield shutil.which("talus") or ""


@lru_cache(maxsize=None)
def _version(program: str) -> str:
    said = subprocess.run([program, "--version"], capture_output=True, text=True, check=False).stdout.split()
    return said[1] if said[:1] == ["talus"] and len(said) > 1 else "not talus"


def find() -> str:
    """The program of the library's version."""
    others = []
    for candidate in _candidates():
        if os.path.isfile(candidate) and os.access(candidate, os.X_OK):
            if _version(candidate) == version:
                return candidate
            others.append(f"{candidate} is {_version(candidate)}")
    said = "; ".join(dict.fromkeys(others)) or "it is neither beside the library nor in PATH"
    raise TalusError(f"the program talus {version} is not found: {said}; install both from one version of talus")


def call(arguments: Sequence[str], tell: Callable[[dict[str, Any]], object]) -> dict[str, Any]:
    """Runs `talus ARGUMENTS --json`. `tell` is told what it says of its progress. Returns its result. Ctrl-C, and whatever
    `tell` raises, ends it as Ctrl-C in a terminal does: runs that are complete are kept."""
    result: dict[str, Any] | None = None
    with tempfile.TemporaryFile() as said:
        # A session of its own: Ctrl-C in a terminal reaches this process alone, which then tells the program.
        process = subprocess.Popen(
            [find(), *arguments, "--json"], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=said,
            encoding="utf-8", errors="replace", start_new_session=True,
        )  # fmt: skip
        try:
            assert process.stdout is not None
            for line in process.stdout:
                event = json.loads(line)
                if event["event"] == "result":
                    result = event
                else:
                    tell(event)
            code = process.wait()
        except BaseException:
            _stop(process)
            raise
        finally:
            if process.stdout is not None:
                process.stdout.close()
        said.seek(0)
        words = said.read().decode(errors="replace").splitlines()
    if code == 0 and result is not None:
        for line in words:
            print(line, file=sys.stderr)
        return result
    errors = [line for line in words if line.startswith("talus: error: ")] or words or [f"talus ended with code {code}"]
    raise {2: InputError, 3: FaultError}.get(code, TalusError)(errors[-1].replace("talus: error: ", "", 1))


def _stop(process: subprocess.Popen[str]) -> None:
    """As Ctrl-C; at once where that is pressed again."""
    try:
        process.send_signal(signal.SIGINT)
        process.wait(_patience)
    except BaseException:
        process.kill()
        process.wait()
        raise
