#pragma once

// Small rasters and vector files for tests, written with GDAL. Everything returns the path as a string.

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <unistd.h>
#include <utility>
#include <vector>

#include <gdal_priv.h>
#include <ogr_spatialref.h>
#include <ogrsf_frmts.h>

namespace talus::test {

/// A folder of a test's own, deleted with everything in it at the end.
class TemporaryFolder {
  public:
    TemporaryFolder() {
        std::string pattern = (std::filesystem::temp_directory_path() / "talus-test-XXXXXX").string();
        if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot make a temporary folder");
        path_ = pattern;
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    [[nodiscard]] std::string file(const std::string& name) const { return (path_ / name).string(); }

  private:
    std::filesystem::path path_;
};

inline std::string write_text(const std::string& path, const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
    return path;
}

inline std::string read_text(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

/// An EPSG code with x east and y north, whatever order the authority prefers.
inline OGRSpatialReference spatial_reference(int epsg) {
    OGRSpatialReference reference;
    reference.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    if (reference.importFromEPSG(epsg) != OGRERR_NONE) throw std::runtime_error("unknown EPSG code");
    return reference;
}

/// What kind of raster `write_raster` makes. The default is an ordinary float terrain in the Hong Kong 1980 Grid.
struct RasterOptions {
    int columns = 20, rows = 15;
    double x_min = 824000, y_min = 825000;  ///< south-west corner of the south-west cell
    double cell = 5;
    double cell_height = 0;  ///< 0: as `cell`
    double rotation = 0;     ///< put into both off-diagonal terms of the geotransform
    bool south_up = false;
    bool pixel_is_point = false;
    bool georeferenced = true;
    int epsg = 2326;    ///< 0: none
    std::string wkt{};  ///< used instead of `epsg` when not empty
    double nodata = std::numeric_limits<double>::quiet_NaN();
    bool declare_nodata = false;
    GDALDataType type = GDT_Float32;
    double scale = 1, offset = 0;  ///< declared, not applied to the values
    std::string unit{};
    int bands = 1;
    std::string driver = "GTiff";
    std::vector<std::string> creation_options{};
};

/// Writes `value(column, row)` to every band, row 0 in the south.
inline std::string write_raster(const std::string& path, const RasterOptions& options,
                                const std::function<double(int column, int row)>& value) {
    GDALAllRegister();
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(options.driver.c_str());
    if (driver == nullptr) throw std::runtime_error("no such driver: " + options.driver);
    char** creation = nullptr;
    for (const std::string& option : options.creation_options) creation = CSLAddString(creation, option.c_str());

    // Formats that GDAL can only copy into are made by way of memory.
    const bool by_copy = driver->GetMetadataItem(GDAL_DCAP_CREATE) == nullptr;
    GDALDriver* first = by_copy ? GetGDALDriverManager()->GetDriverByName("MEM") : driver;
    GDALDataset* data = first->Create(by_copy ? "" : path.c_str(), options.columns, options.rows, options.bands,
                                      options.type, by_copy ? nullptr : creation);
    if (data == nullptr) throw std::runtime_error("cannot create " + path);

    if (options.pixel_is_point) data->SetMetadataItem(GDALMD_AREA_OR_POINT, GDALMD_AOP_POINT);
    const double height = options.cell_height > 0 ? options.cell_height : options.cell;
    double transform[6] = {options.x_min,    options.cell,
                           options.rotation, options.south_up ? options.y_min : options.y_min + options.rows * height,
                           options.rotation, options.south_up ? height : -height};
    if (options.georeferenced) data->SetGeoTransform(transform);
    OGRSpatialReference reference;
    if (!options.wkt.empty()) {
        reference.importFromWkt(options.wkt.c_str());
        data->SetSpatialRef(&reference);
    } else if (options.epsg != 0) {
        reference = spatial_reference(options.epsg);
        data->SetSpatialRef(&reference);
    }

    std::vector<double> line(static_cast<std::size_t>(options.columns));
    for (int b = 1; b <= options.bands; ++b) {
        GDALRasterBand* band = data->GetRasterBand(b);
        if (options.declare_nodata) band->SetNoDataValue(options.nodata);
        if (options.scale != 1 || options.offset != 0) {
            band->SetScale(options.scale);
            band->SetOffset(options.offset);
        }
        if (!options.unit.empty()) band->SetUnitType(options.unit.c_str());
        for (int y = 0; y < options.rows; ++y) {
            const int row = options.south_up ? y : options.rows - 1 - y;
            for (int x = 0; x < options.columns; ++x) line[static_cast<std::size_t>(x)] = value(x, row);
            if (band->RasterIO(GF_Write, 0, y, options.columns, 1, line.data(), options.columns, 1, GDT_Float64, 0, 0,
                               nullptr) != CE_None) {
                throw std::runtime_error("cannot write " + path);
            }
        }
    }
    if (by_copy) {
        GDALDataset* copy = driver->CreateCopy(path.c_str(), data, FALSE, creation, nullptr, nullptr);
        if (copy == nullptr) throw std::runtime_error("cannot create " + path);
        GDALClose(copy);
    }
    GDALClose(data);
    CSLDestroy(creation);
    return path;
}

/// A plane that falls to the west: 100 m at the western cell centres, `slope` m per m higher to the east.
inline std::string write_plane(const std::string& path, const RasterOptions& options = {}, double slope = 0.5) {
    return write_raster(path, options, [&](int column, int) { return 100 + slope * options.cell * column; });
}

/// A feature for `write_vector`: its geometry as WKT (empty: null) and a text per field (empty: null).
struct VectorFeature {
    std::string wkt{};
    std::vector<std::string> values{};
};

struct VectorOptions {
    std::string driver = "GeoJSON";  ///< "GPKG", "ESRI Shapefile", ...
    std::string layer = "layer";
    int epsg = 2326;                                             ///< 0: none
    std::vector<std::pair<std::string, OGRFieldType>> fields{};  ///< name and type
    bool append = false;                                         ///< add a layer to an existing file
    OGRwkbGeometryType type = wkbUnknown;
};

/// Writes a layer; coordinates are x east, y north in the CRS of the options.
inline std::string write_vector(const std::string& path, const VectorOptions& options,
                                const std::vector<VectorFeature>& features) {
    GDALAllRegister();
    GDALDataset* data = nullptr;
    if (options.append) {
        data = GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_UPDATE);
    } else {
        GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(options.driver.c_str());
        if (driver == nullptr) throw std::runtime_error("no such driver: " + options.driver);
        data = driver->Create(path.c_str(), 0, 0, 0, GDT_Unknown, nullptr);
    }
    if (data == nullptr) throw std::runtime_error("cannot create " + path);
    OGRSpatialReference reference;
    if (options.epsg != 0) reference = spatial_reference(options.epsg);
    OGRLayer* layer = data->CreateLayer(options.layer.c_str(), options.epsg != 0 ? &reference : nullptr, options.type);
    if (layer == nullptr) throw std::runtime_error("cannot create a layer in " + path);
    for (const auto& [name, type] : options.fields) {
        OGRFieldDefn field(name.c_str(), type);
        layer->CreateField(&field);
    }
    for (const VectorFeature& f : features) {
        OGRFeature feature(layer->GetLayerDefn());
        if (!f.wkt.empty()) {
            OGRGeometry* geometry = nullptr;
            if (OGRGeometryFactory::createFromWkt(f.wkt.c_str(), nullptr, &geometry) != OGRERR_NONE) {
                throw std::runtime_error("bad WKT: " + f.wkt);
            }
            feature.SetGeometryDirectly(geometry);
        }
        for (std::size_t i = 0; i < f.values.size(); ++i) {
            if (!f.values[i].empty()) feature.SetField(static_cast<int>(i), f.values[i].c_str());
        }
        if (layer->CreateFeature(&feature) != OGRERR_NONE) throw std::runtime_error("cannot write to " + path);
    }
    GDALClose(data);
    return path;
}

/// WKT of a rectangle.
inline std::string rectangle_wkt(double x_min, double y_min, double x_max, double y_max) {
    std::ostringstream text;
    text.precision(12);
    text << "POLYGON ((" << x_min << ' ' << y_min << ", " << x_max << ' ' << y_min << ", " << x_max << ' ' << y_max
         << ", " << x_min << ' ' << y_max << ", " << x_min << ' ' << y_min << "))";
    return text.str();
}

}  // namespace talus::test
