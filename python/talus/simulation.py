"""Simulations: made from a scene file or from arrays, stepped, changed and read as NumPy arrays."""

from __future__ import annotations

import ctypes
import enum
import json
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Iterator, Mapping, Sequence

import numpy as np

from . import _library as lib

if TYPE_CHECKING:
    import numpy.typing as npt

Settings = Mapping[str, object]


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


@dataclass(frozen=True)
class Map:
    """A raster: `values[row, column]`, row 0 southernmost; NaN where there is no value."""

    name: str
    values: npt.NDArray[np.float32]
    x_min: float  #: west edge, m
    y_min: float  #: south edge, m
    cell: float  #: m

    @property
    def x(self) -> npt.NDArray[np.float64]:
        """Of the middle of each column, m."""
        return self.x_min + (np.arange(self.values.shape[1]) + 0.5) * self.cell

    @property
    def y(self) -> npt.NDArray[np.float64]:
        """Of the middle of each row, m."""
        return self.y_min + (np.arange(self.values.shape[0]) + 0.5) * self.cell

    def to_xarray(self) -> Any:
        """An xarray.DataArray with coordinates x and y, and its unit as attribute. Needs xarray."""
        import xarray

        return xarray.DataArray(
            self.values, {"y": self.y, "x": self.x}, ("y", "x"), name=self.name, attrs={"units": UNITS[self.name]}
        )

    def plot(self, ax: Any = None) -> Any:
        """Draws the map on matplotlib axes and returns them. Needs matplotlib."""
        import matplotlib.pyplot as plt

        ax = ax or plt.gca()
        east, north = self.x_min + self.values.shape[1] * self.cell, self.y_min + self.values.shape[0] * self.cell
        image = ax.imshow(self.values, origin="lower", extent=(self.x_min, east, self.y_min, north), cmap="cividis_r")
        ax.figure.colorbar(image, ax=ax, label=f"{self.name.replace('_', ' ')}, {UNITS[self.name]}")
        ax.set_xlabel("east, m")
        ax.set_ylabel("north, m")
        return ax


#: Maps by name, with their units.
UNITS = {
    "depth": "m",
    "peak_depth": "m",
    "peak_speed": "m/s",
    "peak_pressure": "Pa",
    "arrival_time": "s",
    "deposit_depth": "m",
    "erosion_depth": "m",
}


@dataclass(frozen=True)
class Front:
    """The front along the flow path. NaN: no value."""

    chainage: npt.NDArray[np.float64]  #: m
    arrival_time: npt.NDArray[np.float64]  #: s
    velocity: npt.NDArray[np.float64]  #: m/s


@dataclass(frozen=True)
class Structure:
    """What debris did to a building or barrier."""

    name: str
    hit: bool
    is_barrier: bool
    first_hit_time: float  #: s; NaN: not hit
    failure_time: float  #: s; NaN: it did not fail
    peak_force: float  #: N, on all its walls, filtered over outputs.impact_filter_window_s
    peak_impact_pressure: float  #: Pa, of a patch of outputs.impact_patch_edge_m squared, filtered likewise
    peak_depth: float  #: m, of the flow in front of its walls
    impulse: float  #: N s


def _setting_text(value: object) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return json.dumps(value) if isinstance(value, (list, tuple)) else str(value)


class Simulation:
    """A debris flow in a scene. Not to be used by two threads at once; several simulations can be.

    >>> with Simulation("my_scene/scene.toml", {"material.friction_coefficient": 0.3}) as simulation:
    ...     simulation.advance(20)
    ...     simulation.map("peak_depth").plot()
    """

    def __init__(self, scene: str | os.PathLike[str] | None = None, settings: Settings | None = None) -> None:
        """`scene`: a scene file; None: the scene that comes with the library. `settings`: keys of the scene, as for
        `talus run --set`, with their values."""
        self._made = ctypes.c_void_p()
        path = None if scene is None else os.fsencode(scene)
        lib.call("talus_open", path, *self._texts(settings), ctypes.byref(self._made))

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
    ) -> Simulation:
        """A scene from arrays of the same shape, row 0 southernmost: `elevation` in m (NaN: not known), `release` the
        vertical thickness in m of the debris that fails, part of the elevation (0: none). `crs`: projected and metric,
        "EPSG:2326". `folder`: a new or empty one that the scene is written into; such a simulation can be saved.
        """
        ground = np.ascontiguousarray(elevation, np.float32)
        thickness = np.ascontiguousarray(release, np.float32)
        if ground.ndim != 2 or ground.shape != thickness.shape:
            raise lib.InputError(f"elevation has shape {ground.shape}, release {thickness.shape}; both must be (rows, columns)")
        outlines = [np.ascontiguousarray(b.outline, np.float64).reshape(-1, 2) for b in buildings]
        made = (lib.Building * len(outlines))(
            *(
                lib.Building((b.name or f"building {k + 1}").encode(), _pointer(o, ctypes.c_double), len(o), b.height)
                for k, (b, o) in enumerate(zip(buildings, outlines))
            )
        )
        rows, columns = ground.shape
        arrays = lib.Arrays(
            crs.encode(), lib.Grid(x_min, y_min, cell, columns, rows), _pointer(ground, ctypes.c_float),
            _pointer(thickness, ctypes.c_float), made, len(outlines),
        )  # fmt: skip
        path = None if folder is None else os.fsencode(folder)
        simulation = cls.__new__(cls)
        simulation._made = ctypes.c_void_p()
        texts = simulation._texts(settings)
        lib.call("talus_open_arrays", ctypes.byref(arrays), path, *texts, ctypes.byref(simulation._made))
        return simulation

    @classmethod
    def from_saved(cls, file: str | os.PathLike[str]) -> Simulation:
        """What save() wrote, computed again to the same bits."""
        simulation = cls.__new__(cls)
        simulation._made = ctypes.c_void_p()
        lib.call("talus_open_saved", os.fsencode(file), ctypes.byref(simulation._made))
        return simulation

    @staticmethod
    def _texts(settings: Settings | None) -> tuple[Any, int]:
        texts = [f"{key}={_setting_text(value)}".encode() for key, value in (settings or {}).items()]
        return (ctypes.c_char_p * len(texts))(*texts), len(texts)

    @property
    def _handle(self) -> ctypes.c_void_p:
        if not self._made:
            raise lib.InputError("the simulation is closed")
        return self._made

    def close(self) -> None:
        """Frees its memory; views of its arrays must not be used any more."""
        if getattr(self, "_made", None):
            lib.library.talus_close(self._made)
            self._made = ctypes.c_void_p()

    def __enter__(self) -> Simulation:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        self.close()

    def step(self, count: int = 1) -> Phase:
        """Takes time steps, fewer if the run is over before. Raises FaultError where a step cannot be trusted."""
        lib.call("talus_step", self._handle, count)
        return self.phase

    def advance(self, time: float) -> Phase:
        """Takes steps until `time`, s, or until the run is over."""
        lib.call("talus_advance", self._handle, time)
        return self.phase

    @property
    def phase(self) -> Phase:
        """Whether it goes on; `message` says why not."""
        return Phase(lib.library.talus_get_phase(self._handle))

    @property
    def message(self) -> str:
        """Why it is at rest, ended or stopped; empty while ready."""
        return lib.library.talus_message(self._handle).decode()

    @property
    def time(self) -> float:
        """Simulated time, s."""
        return lib.library.talus_time(self._handle)

    @property
    def steps(self) -> int:
        """Time steps taken so far."""
        return lib.library.talus_steps(self._handle)

    @property
    def hash(self) -> str:
        """Of time, positions and velocities: equal for equal results, on any number of threads."""
        return f"{lib.library.talus_hash(self._handle):016x}"

    @property
    def origin(self) -> npt.NDArray[np.float64]:
        """World position (x, y, z) of the local frame, m."""
        origin = np.zeros(3)
        lib.library.talus_origin(self._handle, _pointer(origin, ctypes.c_double))
        return origin

    @property
    def particle_volume(self) -> float:
        """Volume that a particle stands for, m3."""
        return lib.library.talus_particle_volume(self._handle)

    def _views(self, *names: str) -> Iterator[npt.NDArray[Any]]:
        debris = lib.library.talus_get_debris(self._handle)
        for name in names:
            view = np.ctypeslib.as_array(getattr(debris, name), (debris.count,))
            view.flags.writeable = False
            yield view

    @property
    def position(self) -> tuple[npt.NDArray[np.float32], ...]:
        """x, y and z of every particle, m from `origin`: views of the simulation's arrays, valid until the next step."""
        return tuple(self._views("x", "y", "z"))

    @property
    def velocity(self) -> tuple[npt.NDArray[np.float32], ...]:
        """Its components along x, y and z, m/s: views, as position."""
        return tuple(self._views("vx", "vy", "vz"))

    @property
    def id(self) -> npt.NDArray[np.uint32]:
        """Names every particle for good, as their order changes: a view, as position."""
        return next(self._views("id"))

    def map(self, name: str) -> Map:
        """The map of that name (see UNITS) as it is now."""
        found = lib.Map()
        lib.call("talus_get_map", self._handle, name.encode(), ctypes.byref(found))
        grid = found.grid
        values = np.ctypeslib.as_array(found.values, (grid.rows, grid.columns)).copy()
        return Map(name, values, grid.x_min, grid.y_min, grid.cell)

    @property
    def front(self) -> Front:
        """The front along the flow path so far; empty before debris reaches it."""
        front = lib.library.talus_get_front(self._handle)
        if front.count == 0:
            return Front(np.zeros(0), np.zeros(0), np.zeros(0))
        columns = (front.chainage, front.arrival_time, front.velocity)
        return Front(*(np.ctypeslib.as_array(column, (front.count,)).copy() for column in columns))

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
        for index in range(lib.library.talus_structure_count(self._handle)):
            s = lib.Structure()
            lib.call("talus_get_structure", self._handle, index, ctypes.byref(s))
            made.append(
                Structure(s.name.decode(), bool(s.hit), bool(s.is_barrier), s.first_hit_time, s.failure_time,
                          s.peak_force, s.peak_impact_pressure, s.peak_depth, s.impulse)
            )  # fmt: skip
        return made

    def set(self, key: str, value: float) -> None:
        """A live key of the scene between two steps: "material.friction_coefficient"."""
        lib.call("talus_set", self._handle, key.encode(), value)

    def apply(self, action: str, **keys: object) -> str:
        """An action of docs/protocol.md, such as apply("put_barrier", line=[[x, y], [x, y]], height_m=4). Returns the id
        of what is new, or ""."""
        created = ctypes.c_char_p()
        text = json.dumps({"action": action, **keys}).encode()
        lib.call("talus_apply", self._handle, text, ctypes.byref(created))
        return (created.value or b"").decode()

    def json(self, name: str) -> Any:
        """"scene", "state", "setup", "impacts" or "series", as docs/protocol.md has them; "verdict"."""
        text = ctypes.c_char_p()
        lib.call("talus_get_json", self._handle, name.encode(), ctypes.byref(text))
        return json.loads((text.value or b"").decode())

    def write_results(self, folder: str | os.PathLike[str]) -> None:
        """Maps, tables and report, as `talus run` writes them, into a new or empty folder."""
        lib.call("talus_write_results", self._handle, os.fsencode(folder))

    def save(self, file: str | os.PathLike[str]) -> None:
        """Writes what determines the state; see from_saved()."""
        lib.call("talus_save", self._handle, os.fsencode(file))


def _pointer(array: npt.NDArray[Any], kind: Any) -> Any:
    return array.ctypes.data_as(ctypes.POINTER(kind))
