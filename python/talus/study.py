"""Whole runs, and many of them."""

from __future__ import annotations

import itertools
import os
import sys
import time
import warnings
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from typing import Any, Mapping, Sequence, Union

from .simulation import UNITS, Front, Map, Phase, Settings, Simulation, Structure

Scene = Union[str, "os.PathLike[str]", None]


@dataclass(frozen=True)
class Result:
    """The result of a run."""

    settings: dict[str, object]  #: beside those of the scene
    phase: Phase
    message: str  #: why it ended
    time: float  #: s, simulated
    hash: str
    crs: str  #: of the terrain, "EPSG:2326" or WKT
    front: Front = field(repr=False)
    verdict: dict[str, Any] = field(repr=False)  #: as Simulation.verdict
    structures: list[Structure] = field(repr=False)
    maps: dict[str, Map] = field(repr=False)  #: by name, see UNITS

    def to_xarray(self) -> Any:
        """An xarray.Dataset of all maps that have a value anywhere. Needs xarray."""
        import numpy as np
        import xarray

        filled = {name: found for name, found in self.maps.items() if np.isfinite(found.values).any()}
        return xarray.Dataset({name: found.to_xarray() for name, found in filled.items()}, attrs={"crs": self.crs})

    def to_geopandas(self, threshold: float = 0.1) -> Any:
        """The cells where debris was deeper than `threshold`, m, as a geopandas.GeoDataFrame of squares with their
        values, in the terrain's reference system. Needs geopandas."""
        import geopandas
        import numpy as np
        from shapely.geometry import box

        depth = self.maps["peak_depth"]
        rows, columns = np.nonzero(depth.values > threshold)
        half = depth.cell / 2
        squares = [box(x - half, y - half, x + half, y + half) for x, y in zip(depth.x[columns], depth.y[rows])]
        alike = {n: m for n, m in self.maps.items() if m.values.shape == depth.values.shape}
        values = {n: m.values[rows, columns] for n, m in alike.items()}
        return geopandas.GeoDataFrame(values, geometry=squares, crs=self.crs)

    def plot(self, ax: Any = None) -> Any:
        """Peak depth on matplotlib axes. Needs matplotlib."""
        return self.maps["peak_depth"].plot(ax)


class _Clock:
    """How far a run is, by the wall time left until it is expected to be over."""

    def __init__(self) -> None:
        self._start = time.monotonic()
        self._share = 0.0

    def line(self, simulation: Simulation, end: float) -> str:
        state = simulation.json("state")
        gone, simulated = time.monotonic() - self._start, simulation.time
        expected, remaining = state["expected_end_s"], state["wall_remaining_s"]
        if simulated >= end:
            left = 0.0
        elif remaining is None and (expected is not None or simulated < 0.01 * end):  # too little is done to say
            return f"[{'':40}] {simulated:.1f} s"
        elif remaining is None:  # debris outlasts the estimate: at the mean pace until the end
            left = gone * (end - simulated) / max(simulated, 1e-9)
        else:
            left = remaining * min(1.0, (end - simulated) / max(expected - simulated, 1e-9))
        self._share = max(self._share, gone / max(gone + left, 1e-9))
        done = "#" * int(40 * self._share)
        return f"[{done:40}] {simulated:.1f} s, about {int(left) // 60}:{int(left) % 60:02} left"


def run(
    scene: Scene = None, settings: Settings | None = None, *, end_time: float | None = None, progress: bool | None = None
) -> Result:
    """Runs a scene until it is over, or until `end_time`, s. `progress`: a bar on stderr with the wall time left, as
    `talus run` estimates it; None: where that is a terminal."""
    bar = sys.stderr.isatty() if progress is None else progress
    with Simulation(scene, settings) as simulation:
        loaded = simulation.json("scene")
        end = loaded["end_time_s"]
        if end_time is not None:
            end = min(end, end_time)
        parts = 100
        clock = _Clock()
        for part in range(1, parts + 1):
            phase = simulation.advance(end * part / parts)
            if bar:
                print("\r" + clock.line(simulation, end), end="\x1b[K", file=sys.stderr, flush=True)
            if phase != Phase.READY:
                break
        if bar:
            print(file=sys.stderr)
        maps = {name: simulation.map(name) for name in UNITS}
        verdict = simulation.verdict
        for warning in verdict["warnings"]:
            warnings.warn(warning, stacklevel=2)
        return Result(
            dict(settings or {}), simulation.phase, simulation.message, simulation.time, simulation.hash, loaded["crs"],
            simulation.front, verdict, simulation.structures, maps,
        )  # fmt: skip


def _run_one(job: tuple[Any, dict[str, object], float | None]) -> Result:
    scene, settings, end_time = job
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # study() says it once
        return run(scene, settings, end_time=end_time, progress=False)


def study(
    scene: Scene,
    values: Mapping[str, Sequence[object]],
    settings: Settings | None = None,
    *,
    end_time: float | None = None,
    processes: int | None = None,
) -> list[Result]:
    """Runs a scene once for every combination of `values` (a list by key), in `processes` at once (None: one per core),
    each on one thread. Results are in the order of itertools.product; Result.settings says what each run had. Warns once
    if runs are beyond a limit (Result.verdict)."""
    base = {"solver.thread_count": 1, **(settings or {})}
    jobs = [(scene, {**base, **dict(zip(values, chosen))}, end_time) for chosen in itertools.product(*values.values())]
    with ProcessPoolExecutor(processes) as pool:
        results = list(pool.map(_run_one, jobs))
    beyond = [warning for result in results for warning in result.verdict["warnings"][:1]]
    if beyond:
        warnings.warn(f"{len(beyond)} of {len(results)} runs are beyond a limit; the first: {beyond[0]}", stacklevel=2)
    return results
