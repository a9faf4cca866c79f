"""The GDAL that libtalus stands on: reference systems and GeoTIFF without any other package."""

from __future__ import annotations

import ctypes
import os
import re
from contextlib import contextmanager
from ctypes import POINTER, c_char_p, c_double, c_float, c_int, c_uint, c_void_p
from typing import TYPE_CHECKING, Any, Iterator

import numpy as np

from ._library import InputError, TalusError, library

if TYPE_CHECKING:
    import numpy.typing as npt

_no_value = -9999.0  #: in the maps that talus writes; NaN is refused by some programs
_read, _write, _float32 = 0, 1, 6
_raster_only, _say_errors = 0x02, 0x40
_failure = 3

# name: type of the answer, types of the arguments. Symbols of what the library depends on are found through it.
_functions: dict[str, tuple[Any, list[Any]]] = {
    "CPLPushErrorHandler": (None, [c_void_p]),
    "CPLPopErrorHandler": (None, []),
    "CPLErrorReset": (None, []),
    "CPLGetLastErrorMsg": (c_char_p, []),
    "CPLGetLastErrorType": (c_int, []),
    "VSIFree": (None, [c_void_p]),
    "OSRNewSpatialReference": (c_void_p, [c_char_p]),
    "OSRSetFromUserInput": (c_int, [c_void_p, c_char_p]),
    "OSRExportToWktEx": (c_int, [c_void_p, POINTER(c_void_p), POINTER(c_char_p)]),
    "OSRDestroySpatialReference": (None, [c_void_p]),
    "GDALRegister_GTiff": (None, []),
    "GDALGetDriverByName": (c_void_p, [c_char_p]),
    "GDALCreate": (c_void_p, [c_void_p, c_char_p, c_int, c_int, c_int, c_int, POINTER(c_char_p)]),
    "GDALOpenEx": (c_void_p, [c_char_p, c_uint, POINTER(c_char_p), POINTER(c_char_p), POINTER(c_char_p)]),
    "GDALClose": (None, [c_void_p]),
    "GDALSetGeoTransform": (c_int, [c_void_p, POINTER(c_double)]),
    "GDALGetGeoTransform": (c_int, [c_void_p, POINTER(c_double)]),
    "GDALSetProjection": (c_int, [c_void_p, c_char_p]),
    "GDALGetProjectionRef": (c_char_p, [c_void_p]),
    "GDALGetSpatialRef": (c_void_p, [c_void_p]),
    "OSRGetAuthorityName": (c_char_p, [c_void_p, c_char_p]),
    "OSRGetAuthorityCode": (c_char_p, [c_void_p, c_char_p]),
    "GDALGetRasterXSize": (c_int, [c_void_p]),
    "GDALGetRasterYSize": (c_int, [c_void_p]),
    "GDALGetRasterBand": (c_void_p, [c_void_p, c_int]),
    "GDALSetRasterNoDataValue": (c_int, [c_void_p, c_double]),
    "GDALGetRasterNoDataValue": (c_double, [c_void_p, POINTER(c_int)]),
    "GDALSetRasterUnitType": (c_int, [c_void_p, c_char_p]),
    "GDALGetRasterUnitType": (c_char_p, [c_void_p]),
    "GDALSetDescription": (None, [c_void_p, c_char_p]),
    "GDALRasterIO": (
        c_int,
        [c_void_p, c_int, c_int, c_int, c_int, c_int, c_void_p, c_int, c_int, c_int, c_int, c_int],
    ),
}
for _name, (_answer, _arguments) in _functions.items():
    try:
        _function = getattr(library, _name)
    except AttributeError as error:
        raise ImportError(f"libtalus has no {_name} of GDAL; install both from one version of talus") from error
    _function.restype = _answer
    _function.argtypes = _arguments
library.GDALRegister_GTiff()


@contextmanager
def _quiet() -> Iterator[None]:
    """GDAL prints nothing; _said() has its last message."""
    library.CPLPushErrorHandler(ctypes.cast(library.CPLQuietErrorHandler, c_void_p))
    library.CPLErrorReset()
    try:
        yield
    finally:
        library.CPLPopErrorHandler()


def _said() -> str:
    return " ".join(library.CPLGetLastErrorMsg().decode(errors="replace").split()) or "GDAL does not say why"


def wkt(crs: str) -> str:
    """"EPSG:2326", or WKT of any version, as WKT 2 (ISO 19162:2019)."""
    # Nothing else: GDAL would take the name of a file or an address for one.
    if not re.fullmatch(r"EPSG:\d+(\+\d+)?|[A-Z_]+\s*\[.*\]\s*", crs, re.DOTALL):
        raise InputError(f'crs = "{crs[:60]}": must be an EPSG code, such as "EPSG:2326", or WKT')
    reference = library.OSRNewSpatialReference(None)
    found = c_void_p()
    options = (c_char_p * 2)(b"FORMAT=WKT2_2019", None)
    try:
        with _quiet():
            if (
                library.OSRSetFromUserInput(reference, crs.encode()) != 0
                or library.OSRExportToWktEx(reference, ctypes.byref(found), options) != 0
            ):
                raise InputError(f'crs = "{crs[:60]}": {_said()}')
        return ctypes.string_at(found.value or 0).decode()
    finally:
        library.VSIFree(found)
        library.OSRDestroySpatialReference(reference)


def write(
    path: str, values: npt.NDArray[np.float32], *, x_min: float, y_max: float, cell: float, crs: str, unit: str, about: str
) -> None:
    """A GeoTIFF; row 0 of `values` is the northernmost, NaN becomes no value. A file of that name is replaced."""
    reference = wkt(crs) if crs else ""
    rows, columns = values.shape
    filled = np.ascontiguousarray(np.where(np.isnan(values), np.float32(_no_value), values), np.float32)
    options = (c_char_p * 4)(b"COMPRESS=DEFLATE", b"PREDICTOR=3", b"TILED=YES", None)
    unfinished = f"{path}.{os.getpid()}.unfinished"
    try:
        with _quiet():
            driver = library.GDALGetDriverByName(b"GTiff")
            raster = library.GDALCreate(driver, os.fsencode(unfinished), columns, rows, 1, _float32, options)
            if not raster:
                raise TalusError(f"{path}: cannot be written: {_said().replace(unfinished, path)}")
            band = library.GDALGetRasterBand(raster, 1)
            library.GDALSetGeoTransform(raster, (c_double * 6)(x_min, cell, 0, y_max, 0, -cell))
            if reference:
                library.GDALSetProjection(raster, reference.encode())
            library.GDALSetRasterNoDataValue(band, _no_value)
            library.GDALSetRasterUnitType(band, unit.encode())
            library.GDALSetDescription(band, about.encode())
            failed = _transfer(band, _write, filled)
            library.CPLErrorReset()
            library.GDALClose(raster)  # what it has not written yet it writes now
            if failed or library.CPLGetLastErrorType() >= _failure:
                raise TalusError(f"{path}: cannot be written: {_said()}")
        os.replace(unfinished, path)
    finally:
        if os.path.exists(unfinished):
            os.remove(unfinished)


def read(path: str) -> tuple[npt.NDArray[np.float32], float, float, float, str, str]:
    """Values with row 0 northernmost and NaN for no value, west edge, north edge, cell, reference system and unit of
    the first band of a GeoTIFF with square cells."""
    with _quiet():
        drivers = (c_char_p * 2)(b"GTiff", None)
        raster = library.GDALOpenEx(os.fsencode(path), _raster_only | _say_errors, drivers, None, None)
        if not raster:
            raise InputError(f"{path}: cannot be read as GeoTIFF: {_said()}")
        try:
            found = (c_double * 6)()
            placed = library.GDALGetGeoTransform(raster, found) == 0
            x_min, width, turned_x, y_max, turned_y, height = found
            if not placed or turned_x or turned_y or not np.isclose(width, -height, rtol=1e-6):
                raise InputError(f"{path}: has no place, is turned or has cells that are not square; its cells must be square")
            band = library.GDALGetRasterBand(raster, 1)
            values = np.empty((library.GDALGetRasterYSize(raster), library.GDALGetRasterXSize(raster)), np.float32)
            if _transfer(band, _read, values):
                raise InputError(f"{path}: cannot be read: {_said()}")
            given = c_int()
            no_value = library.GDALGetRasterNoDataValue(band, ctypes.byref(given))
            if given.value:
                values[values == np.float32(no_value)] = np.nan
            return values, x_min, y_max, width, _reference_of(raster), library.GDALGetRasterUnitType(band).decode()
        finally:
            library.GDALClose(raster)


def _reference_of(raster: c_void_p) -> str:
    """"EPSG:2326"; WKT where it has no such code; "" where there is none."""
    reference = library.GDALGetSpatialRef(raster)
    if reference and library.OSRGetAuthorityName(reference, None) == b"EPSG":
        return "EPSG:" + str(library.OSRGetAuthorityCode(reference, None).decode())
    return str(library.GDALGetProjectionRef(raster).decode())


def _transfer(band: c_void_p, direction: int, values: npt.NDArray[np.float32]) -> bool:
    rows, columns = values.shape
    pointer = values.ctypes.data_as(POINTER(c_float))
    code = library.GDALRasterIO(
        band, direction, 0, 0, columns, rows, ctypes.cast(pointer, c_void_p), columns, rows, _float32, 0, 0
    )
    return bool(code != 0)
