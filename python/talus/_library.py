"""libtalus as ctypes sees it: the declarations of talus.h, and errors as exceptions."""

from __future__ import annotations

import ctypes
from ctypes import POINTER, c_char_p, c_double, c_float, c_int, c_int32, c_size_t, c_uint8, c_uint32, c_uint64, c_void_p
from pathlib import Path


class TalusError(Exception):
    """What is wrong, in one sentence: file, key, value and what is allowed."""


class InputError(TalusError, ValueError):
    """An argument, the scene or a file it names."""


class FaultError(TalusError):
    """A step cannot be trusted; the simulation is as that step left it."""


class Error(ctypes.Structure):
    _fields_ = [("code", c_int), ("text", ctypes.c_char * 2000)]


class Grid(ctypes.Structure):
    _fields_ = [
        ("x_min", c_double), ("y_min", c_double), ("cell", c_double), ("columns", c_int32), ("rows", c_int32),
    ]  # fmt: skip


class Building(ctypes.Structure):
    _fields_ = [("name", c_char_p), ("x_y", POINTER(c_double)), ("point_count", c_size_t), ("height", c_double)]


class Arrays(ctypes.Structure):
    _fields_ = [
        ("crs", c_char_p), ("grid", Grid), ("elevation", POINTER(c_float)), ("release", POINTER(c_float)),
        ("buildings", POINTER(Building)), ("building_count", c_size_t),
    ]  # fmt: skip


class Debris(ctypes.Structure):
    _fields_ = [
        ("count", c_size_t), *((name, POINTER(c_float)) for name in ("x", "y", "z", "vx", "vy", "vz")),
        ("id", POINTER(c_uint32)), ("held", POINTER(c_uint8)),
    ]  # fmt: skip


class Map(ctypes.Structure):
    _fields_ = [("grid", Grid), ("values", POINTER(c_float))]


class Front(ctypes.Structure):
    _fields_ = [
        ("count", c_size_t), ("chainage", POINTER(c_double)), ("arrival_time", POINTER(c_double)),
        ("velocity", POINTER(c_double)),
    ]  # fmt: skip


class Structure(ctypes.Structure):
    _fields_ = [
        ("name", c_char_p), ("hit", c_int), ("is_barrier", c_int), ("first_hit_time", c_double),
        ("failure_time", c_double), ("peak_force", c_double), ("peak_impact_pressure", c_double),
        ("peak_depth", c_double), ("impulse", c_double),
    ]  # fmt: skip


_simulation = c_void_p
_error = POINTER(Error)
_settings = [POINTER(c_char_p), c_size_t]

# name: result, arguments
_functions = {
    "talus_version": (c_char_p, []),
    "talus_open": (c_int, [c_char_p, *_settings, POINTER(_simulation), _error]),
    "talus_open_arrays": (c_int, [POINTER(Arrays), c_char_p, *_settings, POINTER(_simulation), _error]),
    "talus_open_saved": (c_int, [c_char_p, POINTER(_simulation), _error]),
    "talus_save": (c_int, [_simulation, c_char_p, _error]),
    "talus_close": (None, [_simulation]),
    "talus_step": (c_int, [_simulation, c_uint64, _error]),
    "talus_advance": (c_int, [_simulation, c_double, _error]),
    "talus_get_phase": (c_int, [_simulation]),
    "talus_message": (c_char_p, [_simulation]),
    "talus_time": (c_double, [_simulation]),
    "talus_steps": (c_uint64, [_simulation]),
    "talus_hash": (c_uint64, [_simulation]),
    "talus_origin": (None, [_simulation, POINTER(c_double)]),
    "talus_particle_volume": (c_double, [_simulation]),
    "talus_get_debris": (Debris, [_simulation]),
    "talus_get_map": (c_int, [_simulation, c_char_p, POINTER(Map), _error]),
    "talus_get_front": (Front, [_simulation]),
    "talus_structure_count": (c_size_t, [_simulation]),
    "talus_get_structure": (c_int, [_simulation, c_size_t, POINTER(Structure), _error]),
    "talus_set": (c_int, [_simulation, c_char_p, c_double, _error]),
    "talus_apply": (c_int, [_simulation, c_char_p, POINTER(c_char_p), _error]),
    "talus_get_json": (c_int, [_simulation, c_char_p, POINTER(c_char_p), _error]),
    "talus_write_results": (c_int, [_simulation, c_char_p, _error]),
}


def _load() -> ctypes.CDLL:
    name = "libtalus.so.0"
    # Installed together: PREFIX/lib/python3/dist-packages/talus and PREFIX/lib/<...>/libtalus.so.0.
    for folder in Path(__file__).resolve().parents:
        if folder.name in ("lib", "lib64"):
            for candidate in (folder / name, *folder.glob(f"*/{name}")):
                if candidate.exists():
                    return ctypes.CDLL(str(candidate))
    try:
        return ctypes.CDLL(name)
    except OSError as error:
        raise ImportError(f"{name} is not found; install talus, or name its folder in LD_LIBRARY_PATH") from error


library = _load()
for _name, (_result, _arguments) in _functions.items():
    _function = getattr(library, _name)
    _function.restype = _result
    _function.argtypes = _arguments


def call(name: str, *arguments: object) -> None:
    """Calls a function whose last argument is a talus_error; raises what it says."""
    error = Error()
    code = getattr(library, name)(*arguments, ctypes.byref(error))
    if code == 0:
        return
    text = error.text.decode(errors="replace")
    raise {2: InputError, 3: FaultError}.get(code, TalusError)(text)
