"""Algorithms of the Processing toolbox on the program talus. Licence: Apache 2.0."""


def classFactory(iface):
    from .plugin import TalusPlugin

    return TalusPlugin()
