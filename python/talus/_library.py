"""libtalus as ctypes sees it: the declarations of talus.h, errors as exceptions, and calls that Ctrl-C can end."""

from __future__ import annotations

import concurrent.futures
import ctypes
import threading
from ctypes import POINTER, c_char_p, c_double, c_float, c_int, c_int32, c_size_t, c_uint8, c_uint32, c_uint64, c_void_p
from pathlib import Path
from typing import Any, Callable, Sequence, Tuple

INTERFACE = "0.1"  #: of talus.h that is declared here


class TalusError(Exception):
    """What is wrong, in one sentence: file, key, value and what is allowed."""


class InputError(TalusError, ValueError):
    """An argument, the scene or a file it names."""


class FaultError(TalusError):
    """A step cannot be trusted; the simulation is as that step left it."""


Fields = Sequence[Tuple[str, Any]]  # of a struct, for those who check types


class Sized(ctypes.Structure):
    """A struct that says its size first."""

    _fields_: Fields = [("size", c_size_t)]

    def __init__(self, *values: Any) -> None:
        super().__init__(ctypes.sizeof(type(self)), *values)


class Error(Sized):
    _fields_ = [("code", c_int), ("text", ctypes.c_char * 2000)]


class Grid(ctypes.Structure):
    _fields_ = [
        ("x_min", c_double), ("y_min", c_double), ("cell", c_double), ("columns", c_int32), ("rows", c_int32),
    ]  # fmt: skip


class Building(Sized):
    _fields_ = [("name", c_char_p), ("x_y", POINTER(c_double)), ("point_count", c_size_t), ("height", c_double)]


class Arrays(Sized):
    _fields_ = [
        ("crs", c_char_p), ("grid", Grid), ("elevation", POINTER(c_float)), ("release", POINTER(c_float)),
        ("buildings", POINTER(Building)), ("building_count", c_size_t),
    ]  # fmt: skip


class State(Sized):
    _fields_ = [
        ("phase", c_int32), ("message", c_char_p), ("time", c_double), ("steps", c_uint64), ("origin", c_double * 3),
        ("particle_volume", c_double), ("structure_count", c_uint64),
    ]  # fmt: skip


class Debris(Sized):
    _fields_ = [
        ("count", c_size_t), *((name, POINTER(c_float)) for name in ("x", "y", "z", "vx", "vy", "vz")),
        ("id", POINTER(c_uint32)), ("held", POINTER(c_uint8)),
    ]  # fmt: skip


class Map(Sized):
    _fields_ = [("grid", Grid), ("values", POINTER(c_float))]


class Front(Sized):
    _fields_ = [
        ("count", c_size_t), ("chainage", POINTER(c_double)), ("arrival_time", POINTER(c_double)),
        ("velocity", POINTER(c_double)),
    ]  # fmt: skip


class Structure(Sized):
    _fields_ = [
        ("name", c_char_p), ("hit", c_int32), ("is_barrier", c_int32), ("first_hit_time", c_double),
        ("failure_time", c_double), ("peak_force", c_double), ("peak_impact_pressure", c_double),
        ("peak_depth", c_double), ("impulse", c_double),
    ]  # fmt: skip


_progress_call = ctypes.CFUNCTYPE(c_int, c_void_p, c_double)


class Progress(Sized):
    _fields_ = [("call", _progress_call), ("user", c_void_p)]


_simulation = c_void_p
_error = POINTER(Error)
_watch = POINTER(Progress)
_settings = [POINTER(c_char_p), c_size_t]

# name: arguments; all answer with a code
_functions = {
    "talus_open": [c_char_p, *_settings, _watch, POINTER(_simulation), _error],
    "talus_open_arrays": [POINTER(Arrays), c_char_p, *_settings, _watch, POINTER(_simulation), _error],
    "talus_open_saved": [c_char_p, _watch, POINTER(_simulation), _error],
    "talus_save": [_simulation, c_char_p, _error],
    "talus_step": [_simulation, c_uint64, _watch, _error],
    "talus_advance": [_simulation, c_double, _watch, _error],
    "talus_get_state": [_simulation, POINTER(State), _error],
    "talus_get_hash": [_simulation, POINTER(c_uint64), _error],
    "talus_get_debris": [_simulation, POINTER(Debris), _error],
    "talus_get_map": [_simulation, c_char_p, POINTER(Map), _error],
    "talus_get_front": [_simulation, POINTER(Front), _error],
    "talus_get_structure": [_simulation, c_size_t, POINTER(Structure), _error],
    "talus_set": [_simulation, c_char_p, c_double, _error],
    "talus_apply": [_simulation, c_char_p, POINTER(c_char_p), _error],
    "talus_get_json": [_simulation, c_char_p, POINTER(c_char_p), _error],
    "talus_write_results": [_simulation, c_char_p, _error],
}


def _load() -> ctypes.CDLL:
    name = f"libtalus.so.{INTERFACE}"
    # Installed together: PREFIX/lib/python3/dist-packages/talus and PREFIX/lib/<...>/libtalus.so.0.1.
    here = Path(__file__).resolve()
    if (here.parent / name).exists():  # a wheel has it beside this file
        return ctypes.CDLL(str(here.parent / name))
    for folder in here.parents:
        if folder.name in ("lib", "lib64"):
            for candidate in (folder / name, *folder.glob(f"*/{name}")):
                if candidate.exists():
                    return ctypes.CDLL(str(candidate))
    try:
        return ctypes.CDLL(name)
    except OSError as error:
        raise ImportError(f"{name} is not found; install talus, or name its folder in LD_LIBRARY_PATH") from error


def check_version(found: str) -> None:
    """Refuses a library with another interface than the one declared here."""
    if not found.startswith(INTERFACE + "."):
        raise ImportError(f"libtalus is {found}, and this package is for {INTERFACE}; install both from one version of talus")


library = _load()
library.talus_version.restype = c_char_p
library.talus_version.argtypes = []
version: str = library.talus_version().decode()
check_version(version)
library.talus_close.restype = None
library.talus_close.argtypes = [_simulation]
for _name, _arguments in _functions.items():
    _function = getattr(library, _name)
    _function.restype = c_int
    _function.argtypes = _arguments


def call(name: str, *arguments: object) -> None:
    """Calls a function whose last argument is a talus_error; raises what it says."""
    error = Error()
    code = getattr(library, name)(*arguments, ctypes.byref(error))
    if code == 0:
        return
    text = error.text.decode(errors="replace")
    raise {2: InputError, 3: FaultError}.get(code, TalusError)(text)


def close(simulation: c_void_p) -> None:
    """Frees a simulation; NULL: does nothing."""
    library.talus_close(simulation)


def _until_done(future: concurrent.futures.Future[Any], meanwhile: Callable[[], object] = lambda: None) -> None:
    # Ten times a second: a signal that comes just before a thread begins to wait does not wake it.
    while not concurrent.futures.wait([future], 0.1).done:
        meanwhile()


class Caller:
    """Makes the long calls of a simulation, one after another, on a thread of its own: the thread that waits for them is
    free to see Ctrl-C, or whatever else a signal raises. Then the call is cancelled."""

    _patience = 0.1  # s, that a cancelled call has to end; a later one ends by itself, and the next call waits for it

    def __init__(self) -> None:
        self._threads = concurrent.futures.ThreadPoolExecutor(1, "talus")
        # A signal may come while a call is handed over. The one thread is there from now on, and takes what it is given in
        # turn: whatever of the handing over was done, the next call waits for this one.
        self._last: concurrent.futures.Future[Any] = self._threads.submit(int)  # after a call that was cancelled
        self._last.result()
        self._at_rest = True

    def wait(self) -> None:
        """Until no call is being made."""
        if not self._at_rest:
            turn = self._threads.submit(int)
            # Where the collector finds all this in a cycle, the thread has ended before, with what it was given done.
            while not concurrent.futures.wait([turn], 0.1).done and any(thread.is_alive() for thread in self._threads._threads):
                pass
            self._at_rest = True

    def __call__(
        self,
        work: Callable[[Any], None],
        progress: Callable[[float], object] | None = None,
        abandoned: Callable[[], None] | None = None,
    ) -> None:
        """`work` gets a talus_progress. `progress` is told ten times a second what share is done; what it raises cancels
        the call. `abandoned` is called after a call that was cancelled or has failed."""
        self.wait()
        cancelled = threading.Event()
        share = 0.0

        def tell(_: object, done: float) -> int:
            nonlocal share
            share = done
            return int(cancelled.is_set())

        watch = Progress(_progress_call(tell), None)
        self._at_rest = False
        try:
            future = self._threads.submit(work, ctypes.byref(watch))
            _until_done(future, lambda: progress and progress(share))
            future.result()
            if progress is not None:
                progress(1.0)
        except BaseException:
            cancelled.set()
            after: Callable[[], object] = abandoned or int
            self._last = self._threads.submit(after)
            concurrent.futures.wait([self._last], self._patience)
            raise
        self._at_rest = True

    @property
    def busy(self) -> bool:
        """Whether a call that was cancelled has not ended yet."""
        return not self._last.done()

    def close(self) -> None:
        """Waits for the last call; none can be made any more."""
        self.wait()
        self._threads.shutdown()
