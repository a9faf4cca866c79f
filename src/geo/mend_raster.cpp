#include "geo/mend_raster.hpp"

#include <array>
#include <filesystem>
#include <memory>
#include <system_error>

#include <cpl_string.h>
#include <fmt/format.h>
#include <gdal_utils.h>

#include "core/try.hpp"
#include "geo/gdal.hpp"
#include "geo/spatial_reference.hpp"

namespace talus::geo {
namespace {

std::string metric_crs_of(GDALDataset& data) {
    std::array<double, 6> g{};
    const OGRSpatialReference* reference = data.GetSpatialRef();
    if (reference == nullptr || reference->IsEmpty() || data.GetGeoTransform(g.data()) != CE_None) return "";
    OGRSpatialReference plain = *reference;
    plain.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    const double column = data.GetRasterXSize() / 2.0, line = data.GetRasterYSize() / 2.0;
    const auto place =
        to_longitude_latitude(plain, {g[0] + column * g[1] + line * g[2], g[3] + column * g[4] + line * g[5]});
    return place ? metric_crs_for(place) : "";
}

/// As gdal_translate.
GDALDatasetUniquePtr translate(GDALDataset& from, const std::string& to, const CPLStringList& arguments) {
    const std::unique_ptr<GDALTranslateOptions, decltype(&GDALTranslateOptionsFree)> options(
        GDALTranslateOptionsNew(const_cast<CPLStringList&>(arguments).List(), nullptr), &GDALTranslateOptionsFree);
    int wrong_use = 0;
    return GDALDatasetUniquePtr(GDALDataset::FromHandle(
        options ? GDALTranslate(to.c_str(), GDALDataset::ToHandle(&from), options.get(), &wrong_use) : nullptr));
}

/// As gdalwarp, computed as it is read.
GDALDatasetUniquePtr warp(GDALDataset& from, const std::string& crs) {
    CPLStringList arguments;
    for (const char* word :
         {"-of", "VRT", "-t_srs", crs.c_str(), "-r", "bilinear", "-ot", "Float32", "-dstnodata", "-9999"}) {
        arguments.AddString(word);
    }
    const std::unique_ptr<GDALWarpAppOptions, decltype(&GDALWarpAppOptionsFree)> options(
        GDALWarpAppOptionsNew(arguments.List(), nullptr), &GDALWarpAppOptionsFree);
    GDALDatasetH source = GDALDataset::ToHandle(&from);
    int wrong_use = 0;
    return GDALDatasetUniquePtr(
        GDALDataset::FromHandle(options ? GDALWarp("", nullptr, 1, &source, options.get(), &wrong_use) : nullptr));
}

void scale_values(GDALRasterBand& band, double metres_per_unit) {
    band.SetScale(band.GetScale() * metres_per_unit);
    band.SetOffset(band.GetOffset() * metres_per_unit);
    band.SetUnitType("m");
}

}  // namespace

Result<RasterFacts> raster_facts(const std::string& file) {
    TALUS_ASSIGN(const auto data, open_dataset(file, GDAL_OF_RASTER, "raster"));
    const GdalMessages messages;
    if (data->GetRasterCount() == 0) return Error{file + ": holds no raster band"};
    RasterFacts facts;
    facts.format = data->GetDriver() != nullptr ? data->GetDriver()->GetDescription() : "";
    facts.columns = data->GetRasterXSize();
    facts.rows = data->GetRasterYSize();
    const OGRSpatialReference* reference = data->GetSpatialRef();
    if (reference != nullptr && !reference->IsEmpty()) facts.crs = to_crs(*reference).label();
    facts.metric_crs = metric_crs_of(*data);
    if (const char* unit = data->GetRasterBand(1)->GetUnitType(); unit != nullptr) facts.value_unit = unit;
    return facts;
}

Status mend_raster(const std::string& file, const std::string& to, const Mending& mending, double most_cells) {
    TALUS_ASSIGN(const auto data, open_dataset(file, GDAL_OF_RASTER, "raster"));
    const GdalMessages messages;
    const auto failed = [&] {
        return Error{fmt::format("{}: cannot be mended: {}", file, messages.failure_or("GDAL does not say why"))};
    };
    CPLStringList stated;
    for (const char* word : {"-of", "VRT", "-b", "1"}) stated.AddString(word);
    if (mending.epsg != 0) {
        TALUS_TRY(crs_from_text(fmt::format("EPSG:{}", mending.epsg)));
        stated.AddString("-a_srs");
        stated.AddString(fmt::format("EPSG:{}", mending.epsg).c_str());
    }
    if (mending.nodata) {
        stated.AddString("-a_nodata");
        stated.AddString(fmt::format("{:.17g}", *mending.nodata).c_str());
    }
    const GDALDatasetUniquePtr first = translate(*data, "", stated);
    if (!first) return failed();
    GDALDatasetUniquePtr warped;
    if (mending.metric) {
        const std::string crs = metric_crs_of(*first);
        if (crs.empty()) return Error{file + ": it states no position, so that no metric system can be chosen"};
        warped = warp(*first, crs);
        if (!warped) return failed();
    }
    GDALDataset& last = warped ? *warped : *first;
    if (mending.metres_per_unit) scale_values(*last.GetRasterBand(1), *mending.metres_per_unit);
    if (static_cast<double>(last.GetRasterXSize()) * last.GetRasterYSize() > most_cells) {
        return Error{fmt::format("{}: would have {} x {} cells, at most {:.0f} million can be", file,
                                 last.GetRasterXSize(), last.GetRasterYSize(), most_cells / 1e6)};
    }
    CPLStringList written;
    for (const char* word :
         {"-of", "GTiff", "-co", "TILED=YES", "-co", "COMPRESS=DEFLATE", "-co", "BIGTIFF=IF_SAFER"}) {
        written.AddString(word);
    }
    const bool good = translate(last, to, written) != nullptr && !messages.has_failure();
    if (good) return {};
    std::error_code ignored;
    std::filesystem::remove(to, ignored);
    return failed();
}

}  // namespace talus::geo
