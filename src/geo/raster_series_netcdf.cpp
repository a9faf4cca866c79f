#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "core/try.hpp"
#include "geo/gdal.hpp"
#include "geo/raster_series.hpp"
#include "geo/spatial_reference.hpp"

// Eaton, B. et al. (2020): NetCDF Climate and Forecast (CF) Metadata Conventions, version 1.8. Its table of standard
// names has none for depth, speed and pressure of debris.
namespace talus::geo {
namespace {

using Dimensions = std::vector<std::shared_ptr<GDALDimension>>;

const GDALExtendedDataType& number() {
    static const GDALExtendedDataType type = GDALExtendedDataType::Create(GDT_Float64);
    return type;
}

std::vector<double> centres(double first, double cell, int count) {
    std::vector<double> values(static_cast<std::size_t>(count));
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = first + (static_cast<double>(k) + 0.5) * cell;
    return values;
}

/// Empty: it cannot be written so.
std::string wkt2_of(const OGRSpatialReference& reference) {
    const char* const options[] = {"FORMAT=WKT2_2019", nullptr};
    char* wkt = nullptr;
    const bool exported = reference.exportToWkt(&wkt, options) == OGRERR_NONE;
    std::string text = exported ? wkt : "";
    CPLFree(wkt);
    return text;
}

/// A file being written. After the first failure, which GDAL reports, nothing more is written.
class NetcdfFile {
  public:
    explicit NetcdfFile(const std::string& file) {
        GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("netCDF");
        if (driver == nullptr) {
            CPLError(CE_Failure, CPLE_AppDefined, "this GDAL has no netCDF driver");
            return;
        }
        CPLStringList options;
        options.SetNameValue("FORMAT", "NC4");
        data_.reset(driver->CreateMultiDimensional(file.c_str(), nullptr, options.List()));
        if (data_) root_ = data_->GetRootGroup();
    }

    explicit operator bool() const { return root_ != nullptr; }

    std::shared_ptr<GDALDimension> dimension(const std::string& name, std::size_t size) {
        return root_->CreateDimension(name, "", "", size, nullptr);
    }
    /// A coordinate along a dimension of its name.
    bool coordinate(const std::shared_ptr<GDALDimension>& along, const std::vector<double>& values,
                    const std::vector<std::pair<const char*, std::string>>& attributes) {
        if (!along) return false;
        const auto array = root_->CreateMDArray(along->GetName(), {along}, number(), nullptr);
        if (!array || !write_attributes(*array, attributes)) return false;
        const GUInt64 start = 0;
        const std::size_t count = values.size();
        return array->Write(&start, &count, nullptr, nullptr, number(), values.data());
    }
    /// A compressed array of floats in a reference system, in chunks of a frame.
    std::shared_ptr<GDALMDArray> map(const std::string& name, const Dimensions& dimensions, const std::string& unit,
                                     const OGRSpatialReference& reference,
                                     const std::vector<std::pair<const char*, std::string>>& attributes) {
        std::string chunk;
        for (const auto& dimension : dimensions) {
            const bool time = dimensions.size() == 3 && dimension == dimensions.front();
            chunk += fmt::format("{}{}", chunk.empty() ? "" : ",", time ? 1 : dimension->GetSize());
        }
        CPLStringList options;
        options.SetNameValue("COMPRESS", "DEFLATE");
        options.SetNameValue("ZLEVEL", "4");
        options.SetNameValue("BLOCKSIZE", chunk.c_str());
        auto array = root_->CreateMDArray(name, dimensions, GDALExtendedDataType::Create(GDT_Float32), options.List());
        if (!array) return nullptr;
        // The conventions describe systems on the globe alone: with a local one there are just metres.
        const bool on_globe = reference.IsEmpty() == 0 && reference.IsLocal() == 0;
        if (on_globe && !refer(*array, reference)) return nullptr;
        const bool described =
            array->SetNoDataValue(std::nan("")) && array->SetUnit(unit) && write_attributes(*array, attributes);
        return described ? array : nullptr;
    }
    template <class Holder>
    static bool write_attributes(Holder& holder, const std::vector<std::pair<const char*, std::string>>& attributes) {
        for (const auto& [key, value] : attributes) {
            const auto attribute = holder.CreateAttribute(key, {}, GDALExtendedDataType::CreateString());
            if (!attribute || !attribute->Write(value.c_str())) return false;
        }
        return true;
    }
    GDALGroup& root() { return *root_; }

    /// Says the reference system of all arrays as WKT 2, as the conventions want it (their attribute crs_wkt): GDAL
    /// has written WKT 1. To be called when all arrays are there: one that GDAL adds would get a variable of its own.
    bool write_wkt2(const OGRSpatialReference& reference) {
        const std::string text = wkt2_of(reference);
        for (const std::string& name : grid_mappings_) {
            const auto variable = root_->OpenMDArray(name);
            const auto attribute = variable ? variable->GetAttribute("crs_wkt") : nullptr;
            if (!attribute || text.empty() || !attribute->Write(text.c_str())) return false;
        }
        return true;
    }

    /// Writes the latitudes and longitudes of cells where the reference system needs them (`refer`).
    bool places(const Dimensions& plan, const OGRSpatialReference& reference, const GridGeometry& g) {
        if (!by_wkt_) return true;
        const std::unique_ptr<OGRSpatialReference> base(reference.CloneGeogCS());
        if (!base) return false;
        base->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
        const std::unique_ptr<OGRCoordinateTransformation> transformation(
            OGRCreateCoordinateTransformation(&reference, base.get()));
        const auto lon = root_->CreateMDArray("lon", plan, number(), nullptr);
        const auto lat = root_->CreateMDArray("lat", plan, number(), nullptr);
        if (!transformation || !lon || !lat ||
            !write_attributes(*lon, {{"standard_name", "longitude"}, {"units", "degrees_east"}}) ||
            !write_attributes(*lat, {{"standard_name", "latitude"}, {"units", "degrees_north"}})) {
            return false;
        }
        std::vector<double> x, y(static_cast<std::size_t>(g.columns));
        for (int row = 0; row < g.rows; ++row) {
            x = centres(g.x_min, g.cell, g.columns);
            std::fill(y.begin(), y.end(), g.centre(0, row).y);
            if (transformation->Transform(g.columns, x.data(), y.data()) == 0) return false;
            const GUInt64 start[] = {static_cast<GUInt64>(row), 0};
            const std::size_t count[] = {1, x.size()};
            if (!lon->Write(start, count, nullptr, nullptr, number(), x.data()) ||
                !lat->Write(start, count, nullptr, nullptr, number(), y.data())) {
                return false;
            }
        }
        return true;
    }

  private:
    /// Says in which reference system an array is. The conventions know some projections. Where GDAL finds none of
    /// them, as for oblique Mercator systems and Krovak, a variable holds the system as WKT alone; the cells then need
    /// their latitudes and longitudes (`places`), by which any program finds its way.
    bool refer(GDALMDArray& array, const OGRSpatialReference& reference) {
        if (!by_wkt_ && array.SetSpatialRef(&reference)) {
            const auto attribute = array.GetAttribute("grid_mapping");
            const char* name = attribute ? attribute->ReadAsString() : nullptr;
            if (name != nullptr) grid_mappings_.insert(name);
            return true;
        }
        if (!by_wkt_) {
            by_wkt_ = true;
            const std::string text = wkt2_of(reference);
            const auto crs = root_->CreateMDArray("crs", {}, GDALExtendedDataType::Create(GDT_Int32), nullptr);
            if (text.empty() || !crs || !write_attributes(*crs, {{"crs_wkt", text}, {"spatial_ref", text}}))
                return false;
        }
        return write_attributes(array, {{"grid_mapping", "crs"}, {"coordinates", "lat lon"}});
    }

    std::unique_ptr<GDALDataset, GDALDatasetUniquePtrDeleter> data_;
    std::shared_ptr<GDALGroup> root_;
    bool by_wkt_ = false;
    std::set<std::string> grid_mappings_;  ///< variables that hold a reference system
};

bool write_rows(GDALMDArray& array, const std::vector<GUInt64>& start, const GridGeometry& g, const float* values) {
    std::vector<std::size_t> count(start.size(), 1);
    count[start.size() - 2] = static_cast<std::size_t>(g.rows);
    count[start.size() - 1] = static_cast<std::size_t>(g.columns);
    return array.Write(start.data(), count.data(), nullptr, nullptr, GDALExtendedDataType::Create(GDT_Float32), values);
}

/// False: GDAL has said why. Errors: those of reading a frame.
Result<bool> write_file(const std::string& path, const SeriesFile& series, const Grid<float>& terrain,
                        const std::vector<RasterSeries>& quantities) {
    NetcdfFile file(path);
    if (!file) return false;
    std::vector<std::pair<const char*, std::string>> global = {{"Conventions", "CF-1.8"}};
    for (const auto& [key, value] : series.metadata) global.emplace_back(key.c_str(), value);
    if (!NetcdfFile::write_attributes(file.root(), global)) return false;

    const GridGeometry& g = series.geometry;
    const OGRSpatialReference reference = to_spatial_reference(series.crs);
    // To the microsecond: a sum of steps that ends at 1 s reads 1, not 0.9999999999999999.
    std::vector<double> times_s = series.times;
    for (double& t : times_s) t = std::round(t * 1e6) / 1e6;
    const auto time = file.dimension("time", times_s.size());
    const auto y = file.dimension("y", static_cast<std::size_t>(g.rows));
    const auto x = file.dimension("x", static_cast<std::size_t>(g.columns));
    const bool coordinates =
        file.coordinate(time, times_s,
                        {{"standard_name", "time"},
                         {"long_name", "time since the start of the run; the date means nothing"},
                         {"units", "seconds since 2000-01-01 00:00:00"},
                         {"calendar", "proleptic_gregorian"},
                         {"axis", "T"}}) &&
        file.coordinate(
            y, centres(g.y_min, g.cell, g.rows),
            {{"standard_name", "projection_y_coordinate"}, {"long_name", "north"}, {"units", "m"}, {"axis", "Y"}}) &&
        file.coordinate(
            x, centres(g.x_min, g.cell, g.columns),
            {{"standard_name", "projection_x_coordinate"}, {"long_name", "east"}, {"units", "m"}, {"axis", "X"}});
    if (!coordinates) return false;

    const auto ground = file.map("terrain", {y, x}, "m", reference,
                                 {{"standard_name", "surface_altitude"}, {"long_name", "terrain before the run"}});
    if (!ground || !write_rows(*ground, {0, 0}, g, terrain.values.data())) return false;
    if (!file.places({y, x}, reference, g)) return false;
    std::vector<float> frame(g.size());
    for (const RasterSeries& quantity : quantities) {
        const auto array = file.map(quantity.name, {time, y, x}, quantity.unit, reference,
                                    {{"long_name", quantity.description}, {"cell_methods", "time: point"}});
        if (!array) return false;
        for (std::size_t k = 0; k < series.times.size(); ++k) {
            for (int row = 0; row < g.rows; ++row) TALUS_TRY(quantity.read(k, row, frame.data() + g.index(0, row)));
            if (!write_rows(*array, {k, 0, 0}, g, frame.data())) return false;
        }
    }
    return file.write_wkt2(reference);
}

}  // namespace

Status write_netcdf_series(const std::string& file, const SeriesFile& series, const Grid<float>& terrain,
                           const std::vector<RasterSeries>& quantities) {
    GdalMessages messages;
    const Result<bool> written = write_file(file, series, terrain, quantities);  // the last bytes when it is closed
    if (written && *written && !messages.has_failure()) return {};
    std::error_code ignored;
    std::filesystem::remove(file, ignored);
    if (!written) return written.error();
    return Error{fmt::format("{}: cannot be written: {}", file, messages.failure_or("GDAL gave no reason"))};
}

}  // namespace talus::geo
