"""Maps: rasters of a run or of many, on the grid of the run or on a fixed one, and what other programs take them as."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Sequence

import numpy as np

from . import _arguments as arguments
from . import _gdal
from ._library import InputError

if TYPE_CHECKING:
    import numpy.typing as npt

#: West, south, east and north edge, m.
Extent = Sequence[float]

#: Maps of a run by name, with their units.
UNITS = {
    "depth": "m",
    "speed": "m/s",
    "peak_depth": "m",
    "peak_speed": "m/s",
    "peak_pressure": "Pa",
    "arrival_time": "s",
    "deposit_depth": "m",
    "erosion_depth": "m",
}
_rounding = 1e-6  # of a cell
_volumes = ("depth", "deposit_depth", "erosion_depth")  # their sum over cells means something


@dataclass(frozen=True, repr=False)
class Map:
    """A raster: `values[row, column]`, row 0 southernmost; NaN where there is no value."""

    name: str
    values: npt.NDArray[np.float32]
    x_min: float  #: west edge, m
    y_min: float  #: south edge, m
    cell: float  #: m
    crs: str = ""  #: "EPSG:2326" or WKT; "": not known
    unit: str = ""  #: "m", "m/s", ...; "": that of UNITS, or none

    def __post_init__(self) -> None:
        if not self.unit:
            object.__setattr__(self, "unit", UNITS.get(self.name, ""))

    def __repr__(self) -> str:
        rows, columns = self.values.shape
        known = self.values[np.isfinite(self.values)]
        span = f"{known.min():.4g} to {known.max():.4g} {self.unit}".rstrip() if known.size else "no value"
        west, south, _, _ = self.extent
        return f"<talus.Map {self.name}: {rows} x {columns} cells of {self.cell:g} m from ({west:.10g}, {south:.10g}), {span}>"

    @property
    def x(self) -> npt.NDArray[np.float64]:
        """Of the middle of each column, m."""
        return self.x_min + (np.arange(self.values.shape[1]) + 0.5) * self.cell

    @property
    def y(self) -> npt.NDArray[np.float64]:
        """Of the middle of each row, m."""
        return self.y_min + (np.arange(self.values.shape[0]) + 0.5) * self.cell

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """West, south, east and north edge, m."""
        rows, columns = self.values.shape
        return self.x_min, self.y_min, self.x_min + columns * self.cell, self.y_min + rows * self.cell

    def on_grid(self, extent: Extent, cell_m: float | None = None) -> Map:
        """The same map on the cells of `cell_m`, m (None: as its own), between west, south, east and north edge. Beyond
        its own edges there is no value. A cell smaller than its own has the value of that in which its middle
        lies. A cell as large or larger has the greatest of the values whose cells have their middle in it; the least arrival time; of
        depth, deposit and erosion the mean, with 0 where there is no value, so that a layer of one depth keeps that, and
        volumes stay where `cell_m` is a multiple of its own. As talus_get_map_on() of talus.h."""
        cell = self.cell if cell_m is None else arguments.number("cell_m", cell_m, above=0)
        x_min, y_min, columns, rows = arguments.grid(extent, cell)
        if cell >= self.cell * (1 - 1e-9):
            values = self._gathered(x_min, y_min, cell, (rows, columns))
        else:
            column = np.floor((x_min + (np.arange(columns) + 0.5) * cell - self.x_min) / self.cell).astype(np.int64)
            row = np.floor((y_min + (np.arange(rows) + 0.5) * cell - self.y_min) / self.cell).astype(np.int64)
            there = np.ix_((row >= 0) & (row < self.values.shape[0]), (column >= 0) & (column < self.values.shape[1]))
            values = np.full((rows, columns), np.nan, np.float32)
            values[there] = self.values[np.ix_(row[there[0].ravel()], column[there[1].ravel()])]
        return replace(self, values=values, x_min=x_min, y_min=y_min, cell=cell)

    def _gathered(self, x_min: float, y_min: float, cell: float, shape: tuple[int, int]) -> npt.NDArray[np.float32]:
        # Which of the cells holds a middle of its own ones, and how many it would hold, had the map no edges: beyond them
        # there is no debris. Both by the same rounding, so that a middle on an edge counts where it is added: in the upper
        # cell, also where rounding has moved it.
        first_row = np.ceil((y_min + np.arange(shape[0] + 1) * cell - self.y_min) / self.cell - 0.5 - _rounding)
        first_column = np.ceil((x_min + np.arange(shape[1] + 1) * cell - self.x_min) / self.cell - 0.5 - _rounding)
        row = np.searchsorted(first_row, np.arange(self.values.shape[0]), side="right") - 1
        column = np.searchsorted(first_column, np.arange(self.values.shape[1]), side="right") - 1
        within = np.logical_and.outer((row >= 0) & (row < shape[0]), (column >= 0) & (column < shape[1]))
        rows, columns = np.nonzero(within & np.isfinite(self.values))
        given, to = self.values[rows, columns], (row[rows], column[columns])
        values = np.full(shape, np.nan, np.float32)
        if self.name in _volumes:
            total = np.zeros(shape)
            np.add.at(total, to, given)
            middles = np.outer(np.diff(first_row), np.diff(first_column))
            values[to] = total[to] / middles[to]
        elif self.name.startswith("arrival_time"):
            np.fmin.at(values, to, given)
        else:
            np.fmax.at(values, to, given)
        return values

    def to_xarray(self) -> Any:
        """An xarray.DataArray with coordinates x and y and its unit; with a known reference system also the coordinate
        spatial_ref, as rioxarray reads and writes it. Needs xarray."""
        import xarray

        coordinates: dict[str, Any] = {"y": ("y", self.y, _axis("y")), "x": ("x", self.x, _axis("x"))}
        if self.crs:
            # GDAL's order; the cells of `values` begin in the south, as y does.
            west, south, cell = float(self.x_min), float(self.y_min), float(self.cell)
            place = f"{west!r} {cell!r} 0.0 {south!r} 0.0 {cell!r}"
            reference = _gdal.wkt(self.crs)
            attributes = {"crs_wkt": reference, "spatial_ref": reference, "GeoTransform": place}
            coordinates["spatial_ref"] = ((), 0, attributes)
        made = xarray.DataArray(self.values, coordinates, ("y", "x"), self.name, {"units": self.unit})
        if self.crs:
            made.encoding["grid_mapping"] = "spatial_ref"
        return made

    def plot(self, ax: Any = None) -> Any:
        """Draws the map on matplotlib axes and returns them. Needs matplotlib."""
        import matplotlib.pyplot as plt

        ax = ax or plt.gca()
        west, south, east, north = self.extent
        image = ax.imshow(self.values, origin="lower", extent=(west, east, south, north), cmap="cividis_r")
        label = ", ".join(part for part in (self.name.replace("_", " "), self.unit) if part)
        ax.figure.colorbar(image, ax=ax, label=label)
        ax.set_xlabel("east, m")
        ax.set_ylabel("north, m")
        return ax


def _axis(name: str) -> dict[str, str]:
    return {
        "axis": name.upper(),
        "long_name": f"{name} coordinate of projection",
        "standard_name": f"projection_{name}_coordinate",
        "units": "metre",
    }


def write_geotiff(path: str | os.PathLike[str], map: Map) -> None:
    """A map as GeoTIFF with its reference system and unit, north up, for QGIS and others. Replaces a file of that name."""
    if not isinstance(map, Map):
        raise InputError(f"map = {arguments.short(map)}: must be a talus.Map")
    file = os.fsdecode(arguments.path("path", path))
    values = arguments.raster("map.values", map.values)
    if 0 in values.shape:
        raise InputError(f"map.values has shape {values.shape}; it must have a cell at least")
    cell = arguments.number("map.cell", map.cell, above=0)
    x_min, y_min = arguments.number("map.x_min", map.x_min), arguments.number("map.y_min", map.y_min)
    _gdal.write(
        file, values[::-1], x_min=x_min, y_max=y_min + values.shape[0] * cell, cell=cell, crs=map.crs, unit=map.unit,
        about=map.name.replace("_", " "),
    )  # fmt: skip


def read_geotiff(path: str | os.PathLike[str]) -> Map:
    """A map that write_geotiff() or the program wrote, named after its file."""
    file = os.fsdecode(arguments.path("path", path))
    values, x_min, y_max, cell, crs, unit = _gdal.read(file)
    name = os.path.splitext(os.path.basename(file))[0]
    return Map(name, values[::-1].copy(), x_min, y_max - values.shape[0] * cell, cell, crs, unit)


def union(maps: Sequence[Map]) -> tuple[float, float, float, float]:
    """The extent of them all: of maps whose cells lie on one grid."""
    west, south, east, north = zip(*(found.extent for found in maps))
    return min(west), min(south), max(east), max(north)
