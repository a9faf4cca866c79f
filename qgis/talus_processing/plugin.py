"""What QGIS loads: a provider of algorithms, and its setting."""

import os

from processing.core.ProcessingConfig import ProcessingConfig, Setting
from qgis.core import QgsApplication, QgsProcessingProvider
from qgis.PyQt.QtGui import QIcon

from .algorithms import Calibrate, Check, Design, Ensemble, NewScene, Options, Risk, Run, SecondOpinion
from .program import SETTING


class TalusProvider(QgsProcessingProvider):
    def id(self):
        return "talus"

    def name(self):
        return "talus"

    def longName(self):
        return "talus: landslides and debris flows"

    def icon(self):
        return QIcon(os.path.join(os.path.dirname(__file__), "icon.svg"))

    def load(self):
        ProcessingConfig.settingIcons[self.name()] = self.icon()
        program = Setting(self.name(), SETTING, "Program talus (empty: as installed)", "", valuetype=Setting.FILE)
        ProcessingConfig.addSetting(program)
        ProcessingConfig.readSettings()
        self.refreshAlgorithms()
        return True

    def unload(self):
        ProcessingConfig.removeSetting(SETTING)

    def loadAlgorithms(self):
        for algorithm in (Run, Check, NewScene, SecondOpinion, Ensemble, Calibrate, Risk, Options, Design):
            self.addAlgorithm(algorithm())


class TalusPlugin:
    def __init__(self):
        self.provider = None

    def initProcessing(self):
        self.provider = TalusProvider()
        QgsApplication.processingRegistry().addProvider(self.provider)

    def initGui(self):
        self.initProcessing()

    def unload(self):
        QgsApplication.processingRegistry().removeProvider(self.provider)
