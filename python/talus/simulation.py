"""Simulations: made from a scene file or from arrays, stepped, changed and read as NumPy arrays."""

from __future__ import annotations

import ctypes
import enum
import json
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Callable, Mapping, NoReturn, Sequence

import numpy as np

from . import _arguments as arguments
from . import _library as lib
from .maps import UNITS, Extent, Map
from .measures import Energy, Front, Gauge, RunOut, Structure, gauges_of, numbers, run_out_of, with_impacts

if TYPE_CHECKING:
    import numpy.typing as npt

Settings = Mapping[str, object]
#: Is told ten times a second what share of a call is done, 0 to 1. What it raises cancels the call.
Progress = Callable[[float], object]


class Phase(enum.IntEnum):
    """Whether a simulation goes on."""

    READY = 0
    AT_REST = 1  #: what still moves changes no result
    ENDED = 2  #: solver.end_time_s is reached, or no debris is left
    STOPPED = 3  #: a step could not be trusted


@dataclass(frozen=True)
class Building:
    """A building: its outline as (x, y) world coordinates in m, and its height above the mean ground of it in m."""

    outline: Sequence[tuple[float, float]]
    height: float = 6
    name: str = ""


class Simulation:
    """A debris flow in a scene. Not to be used by two threads at once; several simulations can be.

    >>> with Simulation("my_scene/scene.toml", {"material.friction_coefficient": 0.3}) as simulation:
    ...     simulation.advance(20)
    ...     simulation.map("peak_depth").plot()

    Arrays that it returns are copies: they stay as they are when it goes on or is closed. Ctrl-C ends a call within
    0.2 s and leaves the simulation as its last whole step did.
    """

    def __init__(
        self,
        scene: str | os.PathLike[str] | None = None,
        settings: Settings | None = None,
        progress: Progress | None = None,
    ) -> None:
        """`scene`: a scene file; None: the scene that comes with the library. `settings`: keys of the scene, as for
        `talus run --set`, with their values."""
        path = None if scene is None else arguments.path("scene", scene)
        texts = _texts(settings)
        self._open(lambda watch, made: lib.call("talus_open", path, *texts, watch, made), progress)

    @classmethod
    def from_arrays(
        cls,
        elevation: npt.ArrayLike,
        release: npt.ArrayLike,
        *,
        crs: str,
        cell: float,
        x_min: float = 0,
        y_min: float = 0,
        buildings: Sequence[Building] = (),
        settings: Settings | None = None,
        folder: str | os.PathLike[str] | None = None,
        progress: Progress | None = None,
    ) -> Simulation:
        """A scene from arrays of the same shape, row 0 southernmost: `elevation` in m (NaN: not known), `release` the
        vertical thickness in m of the debris that fails, part of the elevation (0: none). `crs`: projected and metric,
        "EPSG:2326"; or "local", metres of its own, as those of a flume. `folder`: a new or empty one that the scene is written into; such a simulation can be saved.
        """
        ground = arguments.raster("elevation", elevation)
        thickness = arguments.raster("release", release)
        if ground.shape != thickness.shape:
            raise lib.InputError(f"elevation has shape {ground.shape}, release {thickness.shape}; both must be (rows, columns)")
        outlines, houses = [], []
        for k, building in enumerate(buildings):
            if not isinstance(building, Building):
                raise lib.InputError(f"buildings[{k}] must be a talus.Building")
            name = arguments.text(f"buildings[{k}].name", building.name or f"building {k + 1}")
            outline = arguments.outline(f"buildings[{k}].outline", building.outline)
            height = arguments.number(f"buildings[{k}].height", building.height, above=0, most=1000)
            outlines.append(outline)
            houses.append(lib.Building(name, _pointer(outline, ctypes.c_double), len(outline), height))
        rows, columns = (arguments.count("rows of elevation", n, 2**20) for n in ground.shape)
        grid = lib.Grid(
            arguments.number("x_min", x_min), arguments.number("y_min", y_min), arguments.number("cell", cell, above=0),
            columns, rows,
        )  # fmt: skip
        arrays = lib.Arrays(
            arguments.text("crs", crs), grid, _pointer(ground, ctypes.c_float), _pointer(thickness, ctypes.c_float),
            (lib.Building * len(houses))(*houses), len(houses),
        )  # fmt: skip
        path = None if folder is None else arguments.path("folder", folder)
        texts = _texts(settings)
        simulation = cls.__new__(cls)

        def work(watch: Any, made: Any, _: object = (ground, thickness, outlines)) -> None:  # kept as long as the call may last
            lib.call("talus_open_arrays", ctypes.byref(arrays), path, *texts, watch, made)

        simulation._open(work, progress)
        return simulation

    @classmethod
    def from_saved(cls, file: str | os.PathLike[str], progress: Progress | None = None) -> Simulation:
        """What save() wrote, computed again to the same bits."""
        path = arguments.path("file", file)
        simulation = cls.__new__(cls)
        simulation._open(lambda watch, made: lib.call("talus_open_saved", path, watch, made), progress)
        return simulation

    def _open(self, work: Callable[[Any, Any], None], progress: Progress | None) -> None:
        made = ctypes.c_void_p()
        self._made = ctypes.c_void_p()
        self._calls = lib.Caller()
        self._calls(
            lambda watch: work(watch, ctypes.byref(made)), progress, lambda: lib.close(made)
        )
        self._made = made
        self._crs = ""

    @property
    def _handle(self) -> ctypes.c_void_p:
        if not self._made:
            raise lib.InputError("the simulation is closed")
        self._calls.wait()
        return self._made

    def close(self) -> None:
        """Frees its memory."""
        made, calls = getattr(self, "_made", None), getattr(self, "_calls", None)
        self._made = ctypes.c_void_p()
        if calls:
            calls.close()
        if made:
            lib.close(made)

    def __enter__(self) -> Simulation:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        self.close()

    def __reduce__(self) -> NoReturn:
        raise TypeError("a Simulation cannot be copied or pickled; save() it, and open it again with from_saved()")

    def __repr__(self) -> str:
        if not getattr(self, "_made", None):
            return "<talus.Simulation: closed>"
        if self._calls.busy:
            return "<talus.Simulation: finishes a step>"
        particles = len(self.id)
        return (
            f'<talus.Simulation "{self.json("scene")["title"]}": t = {self.time:.4g} s after {self.steps} steps, '
            f"{particles} particles, {self.phase.name.lower().replace('_', ' ')}>"
        )

    def step(self, count: int = 1, progress: Progress | None = None) -> Phase:
        """Takes time steps, fewer if the run is over before. Raises FaultError where a step cannot be trusted."""
        handle, steps = self._handle, arguments.count("count", count)
        self._calls(lambda watch: lib.call("talus_step", handle, steps, watch), progress)
        return self.phase

    def advance(self, time: float, progress: Progress | None = None) -> Phase:
        """Takes steps until `time`, s, or until the run is over."""
        handle, end = self._handle, arguments.time("time", time)
        self._calls(lambda watch: lib.call("talus_advance", handle, end, watch), progress)
        return self.phase

    @property
    def _state(self) -> lib.State:
        state = lib.State()
        lib.call("talus_get_state", self._handle, ctypes.byref(state))
        return state

    @property
    def phase(self) -> Phase:
        """Whether it goes on; `message` says why not."""
        return Phase(self._state.phase)

    @property
    def message(self) -> str:
        """Why it is at rest, ended or stopped; empty while ready."""
        return str(self._state.message.decode())

    @property
    def time(self) -> float:
        """Simulated time, s."""
        return float(self._state.time)

    @property
    def steps(self) -> int:
        """Time steps taken so far."""
        return int(self._state.steps)

    @property
    def hash(self) -> str:
        """Of time, positions and velocities: equal for equal results, on any number of threads."""
        found = ctypes.c_uint64()
        lib.call("talus_get_hash", self._handle, ctypes.byref(found))
        return f"{found.value:016x}"

    @property
    def origin(self) -> npt.NDArray[np.float64]:
        """World position (x, y, z) of the local frame, m."""
        return np.array(self._state.origin)

    @property
    def particle_volume(self) -> float:
        """Volume that a particle stands for, m3."""
        return float(self._state.particle_volume)

    def _debris(self, *names: str) -> tuple[npt.NDArray[Any], ...]:
        debris = lib.Debris()
        lib.call("talus_get_debris", self._handle, ctypes.byref(debris))
        return tuple(_copy(getattr(debris, name), (debris.count,)) for name in names)

    @property
    def position(self) -> tuple[npt.NDArray[np.float32], ...]:
        """x, y and z of every particle, m from `origin`, as they are now."""
        return self._debris("x", "y", "z")

    @property
    def velocity(self) -> tuple[npt.NDArray[np.float32], ...]:
        """Its components along x, y and z, m/s, as they are now."""
        return self._debris("vx", "vy", "vz")

    @property
    def id(self) -> npt.NDArray[np.uint32]:
        """Names every particle for good, as their order changes."""
        return self._debris("id")[0]

    @property
    def crs(self) -> str:
        """Reference system of the terrain: "EPSG:2326", or WKT where it has no code."""
        if not self._crs:
            named = str(self.json("scene")["crs"])
            self._crs = named if named.startswith("EPSG:") else str(self.json("measures")["crs_wkt"])
        return self._crs

    def map(self, name: str, extent: Extent | None = None, cell_m: float | None = None) -> Map:
        """The map of that name (see UNITS) as it is now. `extent`, `cell_m`: on these cells, as Map.on_grid(); None: where it
        has values, on those of the run."""
        found = lib.Map()
        lib.call("talus_get_map", self._handle, arguments.text("name", name), ctypes.byref(found))
        grid = found.grid
        values = _copy(found.values, (grid.rows, grid.columns))
        made = Map(str(name), values, grid.x_min, grid.y_min, grid.cell, self.crs, UNITS.get(name, ""))
        if extent is None and cell_m is None:
            return made
        return made.on_grid(self.extent if extent is None else extent, cell_m)

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """West, south, east and north edge of the cells that maps can have, m."""
        grid = self.json("scene")["map"]
        west, south, cell = grid["x_min_m"], grid["y_min_m"], grid["cell_m"]
        return west, south, west + grid["columns"] * cell, south + grid["rows"] * cell

    @property
    def front(self) -> Front:
        """The front along the flow path so far; empty before debris reaches it."""
        front = lib.Front()
        lib.call("talus_get_front", self._handle, ctypes.byref(front))
        return Front(*(_copy(c, (front.count,)) for c in (front.chainage, front.arrival_time, front.velocity)))

    @property
    def verdict(self) -> dict[str, Any]:
        """Whether the results so far can be relied on, as `verdict` of docs/results.md: resolution, compression, energy,
        what still moves at the end."""
        found: dict[str, Any] = self.json("verdict")
        return found

    @property
    def structures(self) -> list[Structure]:
        """Buildings and barriers in the order in which they were added."""
        made = []
        for index in range(self._state.structure_count):
            s = lib.Structure()
            lib.call("talus_get_structure", self._handle, index, ctypes.byref(s))
            made.append(
                Structure(s.name.decode(), bool(s.hit), bool(s.is_barrier), s.first_hit_time, s.failure_time,
                          s.peak_force, s.peak_impact_pressure, s.peak_depth, s.impulse)
            )  # fmt: skip
        impacts = self.json("impacts")
        return [with_impacts(structure, impacts) for structure in made]

    @property
    def series(self) -> dict[str, npt.NDArray[np.float64]]:
        """The run over time, every outputs.sample_interval_s: "time_s", "kinetic_energy_J", "volume_deposited_m3", ..."""
        return {name: numbers(column) for name, column in self.json("series")["time"].items()}

    @property
    def energy(self) -> Energy:
        """Energy over time. Whether debris has more than gravity gave it is a check of `verdict`."""
        series = self.json("series")["time"]
        return Energy(*(numbers(series[name]) for name in ("time_s", "kinetic_energy_J", "potential_energy_J")))

    @property
    def gauges(self) -> list[Gauge]:
        """What the gauges of the scene have recorded."""
        return gauges_of(self.json("measures")) if self.json("scene")["gauges"] else []

    @property
    def run_out(self) -> RunOut:
        """How far debris has come so far."""
        return run_out_of(self.json("measures"))

    def results(self) -> dict[str, Any]:
        """What a report of the run so far shows, as results.json of docs/results.md."""
        results: dict[str, Any] = self.json("results")
        return results

    def set(self, key: str, value: float) -> None:
        """A live key of the scene between two steps: "material.friction_coefficient"."""
        lib.call("talus_set", self._handle, arguments.text("key", key), arguments.number("value", value))

    def apply(self, action: str, **keys: object) -> str:
        """An action of docs/protocol.md, such as apply("put_barrier", line=[[x, y], [x, y]], height_m=4). Returns the id
        of what is new, or ""."""
        created = ctypes.c_char_p()
        values = [f", {json.dumps(key)}: {arguments.as_json(key, value)}" for key, value in keys.items()]
        text = f'{{"action": {arguments.as_json("action", action)}{"".join(values)}}}'.encode()
        handle = self._handle
        self._calls(lambda _: lib.call("talus_apply", handle, text, ctypes.byref(created)))
        return (created.value or b"").decode()

    def json(self, name: str) -> Any:
        """"scene", "state", "setup", "impacts" or "series", as docs/protocol.md has them; "verdict", "results" and "measures"
        of talus.h."""
        text = ctypes.c_char_p()
        lib.call("talus_get_json", self._handle, arguments.text("name", name), ctypes.byref(text))
        return json.loads((text.value or b"").decode())

    def write_results(self, folder: str | os.PathLike[str]) -> None:
        """Maps, tables and report, as `talus run` writes them, into a new or empty folder."""
        handle, path = self._handle, arguments.path("folder", folder)
        self._calls(lambda _: lib.call("talus_write_results", handle, path))

    def save(self, file: str | os.PathLike[str]) -> None:
        """Writes what determines the state; see from_saved()."""
        lib.call("talus_save", self._handle, arguments.path("file", file))


def _texts(settings: Settings | None) -> tuple[Any, int]:
    texts = arguments.settings(settings)
    return (ctypes.c_char_p * len(texts))(*texts), len(texts)


def _copy(values: Any, shape: tuple[int, ...]) -> npt.NDArray[Any]:
    if 0 in shape:  # there may be no array at all
        return np.zeros(shape, values._type_)
    return np.ctypeslib.as_array(values, shape).copy()


def _pointer(array: npt.NDArray[Any], kind: Any) -> Any:
    return array.ctypes.data_as(ctypes.POINTER(kind))
