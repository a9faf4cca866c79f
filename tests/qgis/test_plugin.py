"""The plugin for QGIS on the program that was built: by qgis_process, as QGIS itself runs it, and inside this process
where a project is looked at. PATH has talus; scripts/test.sh qgis sets what else is needed."""

import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import threading
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PLUGINS = ROOT / "qgis"
FOLDER = pathlib.Path(tempfile.mkdtemp(prefix="talus_qgis_"))
os.environ.update(
    QT_QPA_PLATFORM="offscreen", QGIS_CUSTOM_CONFIG_PATH=str(FOLDER / "profile"), QGIS_PLUGINPATH=str(PLUGINS),
    HOME=str(FOLDER), XDG_RUNTIME_DIR=str(FOLDER),
)  # fmt: skip
os.chmod(FOLDER, 0o700)

import sys

sys.path += [str(PLUGINS), "/usr/share/qgis/python/plugins"]

import numpy as np
from osgeo import gdal, ogr, osr
from qgis.core import (
    QgsApplication,
    QgsDateTimeRange,
    QgsLayerDefinition,
    QgsProcessingContext,
    QgsProcessingException,
    QgsProcessingFeedback,
    QgsProcessingFeatureSourceDefinition,
    QgsProcessingOutputRasterLayer,
    QgsProject,
    QgsRasterLayer,
    QgsVectorLayer,
)
from qgis.PyQt.QtCore import QDateTime, Qt

gdal.UseExceptions()
application = QgsApplication([], False)
application.initQgis()
import processing
from processing.core.Processing import Processing
from processing.core.ProcessingConfig import ProcessingConfig
from talus_processing import classFactory
from talus_processing.program import SETTING

Processing.initialize()
plugin = classFactory(None)
plugin.initProcessing()

QUICK = "solver.end_time_s=6\nsolver.thread_count=2"


def tearDownModule():
    shutil.rmtree(FOLDER)


def write_slope():
    """A slope of 1 : 2 that falls to the east, release areas of which the second is not to be used, and a house."""
    rows, columns = 30, 60
    raster = gdal.GetDriverByName("GTiff").Create(str(FOLDER / "dem.tif"), columns, rows, 1, gdal.GDT_Float32)
    raster.SetGeoTransform((800000, 1, 0, 820000 + rows, 0, -1))
    reference = osr.SpatialReference()
    reference.ImportFromEPSG(32650)
    raster.SetProjection(reference.ExportToWkt())
    elevation = np.tile(200 - 0.5 * np.arange(columns), (rows, 1))
    raster.GetRasterBand(1).WriteArray(elevation)
    raster = None
    boxes = {"scars": [(5, 10, 15, 20), (5, 1, 8, 3)], "houses": [(40, 12, 46, 18)]}
    for name, places in boxes.items():
        write_boxes(f"{name}.gpkg", name, places)
    write_boxes("several.gpkg", "old", [(5, 1, 8, 3)])
    write_boxes("several.gpkg", "new", [(5, 10, 15, 20)])


def write_boxes(file, name, places, place=True):
    """A layer of polygons; the first of them is 2 m deep, the others are 1 m. `place`: it states a reference system."""
    reference = osr.SpatialReference() if place else None
    if place:
        reference.ImportFromEPSG(32650)
    there = (FOLDER / file).exists()
    data = ogr.Open(str(FOLDER / file), 1) if there else ogr.GetDriverByName("GPKG").CreateDataSource(str(FOLDER / file))
    layer = data.CreateLayer(name, reference, ogr.wkbPolygon)
    layer.CreateField(ogr.FieldDefn("name", ogr.OFTString))
    for field in ("depth", "thickness_m"):
        layer.CreateField(ogr.FieldDefn(field, ogr.OFTReal))
    for k, (left, below, right, above) in enumerate(places):
        feature = ogr.Feature(layer.GetLayerDefn())
        feature.SetField("name", f"{name} & {left}")
        feature.SetField("depth", 1 if k else 2)
        feature.SetField("thickness_m", 7)
        corners = [(left, below), (right, below), (right, above), (left, above), (left, below)]
        text = ", ".join(f"{800000 + x} {820000 + y}" for x, y in corners)
        feature.SetGeometry(ogr.CreateGeometryFromWkt(f"POLYGON (({text}))"))
        layer.CreateFeature(feature)


write_slope()


def layers(**more):
    return {
        "TERRAIN": str(FOLDER / "dem.tif"), "RELEASE": str(FOLDER / "scars.gpkg"),
        "BUILDINGS": str(FOLDER / "houses.gpkg"), "THICKNESS": 1, "FRICTION": 0.2, "PARTICLES": 500,
        "SETTINGS": QUICK, **more,
    }  # fmt: skip


def new_output(name):
    folder = FOLDER / name
    shutil.rmtree(folder, ignore_errors=True)
    return str(folder)


class Log(QgsProcessingFeedback):
    def __init__(self):
        super().__init__(False)
        self.lines, self.shares = [], []
        self.progressChanged.connect(self.shares.append)

    def pushInfo(self, text):
        self.lines.append(text)

    pushCommandInfo = pushInfo


def run(algorithm, parameters, project=None, log=None):
    context = QgsProcessingContext()
    if project is not None:
        context.setProject(project)
    return processing.run("talus:" + algorithm, parameters, context=context, feedback=log or Log())


def qgis_process(*arguments):
    # Debian's wrapper passes an option of QGIS that qgis_process does not know.
    program = shutil.which("qgis_process.bin") or shutil.which("qgis_process")
    return subprocess.run([program, *arguments], capture_output=True, text=True, timeout=300)


class Command(unittest.TestCase):
    """As QGIS runs it, without a window."""

    @classmethod
    def setUpClass(cls):
        qgis_process("plugins", "enable", "talus_processing")

    def test_runs_layers_and_names_its_results(self):
        parameters = [f"--{name}={value}" for name, value in layers().items() if name != "SETTINGS"]
        output = new_output("by_command")
        ended = qgis_process("--json", "run", "talus:run", *parameters, f"--SETTINGS={QUICK}", f"--OUTPUT={output}")
        self.assertEqual(ended.returncode, 0, ended.stdout + ended.stderr)
        results = json.loads(ended.stdout)["results"]
        self.assertTrue(QgsRasterLayer(results["PEAK_DEPTH"]).isValid())
        impacts = QgsVectorLayer(results["BUILDING_IMPACT"])
        self.assertEqual([f["hit"] for f in impacts.getFeatures()], ["yes"])
        self.assertTrue(os.path.getsize(results["REPORT"]) > 0)

    def test_passes_on_what_the_program_says(self):
        parameters = [f"--{name}={value}" for name, value in layers(SETTINGS="material.viscosity=-1").items()]
        ended = qgis_process("run", "talus:run", *parameters, "--OUTPUT=" + new_output("refused"))
        self.assertNotEqual(ended.returncode, 0)
        self.assertIn("material.viscosity=-1", ended.stdout + ended.stderr)


class Plugin(unittest.TestCase):
    def test_opens_results_as_a_styled_group_on_top(self):
        project, log = QgsProject(), Log()
        dem = QgsRasterLayer(str(FOLDER / "dem.tif"), "dem")
        project.addMapLayer(dem)
        scars = QgsVectorLayer(str(FOLDER / "scars.gpkg"), "scars")
        project.addMapLayer(scars)
        scars.selectByExpression("\"name\" = 'scars & 5'", QgsVectorLayer.SetSelection)
        chosen = QgsProcessingFeatureSourceDefinition(scars.id(), selectedFeaturesOnly=True)
        output = new_output("group")
        run("run", layers(TERRAIN=dem, RELEASE=chosen, OUTPUT=output), project, log)
        group = project.layerTreeRoot().children()[0]
        self.assertEqual(group.name(), "scars")
        names = [node.name() for node in group.children()]
        self.assertEqual(
            names,
            ["Chainage, m", "Flow path", "Buildings", "Release", "Deposit", "Inundation", "Intensity zones",
             "Peak depth", "Peak speed", "Peak dynamic pressure", "Arrival time", "Deposit depth", "Intensity",
             "Terrain, hillshade"],
        )  # fmt: skip
        opened = {node.name(): node.layer() for node in group.children()}
        self.assertTrue(all(layer.isValid() for layer in opened.values()))
        self.assertEqual({layer.crs().authid() for layer in opened.values()}, {"EPSG:32650"})
        self.assertEqual(opened["Peak depth"].renderer().type(), "singlebandpseudocolor")
        self.assertEqual(opened["Intensity"].renderer().type(), "paletted")
        self.assertEqual(opened["Buildings"].renderer().classAttribute(), "intensity")
        self.assertTrue(opened["Buildings"].labelsEnabled())
        self.assertTrue(log.shares)  # a run of less than half a second tells its progress once
        self.assertLessEqual(max(log.shares), 100)

    def test_definition_opens_where_the_folder_was_moved_to(self):
        output = new_output("here")
        run("run", layers(MODEL=2, OUTPUT=output))
        moved = new_output("there")
        shutil.move(output, moved)
        project = QgsProject()
        loaded, message = QgsLayerDefinition.loadLayerDefinition(moved + "/results.qlr", project, project.layerTreeRoot())
        self.assertTrue(loaded, message)
        for layer in project.mapLayers().values():
            self.assertTrue(layer.isValid() and layer.source().startswith(moved), layer.source())

    def test_opens_maps_over_time_for_the_temporal_controller(self):
        project = QgsProject()
        results = run("run", layers(MODEL=2, SERIES=True, SERIES_INTERVAL=2, OUTPUT=new_output("series")), project)
        (root,) = project.layerTreeRoot().children()
        group = root.findGroup("Depth over time")
        self.assertFalse(group.itemVisibilityChecked())
        opened = [node.layer() for node in group.children()]
        names = [layer.name() for layer in opened]
        self.assertEqual(names[::3], ["6 s", "0 s"])  # between them, the first step after 2 and 4 s
        later = names[2:0:-1]
        self.assertEqual([layer.renderer().band() for layer in opened], [4, 3, 2, 1])
        self.assertEqual({layer.source() for layer in opened}, {results["DEPTH_OVER_TIME"]})
        for second, shown in ((0, "0 s"), (3, later[0]), (5, later[1]), (7, "6 s")):
            begin = QDateTime.fromString(f"2000-01-01T00:00:0{second}Z", Qt.ISODate)
            moment = QgsDateTimeRange(begin, begin.addMSecs(500))
            seen = [la.name() for la in opened if la.temporalProperties().isVisibleInTemporalRange(moment)]
            self.assertEqual(seen, [shown])
        self.assertEqual(QgsRasterLayer(results["SPEED_OVER_TIME"]).bandCount(), 4)

    def test_opens_no_tables_without_features(self):
        project = QgsProject()
        run("run", layers(MODEL=2, BUILDINGS=None, OUTPUT=new_output("no_houses")), project)
        names = {layer.name() for layer in project.mapLayers().values()}
        self.assertNotIn("Buildings", names)
        self.assertIn("Release", names)
        tables = [layer for layer in project.mapLayers().values() if isinstance(layer, QgsVectorLayer)]
        self.assertEqual([table.name() for table in tables if table.featureCount() == 0], [])

    def test_takes_thickness_from_an_attribute(self):
        # Of the slope: sqrt(1.25) m2 per m2 in plan.
        for attribute, volume in (("depth", (2 * 100 + 1 * 6) * 1.25**0.5), ("thickness_m", 7 * 106 * 1.25**0.5)):
            given = {"THICKNESS": None, "THICKNESS_ATTRIBUTE": attribute, "OUTPUT": new_output("attribute")}
            run("run", layers(LOAD=False, MODEL=2, **given))
            totals = json.loads((FOLDER / "attribute/manifest.json").read_text())
            released = totals["results"]["volumes"]["released_m3"]
            self.assertAlmostEqual(released / volume, 1, delta=0.1)

    def test_takes_a_layer_of_a_file_that_has_several(self):
        several = {"RELEASE": str(FOLDER / "several.gpkg"), "OUTPUT": new_output("one_of_several")}
        with self.assertRaisesRegex(
            QgsProcessingException,
            '"Release areas": .*several.gpkg has 2 layers of polygons; '
            'name one in "Layer of the release areas": old, new',
        ):
            run("newscene", layers(**several))
        with self.assertRaisesRegex(QgsProcessingException, "has no layer of polygons odd; it has: old, new"):
            run("newscene", layers(RELEASE_LAYER="odd", **several))
        run("newscene", layers(RELEASE_LAYER="new", **several))
        scars = QgsVectorLayer(several["OUTPUT"] + "_layers/release.gpkg")
        self.assertEqual([f["name"] for f in scars.getFeatures()], ["new & 5"])

    def test_cancelling_keeps_the_results_so_far(self):
        log, output = Log(), new_output("cancelled")
        log.progressChanged.connect(lambda share: log.cancel())
        late = threading.Timer(120, log.cancel)
        late.start()
        run("run", {"SETTINGS": "solver.thread_count=2", "PARTICLES": 3000, "OUTPUT": output}, log=log)
        self.assertTrue(late.is_alive())
        late.cancel()
        self.assertLess(max(log.shares), 90)
        self.assertTrue(os.path.exists(output + "/PARTIAL.txt"))

    def test_second_opinion_opens_a_group_for_each_model(self):
        project, log = QgsProject(), Log()
        results = run("secondopinion", layers(OUTPUT=new_output("both")), project, log)
        groups = project.layerTreeRoot().children()
        self.assertEqual([group.name() for group in groups], ["scars, particles", "scars, depth-averaged"])
        for group in groups:
            opened = {node.name(): node.layer() for node in group.children()}
            self.assertTrue(all(layer.isValid() for layer in opened.values()))
            self.assertEqual(opened["Peak depth"].renderer().type(), "singlebandpseudocolor")
        for name in ("PEAK_DEPTH_PARTICLES", "PEAK_DEPTH_DEPTH_AVERAGED"):
            self.assertTrue(QgsRasterLayer(results[name]).isValid())
        agreement = json.loads(pathlib.Path(results["COMPARISON"]).read_text())["agreement"]
        self.assertGreater(agreement["intersection_over_union"], 0.2)
        self.assertTrue(os.path.getsize(results["REPORT"]) > 0)
        self.assertEqual(log.shares, sorted(log.shares))
        run("secondopinion", layers(OUTPUT=results["OUTPUT"], LOAD=False))  # into the same folder

    def test_makes_a_scene_to_keep_and_checks_it(self):
        scene = run("newscene", {**layers(), "OUTPUT": new_output("scene")})["SCENE"]
        self.assertIn("buildings   1", run("check", {"SCENE": scene})["SUMMARY"])
        with self.assertRaisesRegex(QgsProcessingException, "already there"):
            run("newscene", {**layers(), "OUTPUT": str(FOLDER / "scene")})

    def test_makes_a_scene_in_local_coordinates_where_that_is_said(self):
        bare = FOLDER / "bare.tif"
        memory = gdal.Translate("", str(FOLDER / "dem.tif"), format="MEM")
        memory.SetProjection("")
        gdal.GetDriverByName("GTiff").CreateCopy(str(bare), memory)
        write_boxes("bare.gpkg", "scar", [(5, 10, 15, 20)], place=False)
        flume = dict(layers(), TERRAIN=str(bare), RELEASE=str(FOLDER / "bare.gpkg"), BUILDINGS=None)
        with self.assertRaisesRegex(QgsProcessingException, "states no coordinate reference system"):
            run("newscene", {**flume, "OUTPUT": new_output("flume")})
        scene = run("newscene", {**flume, "LOCAL": True, "OUTPUT": new_output("flume")})["SCENE"]
        self.assertIn('crs = "local"', pathlib.Path(scene).read_text())

    def test_ensemble_opens_odds(self):
        project, output = QgsProject(), new_output("ensemble")
        vary = "material.friction_coefficient=0.15:0.5\n\nmaterial.viscosity=0.05:0.2"
        given = layers(VARY=vary, RUNS=4, RETURN_PERIOD=100, OUTPUT=output)
        given.pop("FRICTION")
        results = run("ensemble", given, project)
        opened = {layer.name(): layer for layer in project.mapLayers().values()}
        self.assertTrue(all(layer.isValid() for layer in opened.values()))
        self.assertEqual(opened["Buildings, probability of a hit"].renderer().classAttribute(), "probability_class")
        self.assertEqual(len(opened), len(project.mapLayers()), "two layers have one name")
        self.assertEqual(opened["Hazard zones"].renderer().type(), "paletted")
        self.assertEqual(opened["Hazard zones, polygons"].renderer().type(), "categorizedSymbol")
        algorithm = QgsApplication.processingRegistry().algorithmById("talus:ensemble")
        declared = {output.name(): output for output in algorithm.outputDefinitions()}
        maps = [name for name in results if isinstance(declared[name], QgsProcessingOutputRasterLayer)]
        for name in ("PROBABILITY_DEPTH_0_5M", "PROBABILITY_SPEED_5MPS", "PEAK_DEPTH_P95", "HAZARD_ZONES"):
            self.assertIn(name, maps)
        self.assertTrue(all(QgsRasterLayer(results[name]).isValid() for name in maps))
        written = {name for name in os.listdir(output) if name.endswith(".tif")}
        self.assertEqual(written, {os.path.basename(results[name]) for name in maps} | {"terrain.tif"})
        zones = QgsVectorLayer(results["ZONES"])
        self.assertEqual(zones.renderer().type(), "categorizedSymbol")
        odds = QgsVectorLayer(results["BUILDING_ODDS"])
        self.assertTrue(odds.isValid())
        (house,) = odds.getFeatures()
        self.assertTrue(0 <= house["probability_hit"] <= 1)
        self.assertEqual(odds.renderer().classAttribute(), "probability_class")  # the style in the GeoPackage
        self.assertTrue(os.path.getsize(results["REPORT"]) > 0)

    def test_calibrates_and_writes_the_best_fit(self):
        settings = QUICK.replace("end_time_s=6", "end_time_s=12")
        given = {"VARY": "material.friction_coefficient=0.15:0.4", "RUNS": 8, "DESIGN": 5, "CHECKS": 2, "PARTICLES": 400}
        log = Log()
        results = run("calibrate", {**given, "SETTINGS": settings, "OUTPUT": new_output("calibration")}, log=log)
        self.assertIn("friction_coefficient", pathlib.Path(results["BEST_FIT"]).read_text())
        self.assertTrue(os.path.getsize(results["REPORT"]) > 0)

    def test_compares_options_and_opens_their_risk(self):
        scene = pathlib.Path(__file__).parents[2] / "examples" / "risk" / "scene.toml"
        output = new_output("options")
        given = {"SCENE": str(scene), "VARY": "material.friction_coefficient=0.15:0.3", "RUNS": 2}
        results = run("options", {**given, "SETTINGS": "solver.end_time_s=40", "OUTPUT": output})
        for name in ("INDIVIDUAL_RISK", "DEBRIS"):
            self.assertTrue(QgsRasterLayer(results[name]).isValid(), name)
        buildings = QgsVectorLayer(results["BUILDING_RISK"])
        self.assertEqual(buildings.renderer().classAttribute(), "individual_risk_class")
        self.assertEqual(buildings.featureCount(), 19)
        self.assertTrue(os.path.exists(os.path.join(output, "options.csv")))

    def test_designs_a_barrier(self):
        scene = pathlib.Path(__file__).parents[2] / "examples" / "risk" / "scene.toml"
        output = new_output("design")
        given = {"SCENE": str(scene), "BARRIER": "gully barrier", "VARY": "material.friction_coefficient=0.1:0.2", "RUNS": 2}
        heights = {"SHARE": 0, "MIN_HEIGHT": 2, "MAX_HEIGHT": 14, "HEIGHT_STEP": 12}
        settings = "solver.end_time_s=40\nrelease.volume_m3=1500\nscene.option=gully barrier"
        results = run("design", {**given, **heights, "SETTINGS": settings, "OUTPUT": output})
        self.assertIn("gully barrier", pathlib.Path(results["REPORT"]).read_text())
        self.assertIn("14", pathlib.Path(results["HEIGHTS"]).read_text())
        self.assertIn("kwan_2012_rigid", pathlib.Path(results["LOADS"]).read_text())
        with self.assertRaisesRegex(QgsProcessingException, "there is no barrier \"dam\""):
            run("design", {**given, "BARRIER": "dam", "SETTINGS": settings, "OUTPUT": new_output("no_design")})

    def test_says_what_is_wrong(self):
        output = {"OUTPUT": new_output("wrong")}
        for given, sentence in (
            ({"TERRAIN": str(FOLDER / "dem.tif")}, "needs a terrain and release areas"),
            (layers(SCENE=str(FOLDER / "scene.toml")), "give one or the other"),
            (layers(SETTINGS="material.colour=1"), "^\"Other values\": material.colour=1: unknown key \"colour\""),
            (layers(FRICTION=20), "^\"Friction coefficient\" = 20 is refused; it must be a number from 0 to 10"),
            (layers(VOLUME=50), "^\"Thickness of the release\" and \"or its volume\" are given; give one"),
            (layers(THICKNESS=None, THICKNESS_ATTRIBUTE="colour"), "\"Release areas\" has no attribute colour;"),
            (layers(THICKNESS=2000), "thickness 2000 is refused"),
            (layers(THREADS=9999), "^\"Threads\" = 9999 is refused"),
        ):
            with self.assertRaisesRegex(QgsProcessingException, sentence):
                run("run", {**given, **output})
        with self.assertRaisesRegex(QgsProcessingException, "give a scene file"):
            run("check", {})

    def test_says_where_the_program_is_missing(self):
        path = os.environ["PATH"]
        try:
            ProcessingConfig.settings[SETTING].value = "/nowhere/talus"  # what was there when it was set
            with self.assertRaisesRegex(QgsProcessingException, "/nowhere/talus: is not a program; Settings"):
                run("check", {"SCENE": "scene.toml"})
            ProcessingConfig.setSettingValue(SETTING, "")
            os.environ["PATH"] = "/nowhere"
            with self.assertRaisesRegex(QgsProcessingException, "was not found"):
                run("check", {"SCENE": "scene.toml"})
            ProcessingConfig.setSettingValue(SETTING, shutil.which("talus", path=path))
            self.assertRaisesRegex(QgsProcessingException, "nowhere.toml", run, "check", {"SCENE": "nowhere.toml"})
        finally:
            os.environ["PATH"] = path
            ProcessingConfig.setSettingValue(SETTING, "")


if __name__ == "__main__":
    unittest.main()
