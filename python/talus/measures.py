"""What a run has measured beside its maps: front, structures, run-out, energy, gauges."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Iterable, Mapping

import numpy as np

if TYPE_CHECKING:
    import numpy.typing as npt

    Numbers = npt.NDArray[np.float64]


@dataclass(frozen=True, repr=False)
class Front:
    """The front along the flow path. NaN: no value."""

    chainage: Numbers  #: m
    arrival_time: Numbers  #: s
    velocity: Numbers  #: m/s

    def __repr__(self) -> str:
        if not len(self.chainage):
            return "<talus.Front: not on the flow path>"
        return f"<talus.Front: chainage {self.chainage[0]:g} to {self.chainage[-1]:g} m, {span(self.velocity)} m/s>"


@dataclass(frozen=True)
class Structure:
    """What debris did to a building or barrier. NaN: it did not happen, or is not measured."""

    name: str
    hit: bool
    is_barrier: bool
    first_hit_time: float  #: s; NaN: not hit
    failure_time: float  #: s; NaN: it did not fail
    peak_force: float  #: N, on all its walls, filtered over outputs.impact_filter_window_s
    peak_impact_pressure: float  #: Pa, of a patch of outputs.impact_patch_edge_m squared, filtered likewise
    peak_depth: float  #: m, of the flow in front of its walls
    impulse: float  #: N s
    peak_speed: float = math.nan  #: m/s, of the flow in front of its walls
    peak_dynamic_pressure: float = math.nan  #: Pa, likewise: density times speed squared
    intensity: str = ""  #: class of outputs.intensity_guideline; "": none
    overtopped_volume: float = math.nan  #: m3, over the crest of a barrier
    first_overtopping_time: float = math.nan  #: s
    passed_volume: float = math.nan  #: m3, through openings and meshes of a barrier
    retained_volume: float = math.nan  #: m3, at rest behind a barrier, now
    peak_filling_height: float = math.nan  #: m, to which a barrier was filled at most


@dataclass(frozen=True)
class RunOut:
    """How far debris came from where it started. NaN: none ran out."""

    along_flow: float  #: m, along the flow
    straight: float  #: m, in a straight line in plan
    at_least: bool  #: debris left the terrain: it ran farther
    toe: tuple[float, float]  #: world position (x, y) of the farthest debris, m
    drop: float  #: m, from the crown to the toe
    runout_angle: float  #: degrees
    travel_angle: float  #: degrees, of the centre of mass
    front_chainage: float  #: m, farthest of the front on the flow path


@dataclass(frozen=True, repr=False)
class Energy:
    """Energy of all debris over time."""

    time: Numbers  #: s
    kinetic: Numbers  #: J
    potential: Numbers  #: J, above sea level

    @property
    def lost(self) -> Numbers:
        """J, since the start. Debris that came, was entrained or left brings or takes its own: then this is no loss."""
        total = self.kinetic + self.potential
        return total[:1] - total

    def __repr__(self) -> str:
        if not len(self.time):
            return "<talus.Energy: no row>"
        return f"<talus.Energy: {len(self.time)} rows to {self.time[-1]:.4g} s, kinetic at most {np.nanmax(self.kinetic):.4g} J>"


@dataclass(frozen=True, repr=False)
class Gauge:
    """Depth and speed of the debris over time at a place."""

    name: str
    x: float  #: m
    y: float  #: m
    time: Numbers  #: s
    depth: Numbers  #: m
    speed: Numbers  #: m/s; NaN: no debris

    def __repr__(self) -> str:
        return f'<talus.Gauge "{self.name}" at ({self.x:.10g}, {self.y:.10g}): depth {span(self.depth)} m>'


def span(values: npt.ArrayLike) -> str:
    """Least and greatest, in words."""
    known = np.asarray(values)[np.isfinite(values)]
    return f"{known.min():.4g} to {known.max():.4g}" if known.size else "no value"


def numbers(values: Iterable[Any]) -> Numbers:
    """Of JSON: null is NaN."""
    return np.array([math.nan if value is None else value for value in values], np.float64)


def with_impacts(structure: Structure, impacts: Mapping[str, Any]) -> Structure:
    """Adds what `impacts` of the library knows of it. Names need not be unique, so a structure is found by what was measured
    on it; two on which all of this is alike were not touched."""
    kind = "barriers" if structure.is_barrier else "buildings"
    hit = None if math.isnan(structure.first_hit_time) else structure.first_hit_time
    wanted = (structure.name, structure.impulse / 1e3, structure.peak_force / 1e3, hit)
    for row in impacts[kind] + [row for row in impacts["removed"] if row["kind"] + "s" == kind]:
        if (row["name"], row["impulse_kNs"], row["peak_force_kN"], row["first_hit_s"]) == wanted:
            return replace(
                structure, peak_speed=_or_nan(row["peak_speed_mps"]),
                peak_dynamic_pressure=_or_nan(row["peak_dynamic_pressure_kPa"]) * 1e3, intensity=row["intensity"] or "",
                overtopped_volume=_or_nan(row.get("overtopped_m3")),
                first_overtopping_time=_or_nan(row.get("first_overtopped_s")), passed_volume=_or_nan(row.get("passed_m3")),
                retained_volume=_or_nan(row.get("retained_m3")), peak_filling_height=_or_nan(row.get("peak_filling_height_m")),
            )  # fmt: skip
    return structure


def _or_nan(value: float | None) -> float:
    return math.nan if value is None else float(value)


def run_out_of(measures: Mapping[str, Any]) -> RunOut:
    """Of "measures" of the library."""
    row = measures["run_out"]
    return RunOut(
        _or_nan(row["run_out_along_flow_m"]), _or_nan(row["run_out_straight_m"]), bool(row["run_out_at_least"]),
        (_or_nan(row["toe_x_m"]), _or_nan(row["toe_y_m"])), _or_nan(row["drop_m"]), _or_nan(row["runout_angle_deg"]),
        _or_nan(row["travel_angle_deg"]), _or_nan(row["front_chainage_m"]),
    )  # fmt: skip


def gauges_of(measures: Mapping[str, Any]) -> list[Gauge]:
    """Likewise."""
    return [
        Gauge(row["name"], row["x_m"], row["y_m"], numbers(row["time_s"]), numbers(row["depth_m"]), numbers(row["speed_mps"]))
        for row in measures["gauges"]
    ]
