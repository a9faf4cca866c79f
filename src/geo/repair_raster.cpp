#include "geo/repair_raster.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <system_error>

#include <cpl_string.h>
#include <fmt/format.h>
#include <gdal_utils.h>

#include "core/try.hpp"
#include "geo/gdal.hpp"
#include "geo/raster_source.hpp"
#include "geo/spatial_reference.hpp"

namespace talus::geo {
namespace {

/// A system in which a raster can be brought onto square cells in metres.
struct MetricSystem {
    std::string name;       ///< "EPSG:32650"; empty: there is none
    double square_own = 0;  ///< m: the system is its own, and only its cells are changed, to this size
};

MetricSystem metric_system_of(GDALDataset& data) {
    std::array<double, 6> g{};
    const OGRSpatialReference* reference = data.GetSpatialRef();
    if (reference == nullptr || reference->IsEmpty() || data.GetGeoTransform(g.data()) != CE_None) return {};
    OGRSpatialReference plain = *reference;
    plain.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    const double column = data.GetRasterXSize() / 2.0, line = data.GetRasterYSize() / 2.0;
    const PlanPoint centre{g[0] + column * g[1] + line * g[2], g[3] + column * g[4] + line * g[5]};
    // Its owner's other data are in the same system: it stays, where its metre is one.
    if (plain.IsProjected() != 0 && std::abs(plain.GetLinearUnits() - 1) < 1e-9) {
        const auto scale = scale_factor(plain, centre);
        if (scale && std::abs(*scale - 1) <= largest_scale_error) {
            const Crs own = to_crs(plain);
            return {own.epsg != 0 ? fmt::format("EPSG:{}", own.epsg) : "its own reference system",
                    std::min(std::hypot(g[1], g[4]), std::hypot(g[2], g[5]))};
        }
    }
    const auto place = to_longitude_latitude(plain, centre);
    if (!place) return {};
    return {metric_crs_for(place)};
}

double height_unit_of(GDALDataset& data) {
    if (const char* unit = data.GetRasterBand(1)->GetUnitType(); unit != nullptr && *unit != '\0') {
        return metres_per(unit).value_or(1);
    }
    const OGRSpatialReference* reference = data.GetSpatialRef();
    if (reference == nullptr || reference->IsEmpty()) return 1;
    if (reference->IsVertical() != 0) return reference->GetTargetLinearUnits("VERT_CS");
    return reference->IsProjected() != 0 ? reference->GetLinearUnits() : 1;
}

/// As gdal_translate.
GDALDatasetUniquePtr translate(GDALDataset& from, const std::string& to, const CPLStringList& arguments) {
    const std::unique_ptr<GDALTranslateOptions, decltype(&GDALTranslateOptionsFree)> options(
        GDALTranslateOptionsNew(const_cast<CPLStringList&>(arguments).List(), nullptr), &GDALTranslateOptionsFree);
    int wrong_use = 0;
    return GDALDatasetUniquePtr(GDALDataset::FromHandle(
        options ? GDALTranslate(to.c_str(), GDALDataset::ToHandle(&from), options.get(), &wrong_use) : nullptr));
}

/// As gdalwarp, computed as it is read. Heights stay in their unit, whose name GDAL would keep on converted ones.
GDALDatasetUniquePtr warp(GDALDataset& from, const MetricSystem& system) {
    CPLStringList arguments;
    for (const char* word : {"-of", "VRT", "-novshift", "-r", "bilinear", "-ot", "Float32", "-dstnodata", "-9999"}) {
        arguments.AddString(word);
    }
    if (system.square_own > 0) {
        const std::string cell = fmt::format("{:.17g}", system.square_own);
        for (const char* word : {"-tr", cell.c_str(), cell.c_str()}) arguments.AddString(word);
    } else {
        arguments.AddString("-t_srs");
        arguments.AddString(system.name.c_str());
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
    facts.metric_crs = metric_system_of(*data).name;
    if (const char* unit = data->GetRasterBand(1)->GetUnitType(); unit != nullptr) facts.value_unit = unit;
    facts.height_unit = height_unit_of(*data);
    return facts;
}

Status repair_raster(const std::string& file, const std::string& to, const Mending& mending, double most_cells) {
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
    if (mending.local) {
        stated.AddString("-a_srs");
        stated.AddString(Crs::own_metres().wkt.c_str());
    }
    if (mending.nodata) {
        stated.AddString("-a_nodata");
        stated.AddString(fmt::format("{:.17g}", *mending.nodata).c_str());
    }
    const GDALDatasetUniquePtr first = translate(*data, "", stated);
    if (!first) return failed();
    GDALDatasetUniquePtr warped;
    if (mending.metric) {
        const MetricSystem system = metric_system_of(*first);
        if (system.name.empty()) return Error{file + ": it states no position, so that no metric system can be chosen"};
        warped = warp(*first, system);
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
