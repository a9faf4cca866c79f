"""Whole runs, and many of them."""

from __future__ import annotations

import itertools
import os
import sys
import time
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np

from . import _arguments as arguments
from ._library import InputError
from ._workers import work_in_processes
from .maps import UNITS, Extent, Map, union
from .measures import Energy, Front, Gauge, RunOut, Structure
from .simulation import Phase, Settings, Simulation
from .table import Table

if TYPE_CHECKING:
    import numpy.typing as npt

Scene = Union[str, "os.PathLike[str]", None]


@dataclass(frozen=True, repr=False)
class Result:
    """The result of a run."""

    settings: dict[str, object]  #: beside those of the scene
    phase: Phase
    message: str  #: why it ended
    time: float  #: s, simulated
    hash: str
    crs: str  #: of the terrain, "EPSG:2326" or WKT
    front: Front
    verdict: dict[str, Any]  #: as Simulation.verdict
    structures: list[Structure]  #: with what went over barriers and what they retain
    maps: dict[str, Map]  #: by name, see UNITS
    run_out: RunOut
    energy: Energy
    series: dict[str, npt.NDArray[np.float64]]  #: the run over time, as Simulation.series
    gauges: list[Gauge]
    results: dict[str, Any]  #: all that the report shows, as results.json of docs/results.md

    def __repr__(self) -> str:
        given = ", ".join(f"{key} = {value!s}" for key, value in self.settings.items())
        return (
            f"<talus.Result{': ' if given else ''}{given}; t = {self.time:.4g} s, run-out {self.run_out.along_flow:.4g} m, "
            f"{sum(s.hit for s in self.structures)} of {len(self.structures)} structures hit; {self.verdict['text']}>"
        )

    def to_xarray(self) -> Any:
        """An xarray.Dataset of all maps that have a value anywhere, on the cells that they all cover, with the reference
        system as rioxarray has it. Needs xarray."""
        import xarray

        filled = [found for found in self.maps.values() if np.isfinite(found.values).any()]
        if not filled:
            return xarray.Dataset(attrs={"crs": self.crs})
        peak = self.maps["peak_depth"]
        cell = peak.cell
        extent = union([found for found in filled if found.cell == cell] or [peak])
        placed = {found.name: found.on_grid(extent, cell).to_xarray() for found in filled}
        return xarray.Dataset(placed, attrs={"crs": self.crs})

    def to_geopandas(self, threshold: float = 0.1) -> Any:
        """The cells where debris was deeper than `threshold`, m, as a geopandas.GeoDataFrame of squares with their
        values, in the terrain's reference system. Needs geopandas."""
        import geopandas
        from shapely.geometry import box

        depth = self.maps["peak_depth"]
        rows, columns = np.nonzero(depth.values > arguments.number("threshold", threshold))
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
            return f"{self._bar()} {simulated:.1f} s"
        elif remaining is None:  # debris outlasts the estimate: at the mean pace until the end
            left = gone * (end - simulated) / max(simulated, 1e-9)
        else:
            left = remaining * min(1.0, (end - simulated) / max(expected - simulated, 1e-9))
        self._share = max(self._share, gone / max(gone + left, 1e-9))
        return f"{self._bar()} {simulated:.1f} s, about {int(left) // 60}:{int(left) % 60:02} left"

    def _bar(self) -> str:
        return f"[{'#' * int(40 * self._share):40}]"


def run(
    scene: Scene = None,
    settings: Settings | None = None,
    *,
    end_time: float | None = None,
    extent: Extent | None = None,
    cell_m: float | None = None,
    progress: bool | None = None,
) -> Result:
    """Runs a scene until it is over, or until `end_time`, s. `cell_m`: maps are measured on cells of this size, m, and cover
    `extent` (west, south, east, north edge in m; None: the whole terrain), so that those of several runs can be stacked;
    None: they end where they have no values. `progress`: a bar on stderr with the wall time left, as `talus run` estimates
    it; None: where that is a terminal."""
    bar = sys.stderr.isatty() if progress is None else progress
    if end_time is not None:
        end_time = arguments.time("end_time", end_time)
    with Simulation(scene, _with_cell(settings, extent, cell_m)) as simulation:
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
        maps = {name: simulation.map(name, extent, cell_m) for name in UNITS}
        verdict = simulation.verdict
        for warning in verdict["warnings"]:
            warnings.warn(warning, stacklevel=2)
        return Result(
            dict(settings or {}), simulation.phase, simulation.message, simulation.time, simulation.hash, simulation.crs,
            simulation.front, verdict, simulation.structures, maps, simulation.run_out, simulation.energy, simulation.series,
            simulation.gauges, simulation.results(),
        )  # fmt: skip


def _with_cell(settings: Settings | None, extent: Extent | None, cell_m: float | None) -> Settings | None:
    """The settings with which maps have this cell. What is wrong with the grid is said before anything runs."""
    if cell_m is None:
        if extent is not None:
            raise InputError("cell_m = None: must be given with extent, so that maps of all runs have the same cells")
        return settings
    cell = arguments.number("cell_m", cell_m, above=0)
    if extent is not None:
        arguments.grid(extent, cell)
    other = (settings or {}).get("outputs.map_cell_m", cell)
    if other != cell:
        raise InputError(f"cell_m = {cell:g}: outputs.map_cell_m is {other}; give one of them")
    return {**(settings or {}), "outputs.map_cell_m": cell}


class Study(List[Result]):
    """The results of study(), one per combination."""

    def stack(self, name: str) -> npt.NDArray[np.float32]:
        """The maps of that name as one array, `[run, row, column]`. They must lie on one grid: give study() a `cell_m`."""
        maps = []
        for number, result in enumerate(self):
            if name not in result.maps:
                raise InputError(f"name = {arguments.short(name)}: must be one of {', '.join(result.maps)}")
            maps.append(result.maps[name])
            if (maps[-1].extent, maps[-1].cell) != (maps[0].extent, maps[0].cell):
                raise InputError(f"{name} of run {number} has other cells than that of run 0; give study() a cell_m")
        return np.stack([found.values for found in maps]) if maps else np.zeros((0, 0, 0), np.float32)

    def table(self) -> Table:
        """A row per run: its settings, run-out, energy, structures hit, overtopping, verdict."""
        columns: dict[str, list[Any]] = {key: [r.settings.get(key) for r in self] for r in self for key in r.settings}
        columns["time_s"] = [r.time for r in self]
        columns["run_out_along_flow_m"] = [r.run_out.along_flow for r in self]
        columns["run_out_straight_m"] = [r.run_out.straight for r in self]
        columns["drop_m"] = [r.run_out.drop for r in self]
        columns["runout_angle_deg"] = [r.run_out.runout_angle for r in self]
        columns["peak_kinetic_energy_J"] = [max(r.energy.kinetic, default=np.nan) for r in self]
        columns["buildings_hit"] = [sum(s.hit and not s.is_barrier for s in r.structures) for r in self]
        columns["overtopped_m3"] = [_overtopped(r) for r in self]
        columns["within_limits"] = [bool(r.verdict["within_limits"]) for r in self]
        columns["hash"] = [r.hash for r in self]
        return Table(columns)

    def __repr__(self) -> str:
        beyond = sum(not r.verdict["within_limits"] for r in self)
        return f"<talus.Study: {len(self)} runs, {beyond} beyond a limit>"


def _overtopped(result: Result) -> float:
    """Over the crests of all barriers; NaN: there is none."""
    barriers = [structure.overtopped_volume for structure in result.structures if structure.is_barrier]
    return sum(barriers) if barriers else np.nan


_Job = Tuple[Any, Dict[str, object], Optional[float], Optional[Extent], Optional[float]]


def _run_one(job: _Job) -> Result:
    scene, settings, end_time, extent, cell_m = job
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # study() says it once
        return run(scene, settings, end_time=end_time, extent=extent, cell_m=cell_m, progress=False)


def study(
    scene: Scene,
    values: Mapping[str, Sequence[object]],
    settings: Settings | None = None,
    *,
    end_time: float | None = None,
    extent: Extent | None = None,
    cell_m: float | None = None,
    processes: int | None = None,
) -> Study:
    """Runs a scene once for every combination of `values` (a list by key), in `processes` at once (None: one per core),
    each on one thread. `extent`, `cell_m`: as of run(); with them Study.stack() has the maps of all runs in one array.
    Results are in the order of itertools.product; Result.settings says what each run had. Warns once if runs are beyond a
    limit (Result.verdict)."""
    if not isinstance(values, Mapping):
        raise InputError(f"values = {arguments.short(values)}: must be keys of the scene, each with a list of its values")
    for key, chosen in values.items():
        if isinstance(chosen, (str, bytes)) or not hasattr(chosen, "__len__") or not len(chosen):
            raise InputError(f"values[{key!r}] = {arguments.short(chosen)}: must be a list of values, one at least")
    arguments.settings(settings)
    base: dict[str, object] = {"solver.thread_count": 1, **(settings or {})}
    _with_cell({**base, **{key: chosen for key, chosen in values.items() if key == "outputs.map_cell_m"}}, extent, cell_m)
    if end_time is not None:
        end_time = arguments.time("end_time", end_time)
    at_once = (os.cpu_count() or 1) if processes is None else arguments.count("processes", processes, 512)
    jobs: list[_Job] = [
        (scene, {**base, **dict(zip(values, chosen))}, end_time, extent, cell_m)
        for chosen in itertools.product(*values.values())
    ]
    results = Study(work_in_processes(_run_one, jobs, max(1, at_once)))
    beyond = [warning for result in results for warning in result.verdict["warnings"][:1]]
    if beyond:
        warnings.warn(f"{len(beyond)} of {len(results)} runs are beyond a limit; the first: {beyond[0]}", stacklevel=2)
    return results
