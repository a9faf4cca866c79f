"""Landslides and debris flows on real terrain, with position-based dynamics.

    import talus

    result = talus.run("my_scene/scene.toml", {"material.friction_coefficient": 0.3})
    result.plot()

    simulation = talus.Simulation()          # the scene that comes with talus
    simulation.advance(10)                   # s
    x, y, z = simulation.position            # NumPy

Needs NumPy and libtalus, and the program for ensembles and calibrations; xarray, geopandas, pandas and matplotlib where the
methods named after them are used.
"""

from ._library import FaultError, InputError, TalusError, version
from .decisions import Design, Risk, design, options, risk
from .ensembles import Calibration, Ensemble, calibrate, ensemble
from .maps import UNITS, Map, read_geotiff, write_geotiff
from .measures import Energy, Front, Gauge, RunOut, Structure
from .simulation import Building, Phase, Simulation
from .study import Result, Study, run, study
from .table import Table

__version__ = version
__all__ = [
    "UNITS", "Building", "Calibration", "Design", "Energy", "Ensemble", "FaultError", "Front", "Gauge", "InputError", "Map",
    "Phase", "Result", "Risk", "RunOut", "Simulation", "Structure", "Study", "Table", "TalusError", "calibrate", "design",
    "ensemble", "options", "read_geotiff", "risk", "run", "study", "write_geotiff",
]  # fmt: skip
