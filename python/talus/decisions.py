"""What is at risk, what is left of it with an option, and how high a barrier must be: `talus risk`, `talus options` and
`talus design`."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, Mapping, Sequence

import numpy as np

from . import _arguments as arguments
from ._library import InputError
from ._runs import Folder, FolderOfMaps, Scene, Vary, command_words, numbers, run, share_done, with_warnings
from .simulation import Progress, Settings
from .table import Table


class _Decision(Folder):
    numbers: dict[str, Any]

    @property
    def assumptions(self) -> list[str]:
        """On which the numbers rest."""
        return [str(text) for text in self.numbers["assumptions"]]

    @property
    def limits(self) -> list[str]:
        """What the numbers leave out."""
        return [str(text) for text in self.numbers["limits"]]


class Risk(_Decision, FolderOfMaps):
    """What is at risk, from risk() or options(), or from the folder that `talus risk` or `talus options` wrote."""

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        super().__init__(folder)
        self.numbers = self._facts = self._json("results.json")  #: all numbers, as docs/risk.md has them
        if self.numbers.get("format") not in ("talus risk", "talus options"):
            raise InputError(f"{self.folder}: is not the folder of a risk or of options")

    @property
    def total(self) -> dict[str, Any]:
        """Of all that is exposed, as it is: impacts, loss, deaths, individual_risk; each with value, low and high."""
        found: dict[str, Any] = self.numbers["options"][0]["total"]
        return found

    @property
    def items(self) -> Table:
        """A row per option and building or road."""
        return self._table("risk.csv")

    @property
    def fn(self) -> Table:
        """The F-N curve of each option: events in a year with so many deaths or more."""
        return self._table("fn.csv")

    @property
    def options(self) -> Table:
        """Cost and difference from the ground as it is, a row per option: of options()."""
        return self._table("options.csv")

    def __repr__(self) -> str:
        per, deaths = self.numbers["per"], self.total["deaths"]
        hit = f"{self.total['impacts']['value']:.3g} impacts per {per}"
        lost = "" if deaths is None else f", {deaths['value']:.3g} deaths per {per}"
        return f"<talus.Risk: {hit}{lost}, in {self.folder}; {self.verdict['text']}>"


class Design(_Decision):
    """How high a barrier must be and what it must bear, from design() or from the folder that `talus design` wrote."""

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        super().__init__(folder)
        self.numbers = self._facts = self._json("results.json")  #: all numbers, as docs/design.md has them
        if self.numbers.get("format") != "talus design":
            raise InputError(f"{self.folder}: is not the folder of a design")

    @property
    def least_height(self) -> float | None:
        """On the barrier's own line, m. None: no height that was tried is enough."""
        height = self.lines[0]["least_height_m"]
        return None if height is None else float(height)

    @property
    def lines(self) -> list[dict[str, Any]]:
        """Of the barrier's own line and each of the others: least height, undisturbed flow, runs with the barrier, capacity,
        methods of loads."""
        return list(self.numbers["lines"])

    @property
    def heights(self) -> Table:
        """A row per line and height: shares of the runs and of the volume that pass."""
        return self._table("heights.csv")

    @property
    def loads(self) -> Table:
        """A row per line and published method."""
        return self._table("loads.csv")

    @property
    def sheet(self) -> Path:
        """The page to print."""
        return self.folder / "design.html"

    def __repr__(self) -> str:
        high = "no height is enough" if self.least_height is None else f"{self.least_height:g} m"
        return f"<talus.Design: {self.numbers['barrier']}, {high}, in {self.folder}; {self.verdict['text']}>"


def risk(
    scene: Scene = None,
    vary: Vary | None = None,
    settings: Settings | None = None,
    *,
    runs: int = 64,
    design: str = "latin_hypercube",
    seed: int = 1,
    folder: str | os.PathLike[str] | None = None,
    threads: int | None = None,
    progress: Progress | bool | None = None,
) -> Risk:
    """Counts what is at risk in a scene, as `talus risk` does (docs/risk.md): an ensemble for each [[risk_scenario]], and what
    it does to each [[exposure]]. `runs`: of each class of events. The rest as of ensemble(). Needs the program."""
    return _risk("risk", scene, vary, settings, runs, design, seed, (), folder, threads, progress)


def options(
    scene: Scene = None,
    vary: Vary | None = None,
    settings: Settings | None = None,
    *,
    only: Sequence[str] = (),
    runs: int = 64,
    design: str = "latin_hypercube",
    seed: int = 1,
    folder: str | os.PathLike[str] | None = None,
    threads: int | None = None,
    progress: Progress | bool | None = None,
) -> Risk:
    """Compares the options of a scene with the ground as it is, as `talus options` does (docs/risk.md). `only`: names of
    options; none: all. The rest as of risk(). Needs the program."""
    return _risk("options", scene, vary, settings, runs, design, seed, only, folder, threads, progress)


def design(
    scene: Scene = None,
    barrier: str = "",
    vary: Vary | None = None,
    settings: Settings | None = None,
    *,
    share: float = 0.05,
    of: str = "runs",
    heights_m: tuple[float, float] = (1, 10),
    height_step_m: float = 0.5,
    lines: Mapping[str, object] | None = None,
    confirm: str = "none",
    boulder_diameter_m: float | None = None,
    deposition_slope_deg: float | None = None,
    runs: int = 32,
    design: str = "latin_hypercube",
    seed: int = 1,
    folder: str | os.PathLike[str] | None = None,
    threads: int | None = None,
    progress: Progress | bool | None = None,
) -> Design:
    """Finds the least height of a barrier of the scene for which at most `share` of the runs, or of their volume (`of`:
    "runs", "volume"), passes, as `talus design` does (docs/design.md). `heights_m`: the least and the greatest that is tried.
    `lines`: other lines for the same barrier, by name: a list of (x, y), or a file with a line. `confirm`: "particles" repeats
    the deciding runs with them. `runs`: of each height. The rest as of ensemble(). Needs the program."""
    words = ["design", *command_words(scene, vary, settings, threads, needed=True)]
    words += ["--barrier", arguments.text("barrier", barrier).decode()]
    words += ["--share", repr(arguments.number("share", share)), "--of", arguments.text("of", of).decode()]
    if not isinstance(heights_m, (tuple, list)) or len(heights_m) != 2:
        raise InputError(f"heights_m = {arguments.short(heights_m)}: must be (least, greatest)")
    for option, height in zip(("--min-height", "--max-height"), heights_m):
        words += [option, repr(arguments.number("heights_m", height))]
    words += ["--height-step", repr(arguments.number("height_step_m", height_step_m))]
    for name, line in (lines or {}).items():
        words += ["--line", f"{arguments.text('lines', name).decode()}={_places(name, line)}"]
    words += ["--confirm", arguments.text("confirm", confirm).decode()]
    for option, name, value in (
        ("--boulder-diameter", "boulder_diameter_m", boulder_diameter_m),
        ("--deposition-slope", "deposition_slope_deg", deposition_slope_deg),
    ):
        if value is not None:
            words += [option, repr(arguments.number(name, value))]
    words += ["--runs", str(arguments.count("runs", runs)), "--seed", str(arguments.count("seed", seed))]
    words += ["--design", arguments.text("design", design).decode()]
    return with_warnings(run(words, folder, progress, share_done, Design))


def _places(name: str, line: object) -> str:
    """As the option --line takes them."""
    if isinstance(line, (str, os.PathLike)):
        return os.path.abspath(os.fsdecode(arguments.path(f"lines[{name!r}]", line)))
    places = np.asarray(line, dtype=object)
    if places.ndim != 2 or places.shape[1] != 2:
        raise InputError(f"lines[{name!r}] = {arguments.short(line)}: must be a list of (x, y), or a file with a line")
    return " ".join(",".join(numbers(f"lines[{name!r}]", place)) for place in places)


def _risk(
    command: str,
    scene: Scene,
    vary: Vary | None,
    settings: Settings | None,
    runs: int,
    design: str,
    seed: int,
    only: Sequence[str],
    folder: str | os.PathLike[str] | None,
    threads: int | None,
    progress: Progress | bool | None,
) -> Risk:
    words = [command, *command_words(scene, vary, settings, threads, needed=True)]
    words += ["--runs", str(arguments.count("runs", runs)), "--seed", str(arguments.count("seed", seed))]
    words += ["--design", arguments.text("design", design).decode()]
    for name in [only] if isinstance(only, str) else only:
        words += ["--option", arguments.text("only", name).decode()]
    return with_warnings(run(words, folder, progress, share_done, Risk), frames=4)
