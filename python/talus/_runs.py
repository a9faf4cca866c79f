"""Commands that make many runs: their words, their progress, and the folder of their results."""

from __future__ import annotations

import json
import os
import sys
import tempfile
import warnings
from pathlib import Path
from typing import Any, Callable, Mapping, Type, TypeVar, Union

import numpy as np

from . import _arguments as arguments
from . import _program
from ._library import InputError
from .maps import Map, read_geotiff
from .simulation import Progress, Settings
from .table import Table

Scene = Union[str, "os.PathLike[str]", None]
#: By key of the scene: (low, high), a list of entries, or a distribution as the program takes it, "normal:0.3:0.05".
Vary = Mapping[str, object]


class Folder:
    """Results in a folder, read when they are asked for. A temporary folder goes with the object."""

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = Path(os.fsdecode(arguments.path("folder", folder)))
        self._kept: tempfile.TemporaryDirectory[str] | None = None
        self._facts: dict[str, Any] = {}  # what the program says of all runs

    def _json(self, name: str) -> dict[str, Any]:
        try:
            found = json.loads((self.folder / name).read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            problem = getattr(error, "strerror", None) or error
            raise InputError(f"{self.folder / name}: cannot be read: {problem}") from None
        if not isinstance(found, dict):
            raise InputError(f"{self.folder / name}: must be an object")
        return found

    def _table(self, name: str) -> Table:
        return Table.read(self.folder / name)

    @property
    def runs(self) -> Table:
        """A row per run: its values, results, verdict, hash, fault."""
        return self._table("runs.csv")

    @property
    def results(self) -> dict[str, Any]:
        """What the report shows, as results.json of docs/results.md."""
        return self._json("results.json")

    @property
    def verdict(self) -> dict[str, Any]:
        """The worst of all runs by check, as `verdict` of docs/results.md."""
        found: dict[str, Any] = self._facts["verdict"]
        return found


class FolderOfMaps(Folder):
    """Results with maps."""

    @property
    def map_names(self) -> list[str]:
        """Of the maps: "peak_depth_p95", "individual_risk", ..."""
        return sorted(path.stem for path in self.folder.glob("*.tif"))

    def map(self, name: str) -> Map:
        """The map of that name."""
        if arguments.text("name", name).decode() not in self.map_names:
            raise InputError(f"name = {name!r}: must be one of {', '.join(self.map_names)}")
        return read_geotiff(self.folder / f"{name}.tif")


Made = TypeVar("Made", bound=Folder)


def command_words(scene: Scene, vary: Vary | None, settings: Settings | None, threads: int | None, *, needed: bool) -> list[str]:
    words = [] if scene is None else [os.path.abspath(os.fsdecode(arguments.path("scene", scene)))]
    if not isinstance(vary, Mapping) and (needed or vary is not None) or needed and not vary:
        raise InputError(f"vary = {arguments.short(vary)}: must be keys of the scene with the values that they take")
    for key, values in (vary or {}).items():
        words += ["--vary", f"{arguments.text('vary', key).decode()}={_distribution(key, values)}"]
    for text in arguments.settings(settings):
        words += ["--set", text.decode()]
    if threads is not None:
        words += ["--threads", str(arguments.count("threads", threads))]
    return words


def _distribution(key: str, values: object) -> str:
    name = f"vary[{key!r}]"
    if isinstance(values, str):
        return values
    if isinstance(values, tuple) and len(values) == 2:
        return ":".join(numbers(name, values))
    if isinstance(values, (list, np.ndarray)) and len(values):
        return ",".join(arguments.setting(name, entry) for entry in values)
    raise InputError(
        f"{name} = {arguments.short(values)}: must be (low, high), a list of entries, or a text such as 'normal:0.3:0.05'"
    )


def numbers(name: str, values: object) -> list[str]:
    if isinstance(values, str) or not hasattr(values, "__iter__"):
        values = [values]
    return [repr(arguments.number(name, value)) for value in values]


def run(
    words: list[str],
    folder: str | os.PathLike[str] | None,
    progress: Progress | bool | None,
    share: Callable[[Mapping[str, Any]], float],
    made: Type[Made],
) -> Made:
    kept = tempfile.TemporaryDirectory(prefix="talus_") if folder is None else None
    place = kept.name if kept else os.path.abspath(os.fsdecode(arguments.path("folder", folder)))
    tell = progress if callable(progress) else _bar if (sys.stderr.isatty() if progress is None else progress) else None
    try:
        _program.call([*words, "--output", place], lambda event: tell and tell(min(1.0, share(event))))
        if tell:
            tell(1.0)
        result = made(place)
    except BaseException:
        if kept:
            kept.cleanup()
        raise
    result._kept = kept
    return result


def _bar(share: float) -> None:
    end = "\n" if share == 1 else ""
    print(f"\r[{'#' * int(40 * share):40}] {100 * share:.0f} %{end}", end="", file=sys.stderr, flush=True)


def with_warnings(made: Made, frames: int = 3) -> Made:
    """Warns of what the runs of `made` break; `frames`: from here to who asked for them."""
    for warning in made.verdict["warnings"]:
        warnings.warn(warning, stacklevel=frames)
    return made


def share_done(event: Mapping[str, Any]) -> float:
    return float(event.get("share_done", 0))
