"""What all algorithms on a scene have in common: the scene as a file or as layers, its settings, and its results."""

import os
import re
import tempfile

from qgis.core import (
    QgsFeatureSink,
    QgsLayerDefinition,
    QgsProcessing,
    QgsProcessingAlgorithm,
    QgsProcessingException,
    QgsProcessingOutputHtml,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterDefinition,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterFile,
    QgsProcessingParameterFolderDestination,
    QgsProcessingParameterNumber,
    QgsProcessingParameterRasterLayer,
    QgsProcessingParameterString,
    QgsProcessingUtils,
    QgsProviderRegistry,
    QgsVectorFileWriter,
)

from .program import run_program


def number(name, text, whole=False, least=0.0):
    kind = QgsProcessingParameterNumber.Integer if whole else QgsProcessingParameterNumber.Double
    return QgsProcessingParameterNumber(name, text, kind, optional=True, minValue=least)


#: Options of the program whose names have a unit.
OPTIONS = {"THICKNESS": "--thickness-m", "VOLUME": "--volume-m3"}
#: Parameters that are keys of the scene.
KEYS = {
    "FRICTION": "material.friction_coefficient",
    "TURBULENT_FRICTION": "material.turbulent_friction_mps2",
    "PARTICLES": "solver.target_particle_count",
}


def lines_of(text):
    return [line.strip() for line in text.splitlines() if line.strip()]


class TalusAlgorithm(QgsProcessingAlgorithm):
    """`NAME`, `TITLE` and `HELP` say which it is."""

    NAME = TITLE = HELP = ""

    def createInstance(self):
        return type(self)()

    def name(self):
        return self.NAME

    def displayName(self):
        return self.TITLE

    def shortHelpString(self):
        return self.HELP

    def add_advanced(self, parameter):
        parameter.setFlags(parameter.flags() | QgsProcessingParameterDefinition.FlagAdvanced)
        self.addParameter(parameter)

    def add_layers(self, optional):
        polygons = [QgsProcessing.TypeVectorPolygon]
        self.addParameter(QgsProcessingParameterRasterLayer("TERRAIN", "Terrain (elevations, m)", optional=optional))
        self.addParameter(QgsProcessingParameterFeatureSource("RELEASE", "Release areas", polygons, optional=optional))
        self.addParameter(number("THICKNESS", "Thickness of the release, normal to the slope, m"))
        self.addParameter(number("VOLUME", "or its volume, m3"))
        self.addParameter(QgsProcessingParameterFeatureSource("BUILDINGS", "Buildings", polygons, optional=True))

    def add_scene(self):
        self.addParameter(QgsProcessingParameterFile("SCENE", "Scene file", extension="toml", optional=True))
        self.add_layers(optional=True)
        self.addParameter(number("FRICTION", "Friction coefficient (mu)"))
        self.addParameter(number("TURBULENT_FRICTION", "Turbulent friction (xi), m/s2"))
        self.addParameter(number("PARTICLES", "Number of particles; more are finer and slower", whole=True, least=1))
        self.addParameter(
            QgsProcessingParameterString(
                "SETTINGS", "Other values, a line each: section.key=value", multiLine=True, optional=True
            )
        )

    def add_output(self, title, layers=True):
        self.add_advanced(number("THREADS", "Threads (default: all cores)", whole=True, least=1))
        if layers:
            self.addParameter(QgsProcessingParameterBoolean("LOAD", "Open the results as layers", defaultValue=True))
        self.addParameter(QgsProcessingParameterFolderDestination("OUTPUT", title))
        self.addOutput(QgsProcessingOutputHtml("REPORT", "Report"))

    def option(self, parameters, name, context):
        """The program's option of the same name with the number that was given; nothing where none was."""
        value = self.parameterAsString(parameters, name, context)
        return [OPTIONS.get(name, "--" + name.lower().replace("_", "-")), value] if value else []

    def write_layer(self, parameters, name, folder, context):
        """A layer as a GeoPackage in `folder`: only what is selected, if the user chose that. None: not given."""
        source = self.parameterAsSource(parameters, name, context)
        if source is None:
            return None
        file = os.path.join(folder, name.lower() + ".gpkg")
        options = QgsVectorFileWriter.SaveVectorOptions()
        options.driverName = "GPKG"
        options.layerOptions = ["FID=talus_fid"]  # a column of the layer may be called fid
        writer = QgsVectorFileWriter.create(
            file, source.fields(), source.wkbType(), source.sourceCrs(), context.transformContext(), options
        )
        for feature in source.getFeatures():
            if not writer.addFeature(feature, QgsFeatureSink.FastInsert):
                break
        if writer.hasError() != QgsVectorFileWriter.NoError:
            raise QgsProcessingException(f"{source.sourceName()}: cannot be written for talus: {writer.errorMessage()}")
        del writer  # closes the file
        return file

    def new_scene(self, parameters, folder, context, feedback):
        """Makes a scene of the layers in `folder`, which is not there yet; returns its file."""
        terrain = self.parameterAsRasterLayer(parameters, "TERRAIN", context)
        inputs = folder + "_layers"
        os.makedirs(inputs, exist_ok=True)
        release = self.write_layer(parameters, "RELEASE", inputs, context)
        if terrain is None or release is None:
            raise QgsProcessingException("a scene of layers needs a terrain and release areas")
        if terrain.dataProvider().name() != "gdal":
            raise QgsProcessingException(f"{terrain.name()}: is no raster in a file; save it as a GeoTIFF first")
        dem = QgsProviderRegistry.instance().decodeUri("gdal", terrain.source()).get("path", terrain.source())
        arguments = ["scene", "new", "--dem", dem, "--release", release, "-o", folder]
        buildings = self.write_layer(parameters, "BUILDINGS", inputs, context)
        if buildings:
            arguments += ["--buildings", buildings]
        arguments += self.option(parameters, "THICKNESS", context)
        arguments += self.option(parameters, "VOLUME", context)
        run_program(arguments, feedback)
        return os.path.join(folder, "scene.toml")

    def scene_arguments(self, parameters, context, feedback):
        """The scene, and the values that are set over its own, as the program takes them."""
        file = self.parameterAsFile(parameters, "SCENE", context)
        layers = [name for name in ("TERRAIN", "RELEASE", "BUILDINGS") if parameters.get(name)]
        if file and layers:
            raise QgsProcessingException(f"a scene file and {layers[0].lower()} are given; give one or the other")
        if layers:
            # What belongs to this run alone; the algorithm New scene makes one to keep.
            folder = tempfile.mkdtemp(prefix="talus_", dir=QgsProcessingUtils.tempFolder())
            release = self.parameterAsSource(parameters, "RELEASE", context)
            title = re.sub(r"\W+", "_", release.sourceName()) if release else "scene"
            file = self.new_scene(parameters, os.path.join(folder, title), context, feedback)
        settings = lines_of(self.parameterAsString(parameters, "SETTINGS", context))
        for name, key in KEYS.items():
            value = self.parameterAsString(parameters, name, context)
            if value:
                settings.append(f"{key}={value}")
        arguments = [file] if file else []
        for setting in settings:
            arguments += ["--set", setting]
        return arguments + self.option(parameters, "THREADS", context)

    def output_folder(self, parameters, context):
        folder = self.parameterAsString(parameters, "OUTPUT", context).rstrip("/")
        os.makedirs(os.path.dirname(folder), exist_ok=True)
        return folder

    def postProcessAlgorithm(self, context, feedback):
        """Opens the results as groups, on top of the layers that are there."""
        for title, definition in reversed(getattr(self, "definitions", {}).items()):
            self.open_group(definition, title, context, feedback)
        return {}

    def open_group(self, definition, title, context, feedback):
        """`title`: added to the name of the group; "": nothing is."""
        if context.project() is None or not os.path.exists(definition):
            return
        root = context.project().layerTreeRoot()
        loaded, message = QgsLayerDefinition.loadLayerDefinition(definition, context.project(), root)
        if not loaded:
            feedback.reportError(f"{definition}: {message}")
            return
        group = root.children()[-1]
        if title:
            group.setName(f"{group.name()}, {title}")
        root.insertChildNode(0, group.clone())
        root.removeChildNode(group)
