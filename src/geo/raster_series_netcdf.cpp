#include <cmath>
#include <filesystem>
#include <memory>
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
        if (on_globe && !array->SetSpatialRef(&reference)) return nullptr;
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

  private:
    std::unique_ptr<GDALDataset, GDALDatasetUniquePtrDeleter> data_;
    std::shared_ptr<GDALGroup> root_;
};

std::vector<double> centres(double first, double cell, int count) {
    std::vector<double> values(static_cast<std::size_t>(count));
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = first + (static_cast<double>(k) + 0.5) * cell;
    return values;
}

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
    const auto time = file.dimension("time", series.times.size());
    const auto y = file.dimension("y", static_cast<std::size_t>(g.rows));
    const auto x = file.dimension("x", static_cast<std::size_t>(g.columns));
    const bool coordinates =
        file.coordinate(time, series.times,
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
    return true;
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
