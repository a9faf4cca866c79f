"""Maps on fixed grids, in other packages' hands and as files."""

import ctypes
import dataclasses
import pathlib
import tempfile
import unittest

import numpy as np

import talus
from talus import _library
from test_talus import needs, open_slope


def small(name="peak_depth", **changed):
    """Four rows of six cells of 2 m; a value missing in the north-east."""
    values = np.arange(24, dtype=np.float32).reshape(4, 6)
    values[3, 5] = np.nan
    return dataclasses.replace(talus.Map(name, values, 100.0, 50.0, 2.0, "EPSG:32650"), **changed)


class GridTest(unittest.TestCase):
    def test_is_cut_and_padded_on_its_own_cells(self):
        given = small()
        placed = given.on_grid((98, 52, 106, 56))
        self.assertEqual((placed.extent, placed.cell), ((98, 52, 106, 56), 2))
        np.testing.assert_array_equal(placed.values[:, 1:], given.values[1:3, :3])
        self.assertTrue(np.isnan(placed.values[:, 0]).all())
        self.assertTrue(np.isnan(given.on_grid((0, 0, 4, 4)).values).all())
        np.testing.assert_array_equal(given.on_grid(given.extent).values, given.values)

    def test_a_larger_cell_has_the_greatest_the_first_or_the_mean(self):
        where = (100, 50, 112, 58), 4
        np.testing.assert_array_equal(small().on_grid(*where).values, [[7, 9, 11], [19, 21, 22]])
        np.testing.assert_array_equal(small("arrival_time").on_grid(*where).values, [[0, 2, 4], [12, 14, 16]])
        deposit = small("deposit_depth")
        coarse = deposit.on_grid(*where)
        np.testing.assert_array_equal(coarse.values[0], [3.5, 5.5, 7.5])
        self.assertAlmostEqual(float(coarse.values.sum()) * 16, float(np.nansum(deposit.values)) * 4, places=3)

    def test_a_layer_of_one_depth_keeps_it_on_cells_of_any_size(self):
        even = small("depth", values=np.full((40, 60), 1.5, np.float32))
        for cell in (2, 3, 5, 7.5):
            inner = even.on_grid((110, 60, 140, 90), cell).values
            np.testing.assert_allclose(inner, 1.5, rtol=1e-6)
        # Beyond its edge there is no debris: of the four cells that would be in one that straddles it, two have any.
        np.testing.assert_allclose(even.on_grid((98, 60, 102, 64), 4).values, [[0.75]])

    def test_cells_half_a_cell_off_have_one_value_each(self):
        even = small("peak_depth", values=np.full((12, 12), 1.5, np.float32), x_min=0, y_min=0, cell=0.1)
        np.testing.assert_array_equal(even.on_grid((0.05, 0.05, 1.15, 1.15)).values, np.full((11, 11), 1.5, np.float32))

    def test_is_that_of_the_library_on_the_same_cells(self):
        on = _library.library.talus_get_map_on
        on.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.POINTER(_library.Grid), ctypes.POINTER(_library.Map), ctypes.c_void_p]
        on.restype = ctypes.c_int
        with open_slope(**{"outputs.map_cell_m": 1}) as simulation:
            simulation.advance(2)
            for name in talus.UNITS:
                own = simulation.map(name)
                west, south, east, north = own.extent
                # Aligned and not; wholes, halves and other parts of its cells; within it and beyond its edges.
                for cell, start in ((1, 0), (1, 0.25), (2, 0), (3, -1.25), (1.5, -4.5), (2.5, 0.3), (0.5, 0), (0.4, -0.7)):
                    columns, rows = int((east - west) / cell) + 4, int((north - south) / cell) + 3
                    x, y = west + start, south + start
                    grid, found = _library.Grid(x, y, cell, columns, rows), _library.Map()
                    self.assertEqual(on(simulation._handle, name.encode(), ctypes.byref(grid), ctypes.byref(found), None), 0)
                    wanted = np.ctypeslib.as_array(found.values, (rows, columns))
                    given = own.on_grid((x, y, x + columns * cell, y + rows * cell), cell).values
                    np.testing.assert_allclose(given, wanted, rtol=1e-5, err_msg=f"{name} on cells of {cell} m from {start} m")

    def test_a_smaller_cell_has_the_value_of_the_one_it_lies_in(self):
        fine = small().on_grid((100, 50, 104, 52), 1).values
        np.testing.assert_array_equal(fine, [[0, 0, 1, 1], [0, 0, 1, 1]])

    def test_a_wrong_grid_is_refused_in_a_sentence(self):
        for extent in ((0, 0, 1), "west", (0, 0, 0, 4), (4, 0, 0, 4), (0, 0, np.nan, 4), None):
            with self.assertRaisesRegex(talus.InputError, "^extent = .*: must be west, south, east|^extent has values"):
                small().on_grid(extent)
        with self.assertRaisesRegex(talus.InputError, "^extent = .*: has 2.5 columns of 2 m; it must have a whole number"):
            small().on_grid((0, 0, 5, 4))
        with self.assertRaisesRegex(talus.InputError, "^cell_m = -1: must be"):
            small().on_grid((0, 0, 4, 4), -1)
        with self.assertRaisesRegex(talus.InputError, "^cell_m = None: must be given with extent"):
            talus.run(extent=(0, 0, 4, 4))
        with self.assertRaisesRegex(talus.InputError, "^cell_m = 2: outputs.map_cell_m is \\[3\\]; give one of them"):
            talus.study(None, {"outputs.map_cell_m": [3]}, {"outputs.map_cell_m": 3}, cell_m=2)

    def test_a_simulation_has_its_maps_on_the_cells_asked_for(self):
        with open_slope(**{"outputs.map_cell_m": 1}) as simulation:
            simulation.advance(2)
            own = simulation.map("peak_depth")
            placed = simulation.map("peak_depth", extent=(np.float32(0), 0, 60, 30), cell_m=np.int64(1))
            self.assertEqual(placed.values.shape, (30, 60))
            self.assertEqual(simulation.extent, placed.extent)
            column, row = int(own.x_min), int(own.y_min)
            rows, columns = own.values.shape
            np.testing.assert_array_equal(placed.values[row : row + rows, column : column + columns], own.values)
            self.assertEqual(np.isfinite(placed.values).sum(), np.isfinite(own.values).sum())
            self.assertEqual(own.crs, "EPSG:32650")


class GeoTiffTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_a_map_is_the_same_when_it_is_read_again(self):
        file = self.folder / "peak_depth.tif"
        for _ in range(2):  # the second replaces the first
            talus.write_geotiff(file, small())
        again = talus.read_geotiff(file)
        np.testing.assert_array_equal(again.values, small().values)
        self.assertEqual(
            (again.name, again.extent, again.cell, again.crs, again.unit),
            ("peak_depth", (100, 50, 112, 58), 2, "EPSG:32650", "m"),
        )
        self.assertEqual([path.name for path in self.folder.iterdir()], ["peak_depth.tif"])

    def test_a_reference_system_may_be_wkt_or_not_known(self):
        local = 'LOCAL_CS["flume",UNIT["metre",1]]'
        for crs in (local, ""):
            talus.write_geotiff(self.folder / "map.tif", small(crs=crs))
            found = talus.read_geotiff(self.folder / "map.tif").crs
            self.assertIn("flume" if crs else "", found)
            self.assertEqual(bool(found), bool(crs))

    @needs("osgeo")
    def test_gdal_finds_it_north_up_with_its_reference_system(self):
        from osgeo import gdal

        gdal.UseExceptions()
        talus.write_geotiff(self.folder / "map.tif", small())
        raster = gdal.Open(str(self.folder / "map.tif"))
        self.assertEqual(raster.GetGeoTransform(), (100, 2, 0, 58, 0, -2))
        self.assertEqual(raster.GetSpatialRef().GetAuthorityCode(None), "32650")
        band = raster.GetRasterBand(1)
        self.assertEqual(band.ReadAsArray()[0, 5], band.GetNoDataValue())
        self.assertEqual((band.ReadAsArray()[3, 0], band.GetUnitType()), (0, "m"))

    def test_what_cannot_be_written_or_read_is_said_in_a_sentence(self):
        nowhere = self.folder / "nowhere" / "map.tif"
        with self.assertRaisesRegex(talus.TalusError, f"^{nowhere}: cannot be written: ") as caught:
            talus.write_geotiff(nowhere, small())
        self.assertNotIn("unfinished", str(caught.exception))
        for wrong in ("EPSG:0", "EPSG", "/etc/passwd", 'PROJCS["cut'):
            with self.assertRaisesRegex(talus.InputError, "^crs = "):
                talus.write_geotiff(self.folder / "map.tif", small(crs=wrong))
        with self.assertRaisesRegex(talus.InputError, "^map = 3: must be a talus.Map"):
            talus.write_geotiff(self.folder / "map.tif", 3)
        self.assertEqual(list(self.folder.iterdir()), [])
        (self.folder / "text.tif").write_text("no raster")
        for name in ("text.tif", "none.tif"):
            with self.assertRaisesRegex(talus.InputError, f"^{self.folder / name}: cannot be read as GeoTIFF: "):
                talus.read_geotiff(self.folder / name)


@needs("xarray")
class XarrayTest(unittest.TestCase):
    def test_has_the_reference_system_where_rioxarray_looks(self):
        array = small().to_xarray()
        self.assertEqual(array.encoding["grid_mapping"], "spatial_ref")
        reference = array.coords["spatial_ref"]
        self.assertEqual(reference.shape, ())
        self.assertTrue(reference.attrs["crs_wkt"].startswith('PROJCRS["WGS 84 / UTM zone 50N"'))
        self.assertEqual(reference.attrs["GeoTransform"], "100.0 2.0 0.0 50.0 0.0 2.0")
        for axis in "xy":
            attributes = array[axis].attrs
            self.assertEqual((attributes["axis"], attributes["units"]), (axis.upper(), "metre"))
            self.assertEqual(attributes["standard_name"], f"projection_{axis}_coordinate")
        np.testing.assert_array_equal(array.x, [101, 103, 105, 107, 109, 111])
        self.assertNotIn("spatial_ref", small(crs="").to_xarray().coords)

    @needs("rioxarray")
    def test_rioxarray_understands_it(self):
        import rioxarray  # noqa: F401

        array = small().to_xarray()
        self.assertEqual(array.rio.crs.to_epsg(), 32650)
        self.assertEqual(array.rio.bounds(), (100, 50, 112, 58))


if __name__ == "__main__":
    unittest.main()
