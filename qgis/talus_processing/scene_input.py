"""What all algorithms on a scene have in common: the scene as a file or as layers, its settings, and its results."""

import os
import re
import tempfile

from qgis.core import (
    QgsFeatureSink,
    QgsField,
    QgsFields,
    QgsLayerDefinition,
    QgsMapLayerType,
    QgsProcessing,
    QgsProcessingAlgorithm,
    QgsProcessingException,
    QgsProcessingFeatureSourceDefinition,
    QgsProcessingOutputHtml,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterDefinition,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterField,
    QgsProcessingParameterFile,
    QgsProcessingParameterFolderDestination,
    QgsProcessingParameterNumber,
    QgsProcessingParameterRasterLayer,
    QgsProcessingParameterString,
    QgsProcessingUtils,
    QgsProviderRegistry,
    QgsVectorFileWriter,
    QgsWkbTypes,
)

from .program import run_program
from .words import in_words_of_dialog


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
    "SERIES_INTERVAL": "outputs.series_interval_s",
}
#: What a scene that is made of layers calls them.
LAYER_KEYS = {
    "TERRAIN": ["--dem", "terrain.file"],
    "RELEASE": ["--release", "release[0].file"],
    "RELEASE_LAYER": ["--release-layer", "release[0].layer"],
    "THICKNESS": ["release[0].thickness_m"],
    "THICKNESS_ATTRIBUTE": ["release[0].thickness_attribute"],
    "VOLUME": ["release[0].volume_m3"],
    "BUILDINGS": ["--buildings", "buildings.file"],
}
#: The attribute in which talus finds the thickness of release areas.
THICKNESS_COLUMN = "thickness_m"


def lines_of(text):
    return [line.strip() for line in text.splitlines() if line.strip()]


class TalusAlgorithm(QgsProcessingAlgorithm):
    """`NAME`, `TITLE` and `HELP` say which it is."""

    NAME = TITLE = HELP = ""

    def __init__(self):
        super().__init__()
        self.named = {}  # what the program calls something: what the dialog does

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
        self.add_advanced(
            QgsProcessingParameterBoolean(
                "LOCAL", "Terrain has local coordinates in metres, as that of a laboratory (no reference system)",
                defaultValue=False,
            )
        )  # fmt: skip
        self.addParameter(QgsProcessingParameterFeatureSource("RELEASE", "Release areas", polygons, optional=optional))
        self.add_advanced(
            QgsProcessingParameterString(
                "RELEASE_LAYER", "Layer of the release areas, where their file has several", optional=True
            )
        )
        self.addParameter(number("THICKNESS", "Thickness of the release, normal to the slope, m"))
        self.addParameter(
            QgsProcessingParameterField(
                "THICKNESS_ATTRIBUTE", "or the attribute of the areas that has it, m", parentLayerParameterName="RELEASE",
                optional=True,
            )
        )  # fmt: skip
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

    def title_of(self, name):
        """What the dialog calls a parameter, without explanations and units."""
        return '"' + re.split(r"[,:;]| \(", self.parameterDefinition(name).description())[0] + '"'

    def run_talus(self, arguments, feedback):
        """Runs the program; what it says is wrong is said in the words of the dialog."""
        named = dict(self.named)
        for parameter in self.parameterDefinitions():
            option = OPTIONS.get(parameter.name(), "--" + parameter.name().lower().replace("_", "-"))
            named.setdefault(option, self.title_of(parameter.name()))
        if "--settings" in named:
            named["--set"] = named["--settings"] + ":"
        try:
            return run_program(arguments, feedback)
        except QgsProcessingException as error:
            raise QgsProcessingException(in_words_of_dialog(str(error), named)) from None

    def one_layer(self, parameters, name, context):
        """The parameters, of which `name` is one layer of polygons: a file may have several."""
        given = parameters.get(name)
        definition = given if isinstance(given, QgsProcessingFeatureSourceDefinition) else None
        file = definition.source.valueAsString(context.expressionContext())[0] if definition else given
        layer = self.parameterAsString(parameters, "RELEASE_LAYER", context) if name == "RELEASE" else ""
        if not isinstance(file, str) or not os.path.exists(file):  # a layer, or a file with the name of its layer
            if layer:
                raise QgsProcessingException(
                    f"{self.title_of('RELEASE_LAYER')}: is for a file; {self.title_of(name)} is a layer"
                )
            return parameters
        found = QgsProviderRegistry.instance().querySublayers(file)
        polygons = {
            part.name(): part.uri() for part in found
            if part.type() == QgsMapLayerType.VectorLayer
            and QgsWkbTypes.geometryType(part.wkbType()) in (QgsWkbTypes.PolygonGeometry, QgsWkbTypes.UnknownGeometry)
        }  # fmt: skip
        names = ", ".join(polygons)
        if layer and layer not in polygons:
            raise QgsProcessingException(
                f"{self.title_of('RELEASE_LAYER')}: {file} has no layer of polygons {layer}; it has: {names}"
            )
        if not layer and len(polygons) > 1:
            where = f"in {self.title_of('RELEASE_LAYER')}" if name == "RELEASE" else "as FILE|layername=NAME"
            raise QgsProcessingException(
                f"{self.title_of(name)}: {file} has {len(polygons)} layers of polygons; name one {where}: {names}"
            )
        if not polygons:
            return parameters  # QGIS says what is wrong with it
        uri = polygons[layer] if layer else next(iter(polygons.values()))
        if definition:
            uri = QgsProcessingFeatureSourceDefinition(uri, definition.selectedFeaturesOnly, definition.featureLimit)
        return {**parameters, name: uri}

    def thickness_column(self, fields, chosen):
        """The fields, of which the chosen one has the name by which talus finds it."""
        at = fields.lookupField(chosen)  # in whatever case
        if at < 0:
            names = ", ".join(field.name() for field in fields)
            raise QgsProcessingException(
                f"{self.title_of('THICKNESS_ATTRIBUTE')}: {self.title_of('RELEASE')} has no attribute {chosen}; "
                f"it has: {names}"
            )
        renamed = QgsFields()
        for k, field in enumerate(fields):
            copy = QgsField(field)
            if k == at:
                copy.setName(THICKNESS_COLUMN)
            elif field.name().lower() == THICKNESS_COLUMN:
                copy.setName(THICKNESS_COLUMN + "_not_used")
            renamed.append(copy)
        return renamed

    def write_layer(self, parameters, name, folder, context):
        """A layer as a GeoPackage in `folder`: only what is selected, if the user chose that. None: not given."""
        if not parameters.get(name):
            return None
        source = self.parameterAsSource(self.one_layer(parameters, name, context), name, context)
        if source is None:
            return None
        fields = source.fields()
        attribute = self.parameterAsString(parameters, "THICKNESS_ATTRIBUTE", context) if name == "RELEASE" else ""
        if attribute:
            fields = self.thickness_column(fields, attribute)
        file = os.path.join(folder, name.lower() + ".gpkg")
        options = QgsVectorFileWriter.SaveVectorOptions()
        options.driverName = "GPKG"
        options.layerOptions = ["FID=talus_fid"]  # a column of the layer may be called fid
        writer = QgsVectorFileWriter.create(
            file, fields, source.wkbType(), source.sourceCrs(), context.transformContext(), options
        )
        for feature in source.getFeatures():
            if not writer.addFeature(feature, QgsFeatureSink.FastInsert):
                break
        if writer.hasError() != QgsVectorFileWriter.NoError:
            raise QgsProcessingException(f"{source.sourceName()}: cannot be written for talus: {writer.errorMessage()}")
        del writer  # closes the file
        self.named[file] = source.sourceName()
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
        one_of = ("THICKNESS", "THICKNESS_ATTRIBUTE", "VOLUME")
        given = [name for name in one_of if self.parameterAsString(parameters, name, context)]
        if len(given) > 1:
            titles = " and ".join(self.title_of(name) for name in given)
            raise QgsProcessingException(f"{titles} are given; give one of them")
        for name, words in LAYER_KEYS.items():
            self.named.update({word: self.title_of(name) for word in words})
        arguments = ["scene", "new", "--dem", dem, "--release", release, "-o", folder]
        if self.parameterAsBool(parameters, "LOCAL", context):
            arguments += ["--crs", "local"]
        buildings = self.write_layer(parameters, "BUILDINGS", inputs, context)
        if buildings:
            arguments += ["--buildings", buildings]
        arguments += self.option(parameters, "THICKNESS", context)
        arguments += self.option(parameters, "VOLUME", context)
        self.run_talus(arguments, feedback)
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
            if self.parameterDefinition(name) is None:
                continue
            value = self.parameterAsString(parameters, name, context)
            if value:
                settings.append(f"{key}={value}")
                self.named[key] = self.title_of(name)
        arguments = [file] if file else []
        for setting in settings:
            arguments += ["--set", setting]
        threads = self.option(parameters, "THREADS", context)
        if threads:
            self.named["solver.thread_count"] = self.title_of("THREADS")
        return arguments + threads

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
