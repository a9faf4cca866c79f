"""The commands of talus as algorithms."""

import os

from qgis.core import (
    QgsProcessingException,
    QgsProcessingOutputFile,
    QgsProcessingOutputRasterLayer,
    QgsProcessingOutputString,
    QgsProcessingOutputVectorLayer,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterEnum,
    QgsProcessingParameterFolderDestination,
    QgsProcessingParameterString,
)

from .scene_input import TalusAlgorithm, lines_of, number

SCENE_HELP = (
    "The scene is a scene file, or is made of layers: a terrain in a projected reference system in metres, polygons of "
    "the release areas with their thickness (a number, or an attribute of the areas) or volume, and buildings. Without "
    "either it is the one that comes with talus. Values that are left empty are those of the scene."
)

# That every run has, by the names of their files.
MAPS = ["peak_depth", "peak_speed", "peak_pressure", "arrival_time", "deposit_depth"]


class Run(TalusAlgorithm):
    NAME, TITLE = "run", "Run"
    HELP = (
        "Runs a scene and opens maps of peak depth, speed and pressure, arrival time, deposit and intensity, outlines, "
        "and buildings coloured by intensity, on the hillshade of the terrain. Cancelling keeps the results so far.\n\n"
        "Maps over time are groups that are switched off: tick one, and start the Temporal Controller with its full "
        "range. Time 0 is the beginning of the year 2000.\n\n" + SCENE_HELP
    )
    MODELS = ["", "particles", "depth_averaged"]
    MAPS = [*MAPS, "intensity", "terrain"]
    OVER_TIME = ["depth", "speed", "pressure"]

    def initAlgorithm(self, configuration=None):
        self.add_scene()
        models = ["as the scene says", "particles", "depth-averaged: in seconds, without what happens inside"]
        self.addParameter(QgsProcessingParameterEnum("MODEL", "Model", models, defaultValue=0))
        self.addParameter(QgsProcessingParameterBoolean("SERIES", "Also maps over time", defaultValue=False))
        self.add_advanced(number("SERIES_INTERVAL", "Time between maps over time, s (default: 1)"))
        self.add_output("Results")
        for name in self.MAPS:
            title = name.replace("_", " ").capitalize()
            self.addOutput(QgsProcessingOutputRasterLayer(name.upper(), title))
        for name in self.OVER_TIME:
            title = name.capitalize() + " over time, a band per moment"
            self.addOutput(QgsProcessingOutputRasterLayer(name.upper() + "_OVER_TIME", title))
        self.addOutput(QgsProcessingOutputVectorLayer("BUILDING_IMPACT", "Impact on buildings"))

    def processAlgorithm(self, parameters, context, feedback):
        arguments = self.scene_arguments(parameters, context, feedback)
        folder = self.output_folder(parameters, context)
        model = self.MODELS[self.parameterAsEnum(parameters, "MODEL", context)]
        if model:
            arguments += ["--model", model]
        series = self.parameterAsBool(parameters, "SERIES", context)
        if series:
            arguments += ["--series", "geotiff"]
        # talus replaces no folder but one of its own results.
        self.run_talus(["run", *arguments, "--json", "--force", "-o", folder], feedback)
        if self.parameterAsBool(parameters, "LOAD", context):
            self.definitions = {"": os.path.join(folder, "results.qlr")}
        results = {"OUTPUT": folder, "REPORT": os.path.join(folder, "report.html")}
        for name in self.MAPS:
            results[name.upper()] = os.path.join(folder, name + ".tif")
        for name in self.OVER_TIME if series else ():
            results[name.upper() + "_OVER_TIME"] = os.path.join(folder, "series", name + ".tif")
        results["BUILDING_IMPACT"] = os.path.join(folder, "results.gpkg") + "|layername=buildings"
        return results


class SecondOpinion(TalusAlgorithm):
    NAME, TITLE = "secondopinion", "Second opinion"
    HELP = (
        "Runs a scene with particles and with the depth-averaged model, and opens the maps of both as a group each. The "
        "report sets them side by side: affected area, front, run-out, buildings, and where they differ.\n\n" + SCENE_HELP
    )
    MODELS = {"particles": "particles", "depth_averaged": "depth-averaged"}  #: folder, and what its group is called

    def initAlgorithm(self, configuration=None):
        self.add_scene()
        self.add_output("Results")
        for model, title in self.MODELS.items():
            self.addOutput(QgsProcessingOutputRasterLayer("PEAK_DEPTH_" + model.upper(), "Peak depth, " + title))
        self.addOutput(QgsProcessingOutputFile("COMPARISON", "Comparison as JSON"))

    def processAlgorithm(self, parameters, context, feedback):
        arguments = self.scene_arguments(parameters, context, feedback)
        folder = self.output_folder(parameters, context)
        self.run_talus(["compare", *arguments, "--json", "--force", "-o", folder], feedback)
        if self.parameterAsBool(parameters, "LOAD", context):
            self.definitions = {title: os.path.join(folder, model, "results.qlr") for model, title in self.MODELS.items()}
        results = {"OUTPUT": folder, "REPORT": os.path.join(folder, "report.html")}
        for model in self.MODELS:
            results["PEAK_DEPTH_" + model.upper()] = os.path.join(folder, model, "peak_depth.tif")
        results["COMPARISON"] = os.path.join(folder, "results.json")
        return results


class Check(TalusAlgorithm):
    NAME, TITLE = "check", "Check"
    HELP = "Reads a scene with all its inputs and summarises it, without running it.\n\n" + SCENE_HELP

    def initAlgorithm(self, configuration=None):
        self.add_scene()
        self.addOutput(QgsProcessingOutputString("SUMMARY", "Summary"))

    def processAlgorithm(self, parameters, context, feedback):
        arguments = self.scene_arguments(parameters, context, feedback)
        if not arguments or arguments[0] == "--set":
            raise QgsProcessingException("give a scene file, or a terrain and release areas")
        return {"SUMMARY": self.run_talus(["scene", "check", *arguments], feedback)}


class NewScene(TalusAlgorithm):
    NAME, TITLE = "newscene", "New scene"
    HELP = (
        "Makes a scene of layers, to be edited, run, varied and calibrated: a folder with the commented scene file, and "
        "one with the layers beside it. The folder must not be there yet."
    )

    def initAlgorithm(self, configuration=None):
        self.add_layers(optional=False)
        self.addParameter(QgsProcessingParameterFolderDestination("OUTPUT", "Folder for the scene"))
        self.addOutput(QgsProcessingOutputFile("SCENE", "Scene file"))

    def processAlgorithm(self, parameters, context, feedback):
        folder = self.output_folder(parameters, context)
        return {"OUTPUT": folder, "SCENE": self.new_scene(parameters, folder, context, feedback)}


class ManyRuns(TalusAlgorithm):
    """An algorithm over values that vary."""

    def add_factors(self, title, runs):
        self.addParameter(QgsProcessingParameterString("VARY", title, multiLine=True))
        self.addParameter(number("RUNS", f"Runs at most (default: {runs})", whole=True, least=1))

    def factor_arguments(self, parameters, context):
        arguments = []
        for factor in lines_of(self.parameterAsString(parameters, "VARY", context)):
            arguments += ["--vary", factor]
        return arguments + self.option(parameters, "RUNS", context)

    def run_many(self, command, arguments, folder, feedback):
        self.run_talus([command, *arguments, "--json", "-o", folder], feedback)
        return {"OUTPUT": folder, "REPORT": os.path.join(folder, "report.html")}


class Ensemble(ManyRuns):
    NAME, TITLE = "ensemble", "Ensemble"
    HELP = (
        "Runs a scene many times with varied values and opens maps of probabilities and percentiles, and buildings "
        "coloured by the probability of a hit. What varies is a line each, such as\n"
        "material.friction_coefficient=0.2:0.5\nrelease.volume_m3=log:300:1200\nmaterial.viscosity=normal:0.1:0.02\n"
        "The same folder resumes where an earlier call stopped.\n\n" + SCENE_HELP
    )
    THRESHOLDS = {"depth": ("m", [0.1, 0.5, 1]), "speed": ("mps", [5, 10]), "pressure": ("kPa", [15, 30])}
    UNITS = {"mps": "m/s"}
    PERCENTILES = {"05": "5th", "50": "50th", "95": "95th"}
    DESIGNS = ["latin_hypercube", "monte_carlo", "sobol", "grid", "saltelli", "morris"]

    def initAlgorithm(self, configuration=None):
        self.add_scene()
        self.add_factors("What varies, a line each: section.key=low:high", 64)
        self.addParameter(QgsProcessingParameterEnum("DESIGN", "Design", self.DESIGNS, defaultValue=0))
        self.addParameter(number("RETURN_PERIOD", "Return period of the event, years: maps hazard zones"))
        self.add_advanced(number("SEED", "Seed of the design", whole=True))
        self.add_output("Results")
        for name, (_, title) in self.maps().items():
            self.addOutput(QgsProcessingOutputRasterLayer(name, title))
        self.addOutput(QgsProcessingOutputVectorLayer("BUILDING_ODDS", "Buildings, probability of a hit"))
        self.addOutput(QgsProcessingOutputVectorLayer("ZONES", "Hazard zones, polygons"))

    def maps(self):
        """File and title of every map, by the name of its output."""
        maps = {}
        for quantity, (unit, values) in self.THRESHOLDS.items():
            for value in values:
                name = f"probability_{quantity}_{value:g}{unit}"
                title = f"Probability of {quantity} over {value:g} {self.UNITS.get(unit, unit)}"
                maps[name.replace(".", "_").upper()] = (name, title)
        for intensity in ("low", "medium", "high"):
            name = f"probability_intensity_{intensity}"
            higher = "" if intensity == "high" else " or higher"
            maps[name.upper()] = (name, f"Probability of {intensity} intensity{higher}")
        for quantity in MAPS:
            for level, words in self.PERCENTILES.items():
                name = f"{quantity}_p{level}"
                maps[name.upper()] = (name, f"{quantity.replace('_', ' ').capitalize()}, {words} percentile")
        maps["HAZARD_ZONES"] = ("hazard_zones", "Hazard zones")
        return maps

    def processAlgorithm(self, parameters, context, feedback):
        arguments = self.scene_arguments(parameters, context, feedback) + self.factor_arguments(parameters, context)
        arguments += ["--design", self.DESIGNS[self.parameterAsEnum(parameters, "DESIGN", context)]]
        for name in ("RETURN_PERIOD", "SEED"):
            arguments += self.option(parameters, name, context)
        for quantity, (unit, values) in self.THRESHOLDS.items():  # those that the outputs name
            arguments += [f"--{quantity}-{unit}", ",".join(f"{value:g}" for value in values)]
        folder = self.output_folder(parameters, context)
        results = self.run_many("ensemble", arguments, folder, feedback)
        # Zones need a return period, intensities depend on the guideline, and where no run comes there are no maps.
        files = {name: file + ".tif" for name, (file, _) in self.maps().items()}
        files.update({"BUILDING_ODDS": "buildings.gpkg", "ZONES": "hazard_zones.gpkg"})
        for name, file in files.items():
            if os.path.exists(os.path.join(folder, file)):
                layer = f"|layername={file[:-5]}" if file.endswith(".gpkg") else ""
                results[name] = os.path.join(folder, file) + layer
        if self.parameterAsBool(parameters, "LOAD", context):
            self.definitions = {"": os.path.join(folder, "results.qlr")}
        return results


class Calibrate(ManyRuns):
    NAME, TITLE = "calibrate", "Calibrate"
    HELP = (
        "Finds the values of a scene that explain field observations, with their uncertainty. The scene file states the "
        "observations; without one it is the scene that comes with talus. Free values are a line each, such as\n"
        "material.friction_coefficient=0.1:0.6\nrelease.volume_m3=normal:600:60\n"
        "The report shows the result; the scene with the best values is an output, for the algorithm Run."
    )

    def initAlgorithm(self, configuration=None):
        self.add_scene()
        self.add_factors("Free values, a line each: section.key=low:high", 100)
        self.add_advanced(number("DESIGN", "Runs of the design (default: ten per value)", whole=True, least=3))
        self.add_advanced(number("CHECKS", "Runs that check the result (default: 10)", whole=True))
        self.add_advanced(number("SEED", "Seed of the design and the chains", whole=True))
        self.add_output("Results", layers=False)
        self.addOutput(QgsProcessingOutputFile("BEST_FIT", "Scene with the best values"))

    def processAlgorithm(self, parameters, context, feedback):
        arguments = self.scene_arguments(parameters, context, feedback) + self.factor_arguments(parameters, context)
        for name in ("DESIGN", "CHECKS", "SEED"):
            arguments += self.option(parameters, name, context)
        folder = self.output_folder(parameters, context)
        results = self.run_many("calibrate", arguments, folder, feedback)
        results["BEST_FIT"] = os.path.join(folder, "best_fit", "scene.toml")
        return results


class RiskOf(ManyRuns):
    """Risk of a scene, or options compared: both need a scene file that states events and exposure."""

    MAPS = {"INDIVIDUAL_RISK": ("individual_risk", "Individual risk"), "DEBRIS": ("debris_frequency", "Debris, events per year")}

    def initAlgorithm(self, configuration=None):
        self.add_scene()
        self.add_factors("What varies, a line each: section.key=low:high", 64)
        self.add_advanced(number("SEED", "Seed of the design", whole=True))
        self.add_output("Results")
        for name, (_, title) in self.MAPS.items():
            self.addOutput(QgsProcessingOutputRasterLayer(name, title))
        self.addOutput(QgsProcessingOutputVectorLayer("BUILDING_RISK", "Individual risk in buildings"))

    def processAlgorithm(self, parameters, context, feedback):
        arguments = self.scene_arguments(parameters, context, feedback) + self.factor_arguments(parameters, context)
        arguments += self.option(parameters, "SEED", context)
        folder = self.output_folder(parameters, context)
        results = self.run_many(self.NAME, arguments, folder, feedback)
        # There is no map of individual risk without a curve for it, and none where no run comes.
        for name, (file, _) in self.MAPS.items():
            path = os.path.join(folder, file + ".tif")
            if os.path.exists(path):
                results[name] = path
        if os.path.exists(os.path.join(folder, "risk.gpkg")):
            results["BUILDING_RISK"] = os.path.join(folder, "risk.gpkg") + "|layername=buildings"
        if self.parameterAsBool(parameters, "LOAD", context):
            self.definitions = {"": os.path.join(folder, "results.qlr")}
        return results


class Risk(RiskOf):
    NAME, TITLE = "risk", "Risk"
    HELP = (
        "Counts what is at risk in a year: impact, loss and deaths per building and road, individual risk with a map, and "
        "the F-N curve. The scene file states how often events come ([[risk_scenario]]) and what is exposed ([[exposure]]). "
        "What varies is a line each, such as\nmaterial.friction_coefficient=0.15:0.3\n"
        "The same folder resumes where an earlier call stopped.\n\n" + SCENE_HELP
    )


class Options(RiskOf):
    NAME, TITLE = "options", "Options"
    HELP = (
        "Compares the options of a scene file ([[option]]: barriers, zones and removed buildings) with the ground as it is: "
        "hazard, impact and risk side by side with differences, and cost against risk averted. Every option has the same "
        "draws. What varies is a line each, such as\nmaterial.friction_coefficient=0.15:0.3\n"
        "The same folder resumes where an earlier call stopped.\n\n" + SCENE_HELP
    )


class Design(ManyRuns):
    NAME, TITLE = "design", "Barrier design"
    HELP = (
        "Finds the least height of a barrier of the scene ([[barrier]]) for which at most a share of the runs, or of their "
        "volume, passes, and what it holds and must bear: a design sheet to print. What varies is a line each, such as\nmaterial.friction_coefficient=0.15:0.3\n"
        "The same folder resumes where an earlier call stopped.\n\n" + SCENE_HELP
    )
    OF = ["runs", "volume"]
    CONFIRM = ["none", "particles"]

    def initAlgorithm(self, configuration=None):
        self.add_scene()
        self.addParameter(QgsProcessingParameterString("BARRIER", "Barrier, by its name in the scene"))
        self.add_factors("What varies, a line each: section.key=low:high", 32)
        self.addParameter(number("SHARE", "Share that may pass, 0 to below 1 (default: 0.05)"))
        self.addParameter(QgsProcessingParameterEnum("OF", "Share of", self.OF, defaultValue=0))
        self.addParameter(number("MIN_HEIGHT", "Least height tried, m (default: 1)"))
        self.addParameter(number("MAX_HEIGHT", "Greatest height tried, m (default: 10)"))
        self.add_advanced(number("HEIGHT_STEP", "Step between heights, m (default: 0.5)"))
        lines = "Other lines, one each: NAME=x,y x,y or NAME=FILE"
        self.addParameter(QgsProcessingParameterString("LINE", lines, multiLine=True, optional=True))
        confirm = ["no", "the deciding runs again, with particles"]
        self.addParameter(QgsProcessingParameterEnum("CONFIRM", "Confirm with particles", confirm, defaultValue=0))
        self.add_advanced(number("BOULDER_DIAMETER", "Diameter of a boulder that hits, m"))
        self.add_advanced(number("DEPOSITION_SLOPE", "Slope of debris held behind, degrees (default: half the ground's)"))
        self.add_advanced(number("SEED", "Seed of the design", whole=True))
        self.add_output("Results", layers=False)
        self.addOutput(QgsProcessingOutputFile("HEIGHTS", "Heights and what passes, CSV"))
        self.addOutput(QgsProcessingOutputFile("LOADS", "Loads of published methods, CSV"))

    def processAlgorithm(self, parameters, context, feedback):
        arguments = self.scene_arguments(parameters, context, feedback) + self.factor_arguments(parameters, context)
        arguments += ["--barrier", self.parameterAsString(parameters, "BARRIER", context)]
        arguments += ["--of", self.OF[self.parameterAsEnum(parameters, "OF", context)]]
        arguments += ["--confirm", self.CONFIRM[self.parameterAsEnum(parameters, "CONFIRM", context)]]
        for line in lines_of(self.parameterAsString(parameters, "LINE", context)):
            arguments += ["--line", line]
        for name in ("SHARE", "MIN_HEIGHT", "MAX_HEIGHT", "HEIGHT_STEP", "BOULDER_DIAMETER", "DEPOSITION_SLOPE", "SEED"):
            arguments += self.option(parameters, name, context)
        folder = self.output_folder(parameters, context)
        results = self.run_many("design", arguments, folder, feedback)
        results["REPORT"] = os.path.join(folder, "design.html")
        results["HEIGHTS"] = os.path.join(folder, "heights.csv")
        results["LOADS"] = os.path.join(folder, "loads.csv")
        return results
