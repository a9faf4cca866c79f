"""Many runs with values that vary, and the values that explain field observations: `talus ensemble` and `talus calibrate`."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, Mapping, Sequence

from . import _arguments as arguments
from ._library import InputError
from ._runs import Folder, FolderOfMaps, Scene, Vary, command_words, numbers, run, share_done, with_warnings
from .simulation import Progress, Settings
from .table import Table


class Ensemble(FolderOfMaps):
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

    def __repr__(self) -> str:
        done, of = self.statistics["complete"], self.statistics["runs"]
        return f"<talus.Ensemble: {done} of {of} runs complete, in {self.folder}; {self.verdict['text']}>"


class Calibration(Folder):
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
    words = ["ensemble", *command_words(scene, vary, settings, threads, needed=plan is None)]
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
            words += ["--" + name.replace("_", "-"), ",".join(numbers(name, values))]
    if return_period is not None:
        words += ["--return-period", repr(arguments.number("return_period", return_period, above=0))]
    if plan is not None:
        words += ["--plan", os.fsdecode(arguments.path("plan", plan))]
    return with_warnings(run(words, folder, progress, share_done, Ensemble))


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
    words = ["calibrate", *command_words(scene, vary, settings, threads, needed=True)]
    for name, count in (("runs", runs), ("fast_runs", fast_runs), ("design", design), ("checks", checks), ("seed", seed)):
        if count is not None:
            words += ["--" + name.replace("_", "-"), str(arguments.count(name, count))]
    if search_with is not None:
        words += ["--search-with", arguments.text("search_with", search_with).decode()]
    return with_warnings(run(words, folder, progress, _share_of_search, Calibration))


def _share_of_search(event: Mapping[str, Any]) -> float:
    return float(event["runs_done"]) / max(float(event["runs_at_most"]), 1.0) if "runs_done" in event else 0.0
