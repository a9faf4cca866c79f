"""Many runs with values that vary, the values that explain field observations, what is at risk, and how high a barrier must
be: `talus ensemble`, `talus calibrate`, `talus risk`, `talus options` and `talus design`."""

from __future__ import annotations

import json
import os
import sys
import tempfile
import warnings
from pathlib import Path
from typing import Any, Callable, Mapping, Sequence, Type, TypeVar, Union

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


class _Folder:
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


_Made = TypeVar("_Made", "Ensemble", "Calibration", "Risk", "Design")


class Ensemble(_Folder):
    """The results of an ensemble, from ensemble() or from the folder that `talus ensemble` wrote."""

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        super().__init__(folder)
        self.statistics = self._facts = self._json("statistics.json")  #: percentiles and sensitivity of every result
        if "thresholds" not in self.statistics:
            raise InputError(f"{self.folder}: is not the folder of an ensemble")

    @property
    def distributions(self) -> Table:
        """Mean, deviation and percentiles of every result."""
        return self._table("distributions.csv")

    @property
    def sensitivity(self) -> Table:
        """Of every result to every factor, by the measure that the design gives."""
        return self._table("sensitivity.csv")

    @property
    def buildings(self) -> Table:
        """Probability of a hit, and of pressures, per building."""
        return self._table("buildings.csv")

    @property
    def map_names(self) -> list[str]:
        """Of the maps: "probability_depth_0.5m", "peak_depth_p95", ..."""
        return sorted(path.stem for path in self.folder.glob("*.tif"))

    def map(self, name: str) -> Map:
        """The map of that name."""
        if arguments.text("name", name).decode() not in self.map_names:
            raise InputError(f"name = {name!r}: must be one of {', '.join(self.map_names)}")
        return read_geotiff(self.folder / f"{name}.tif")

    def __repr__(self) -> str:
        done, of = self.statistics["complete"], self.statistics["runs"]
        return f"<talus.Ensemble: {done} of {of} runs complete, in {self.folder}; {self.verdict['text']}>"


class Calibration(_Folder):
    """The results of a calibration, from calibrate() or from the folder that `talus calibrate` wrote."""

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        super().__init__(folder)
        self.numbers = self._facts = self._json("calibration.json")  #: all numbers, as the program has them

    @property
    def best(self) -> dict[str, float]:
        """The values of the run of least misfit, by key: settings for run()."""
        return {factor["key"]: float(factor["best"]) for factor in self.numbers["factors"]}

    @property
    def best_scene(self) -> Path:
        """A scene that repeats that run."""
        return self.folder / "best_fit" / "scene.toml"

    @property
    def misfit(self) -> float:
        """Of that run: squared deviations from the observations, in standard deviations."""
        return float(self.numbers["best_misfit"])

    @property
    def warnings(self) -> list[str]:
        """What the intervals are to be read with."""
        return [str(text) for text in self.numbers["warnings"]]

    @property
    def factors(self) -> Table:
        """Best fit, median, 95 % intervals of posterior and prior, and correlations, of every factor."""
        return self._table("factors.csv")

    @property
    def observations(self) -> Table:
        """Observed, of the best fit, and as the posterior predicts it."""
        return self._table("observations.csv")

    @property
    def posterior(self) -> Table:
        """Draws from the posterior, a column per factor."""
        return self._table("posterior.csv")

    @property
    def misfit_map(self) -> Table:
        """Misfit over the first two factors."""
        return self._table("misfit_map.csv")

    def __repr__(self) -> str:
        best = ", ".join(f"{key} = {value:.4g}" for key, value in self.best.items())
        return f"<talus.Calibration: {self.numbers['complete']} runs, least misfit {self.misfit:.4g} at {best}, in {self.folder}>"


class Risk(_Folder):
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

    @property
    def assumptions(self) -> list[str]:
        """On which the numbers rest."""
        return [str(text) for text in self.numbers["assumptions"]]

    @property
    def limits(self) -> list[str]:
        """What the numbers leave out."""
        return [str(text) for text in self.numbers["limits"]]

    @property
    def map_names(self) -> list[str]:
        """Of the maps: "individual_risk", "debris_frequency", ..."""
        return sorted(path.stem for path in self.folder.glob("*.tif"))

    def map(self, name: str) -> Map:
        """The map of that name."""
        if arguments.text("name", name).decode() not in self.map_names:
            raise InputError(f"name = {name!r}: must be one of {', '.join(self.map_names)}")
        return read_geotiff(self.folder / f"{name}.tif")

    def __repr__(self) -> str:
        per, deaths = self.numbers["per"], self.total["deaths"]
        hit = f"{self.total['impacts']['value']:.3g} impacts per {per}"
        lost = "" if deaths is None else f", {deaths['value']:.3g} deaths per {per}"
        return f"<talus.Risk: {hit}{lost}, in {self.folder}; {self.verdict['text']}>"


class Design(_Folder):
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

    @property
    def assumptions(self) -> list[str]:
        """On which the numbers rest."""
        return [str(text) for text in self.numbers["assumptions"]]

    @property
    def limits(self) -> list[str]:
        """What the numbers leave out."""
        return [str(text) for text in self.numbers["limits"]]

    def __repr__(self) -> str:
        high = "no height is enough" if self.least_height is None else f"{self.least_height:g} m"
        return f"<talus.Design: {self.numbers['barrier']}, {high}, in {self.folder}; {self.verdict['text']}>"


def ensemble(
    scene: Scene = None,
    vary: Vary | None = None,
    settings: Settings | None = None,
    *,
    runs: int = 64,
    design: str = "latin_hypercube",
    levels: int | None = None,
    seed: int = 1,
    fast_runs: int = 0,
    depth_m: Sequence[float] | None = None,
    speed_mps: Sequence[float] | None = None,
    pressure_kPa: Sequence[float] | None = None,
    return_period: float | None = None,
    plan: str | os.PathLike[str] | None = None,
    folder: str | os.PathLike[str] | None = None,
    threads: int | None = None,
    progress: Progress | bool | None = None,
) -> Ensemble:
    """Runs a scene many times with values that vary, as `talus ensemble` does (docs/ensembles.md). `vary`: by key (low, high)
    for a uniform range, a list of equally likely entries, or a text such as "normal:0.3:0.05". `depth_m`, `speed_mps`,
    `pressure_kPa`: thresholds of the probability maps. `plan`: a plan file, which the rest overrides. `folder`: where the
    results are kept; the same call on it resumes what was interrupted. None: a temporary one, which lasts as long as what is
    returned. `threads`: runs at once; None: one per core. `progress`: a function that is told the share done, or whether a bar
    is drawn on stderr; None: where that is a terminal. Needs the program."""
    words = ["ensemble", *_common(scene, vary, settings, threads, needed=plan is None)]
    given = plan is not None  # then only what differs from the defaults overrides it
    for option, count, default in (("--runs", runs, 64), ("--seed", seed, 1), ("--fast-runs", fast_runs, 0)):
        if not given or count != default:
            words += [option, str(arguments.count(option[2:].replace("-", "_"), count))]
    if not given or design != "latin_hypercube":
        words += ["--design", arguments.text("design", design).decode()]
    if levels is not None:
        words += ["--levels", str(arguments.count("levels", levels))]
    for name, values in (("depth_m", depth_m), ("speed_mps", speed_mps), ("pressure_kPa", pressure_kPa)):
        if values is not None:
            words += ["--" + name.replace("_", "-"), ",".join(_numbers(name, values))]
    if return_period is not None:
        words += ["--return-period", repr(arguments.number("return_period", return_period, above=0))]
    if plan is not None:
        words += ["--plan", os.fsdecode(arguments.path("plan", plan))]
    return _said(_run(words, folder, progress, lambda event: float(event.get("share_done", 0)), Ensemble))


def calibrate(
    scene: Scene = None,
    vary: Vary | None = None,
    settings: Settings | None = None,
    *,
    runs: int | None = None,
    search_with: str | None = None,
    fast_runs: int | None = None,
    design: int | None = None,
    checks: int | None = None,
    seed: int = 1,
    folder: str | os.PathLike[str] | None = None,
    threads: int | None = None,
    progress: Progress | bool | None = None,
) -> Calibration:
    """Finds the values that explain the field observations of a scene, as `talus calibrate` does (docs/calibration.md).
    `vary`: by key (low, high), or a prior such as "normal:600:60". `search_with`: "depth_averaged". `design`: runs of the
    design. `checks`: runs that check the result. The rest as of ensemble(). Needs the program."""
    words = ["calibrate", *_common(scene, vary, settings, threads, needed=True)]
    for name, count in (("runs", runs), ("fast_runs", fast_runs), ("design", design), ("checks", checks), ("seed", seed)):
        if count is not None:
            words += ["--" + name.replace("_", "-"), str(arguments.count(name, count))]
    if search_with is not None:
        words += ["--search-with", arguments.text("search_with", search_with).decode()]
    return _said(_run(words, folder, progress, _share_of_search, Calibration))


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
    words = ["design", *_common(scene, vary, settings, threads, needed=True)]
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
    return _said(_run(words, folder, progress, lambda event: float(event.get("share_done", 0)), Design))


def _places(name: str, line: object) -> str:
    """As the option --line takes them."""
    if isinstance(line, (str, os.PathLike)):
        return os.path.abspath(os.fsdecode(arguments.path(f"lines[{name!r}]", line)))
    places = np.asarray(line, dtype=object)
    if places.ndim != 2 or places.shape[1] != 2:
        raise InputError(f"lines[{name!r}] = {arguments.short(line)}: must be a list of (x, y), or a file with a line")
    return " ".join(",".join(_numbers(f"lines[{name!r}]", place)) for place in places)


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
    words = [command, *_common(scene, vary, settings, threads, needed=True)]
    words += ["--runs", str(arguments.count("runs", runs)), "--seed", str(arguments.count("seed", seed))]
    words += ["--design", arguments.text("design", design).decode()]
    for name in [only] if isinstance(only, str) else only:
        words += ["--option", arguments.text("only", name).decode()]
    return _said(_run(words, folder, progress, lambda event: float(event.get("share_done", 0)), Risk))


def _share_of_search(event: Mapping[str, Any]) -> float:
    return float(event["runs_done"]) / max(float(event["runs_at_most"]), 1.0) if "runs_done" in event else 0.0


def _common(scene: Scene, vary: Vary | None, settings: Settings | None, threads: int | None, *, needed: bool) -> list[str]:
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
        return ":".join(_numbers(name, values))
    if isinstance(values, (list, np.ndarray)) and len(values):
        return ",".join(arguments.setting(name, entry) for entry in values)
    raise InputError(
        f"{name} = {arguments.short(values)}: must be (low, high), a list of entries, or a text such as 'normal:0.3:0.05'"
    )


def _numbers(name: str, values: object) -> list[str]:
    if isinstance(values, str) or not hasattr(values, "__iter__"):
        values = [values]
    return [repr(arguments.number(name, value)) for value in values]


def _run(
    words: list[str],
    folder: str | os.PathLike[str] | None,
    progress: Progress | bool | None,
    share: Callable[[Mapping[str, Any]], float],
    made: Type[_Made],
) -> _Made:
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


def _said(made: _Made) -> _Made:
    for warning in made.verdict["warnings"]:
        warnings.warn(warning, stacklevel=4 if isinstance(made, Risk) else 3)
    return made
