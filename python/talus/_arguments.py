"""Arguments as the library takes them. What is refused is refused in one sentence that names the argument."""

from __future__ import annotations

import json
import math
import operator
import os
from typing import Any, Mapping

import numpy as np

from ._library import InputError


def text(name: str, value: object) -> bytes:
    """A text that C can hold."""
    if not isinstance(value, str):
        raise InputError(f"{name} = {short(value)}: must be a text")
    if "\0" in value:
        raise InputError(f"{name} = {short(value)}: must not hold a NUL character")
    try:
        return value.encode()
    except UnicodeEncodeError:
        raise InputError(f"{name} = {short(value)}: cannot be written as UTF-8") from None


def path(name: str, value: object) -> bytes:
    """The path of a file or folder."""
    try:
        encoded = os.fsencode(value)  # type: ignore[arg-type]
    except (TypeError, UnicodeEncodeError):
        raise InputError(f"{name} = {short(value)}: must be a path") from None
    if not encoded or b"\0" in encoded:
        raise InputError(f"{name} = {short(value)}: must be a path, which is not empty and holds no NUL character")
    return encoded


def count(name: str, value: object, most: int = 2**63) -> int:
    """A whole number, 0 or more."""
    try:
        found = operator.index(value)  # type: ignore[arg-type]
    except TypeError:
        found = -1
    if isinstance(value, (bool, np.bool_)) or not 0 <= found <= most:
        raise InputError(f"{name} = {short(value)}: must be a whole number, 0 to {most}")
    return found


def number(name: str, value: object, *, above: float = -math.inf, most: float = math.inf) -> float:
    """A finite number."""
    try:
        found = math.nan if isinstance(value, (bool, np.bool_, str, bytes)) or np.ndim(value) else float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        found = math.nan
    if not (math.isfinite(found) and above < found <= most):
        limits = f" above {above:g}" if above > -math.inf else ""
        limits += f" and at most {most:g}" if most < math.inf else ""
        raise InputError(f"{name} = {short(value)}: must be a finite number{limits}")
    return found


def time(name: str, value: object) -> float:
    """Simulated time, s."""
    found = number(name, value)
    if found < 0:
        raise InputError(f"{name} = {short(value)}: must be 0 or more")
    return found


def raster(name: str, value: object) -> np.ndarray[Any, np.dtype[np.float32]]:
    """Real numbers in rows and columns."""
    found = _real(name, value)
    if found.ndim != 2:
        raise InputError(f"{name} has shape {found.shape}; it must be (rows, columns)")
    with np.errstate(over="ignore"):  # the library names an infinite value
        return np.ascontiguousarray(found, np.float32)


def outline(name: str, value: object) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Corners (x, y)."""
    found = np.ascontiguousarray(_real(name, value), np.float64)
    if found.ndim != 2 or found.shape[1] != 2 or len(found) < 3:
        raise InputError(f"{name} has shape {found.shape}; it must be at least 3 corners (x, y)")
    if not np.isfinite(found).all():
        raise InputError(f"{name} = {short(value)}: must be finite numbers")
    return found


def grid(extent: object, cell: float) -> tuple[float, float, int, int]:
    """West and south edge, columns and rows of whole cells between the edges of `extent`."""
    edges = np.asarray(_real("extent", extent), np.float64)
    if edges.shape != (4,) or not np.isfinite(edges).all() or not (edges[0] < edges[2] and edges[1] < edges[3]):
        raise InputError(f"extent = {short(extent)}: must be west, south, east and north edge in m, in rising order")
    sizes = []
    for name, low, high in (("columns", edges[0], edges[2]), ("rows", edges[1], edges[3])):
        cells = (high - low) / cell
        if abs(cells - round(cells)) > 1e-6 * max(1.0, cells) or not 1 <= round(cells) <= 2**15:
            raise InputError(
                f"extent = {short(extent)}: has {cells:.6g} {name} of {cell:g} m; it must have a whole number of them, 1 to {2**15}"
            )
        sizes.append(round(cells))
    return float(edges[0]), float(edges[1]), sizes[0], sizes[1]


def settings(given: Mapping[str, object] | None) -> list[bytes]:
    """As for `talus run --set`."""
    if given is None:
        return []
    if not isinstance(given, Mapping):
        raise InputError(f"settings = {short(given)}: must be keys of the scene with their values")
    texts = []
    for key, value in given.items():
        if not isinstance(key, str) or "=" in key:
            raise InputError(f"settings: {short(key)} must be a key of the scene")
        name = f"settings[{key!r}]"
        texts.append(text(name, key) + b"=" + text(name, setting(name, value)))
    return texts


def as_json(name: str, value: object) -> str:
    """JSON; arrays as lists."""
    try:
        return json.dumps(value, allow_nan=False, default=_plain)
    except (TypeError, ValueError, RecursionError):
        raise InputError(f"{name} = {short(value)}: must be texts, finite numbers, and lists or dicts of them") from None


def setting(name: str, value: object) -> str:
    """A value as `--set` takes it."""
    if isinstance(value, str):
        return value
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (int, float, np.integer, np.floating)):
        return str(value)
    if isinstance(value, (list, tuple, np.ndarray)):
        return as_json(name, value)
    raise InputError(f"{name} = {short(value)}: must be a text, a number, true or false, or a list")


def _real(name: str, value: object) -> np.ndarray[Any, Any]:
    if isinstance(value, np.ma.MaskedArray):
        raise InputError(f"{name} is a masked array; fill it first: filled(numpy.nan) where nothing is known")
    try:
        found = np.asarray(value)
    except ValueError:  # lists of unequal lengths
        raise InputError(f"{name} = {short(value)}: must be an array of real numbers") from None
    if found.dtype.kind not in "biuf":
        raise InputError(f"{name} has values of type {found.dtype}; they must be real numbers")
    return found


def _plain(value: object) -> object:
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    raise TypeError


def short(value: object) -> str:
    """What a value looks like in a sentence."""
    shown = " ".join(repr(value).split())
    return shown if len(shown) <= 60 else shown[:57] + "..."
