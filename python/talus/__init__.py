"""Landslides and debris flows on real terrain, with position-based dynamics.

    import talus

    result = talus.run("my_scene/scene.toml", {"material.friction_coefficient": 0.3})
    result.plot()

    simulation = talus.Simulation()          # the scene that comes with talus
    simulation.advance(10)                   # s
    x, y, z = simulation.position            # NumPy

Needs NumPy and libtalus; xarray, geopandas and matplotlib where the methods named after them are used.
"""

from ._library import FaultError, InputError, TalusError, version
from .simulation import UNITS, Building, Front, Map, Phase, Simulation, Structure
from .study import Result, run, study

__version__ = version
__all__ = [
    "UNITS", "Building", "FaultError", "Front", "InputError", "Map", "Phase", "Result", "Simulation", "Structure",
    "TalusError", "run", "study",
]  # fmt: skip
