#include "geo/raster_source.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <string_view>

#include <cpl_vsi.h>
#include <fmt/format.h>

#include "core/try.hpp"
#include "geo/gdal.hpp"
#include "geo/spatial_reference.hpp"

namespace talus::geo {

namespace {

struct UnitName {
    std::string_view name;
    double metres;
};

constexpr double foot = 0.3048, us_survey_foot = 1200.0 / 3937.0;

/// Length units as raster formats and WKT spell them, in lower case.
constexpr std::array unit_names = {
    UnitName{"m", 1},
    UnitName{"metre", 1},
    UnitName{"metres", 1},
    UnitName{"meter", 1},
    UnitName{"meters", 1},
    UnitName{"ft", foot},
    UnitName{"foot", foot},
    UnitName{"feet", foot},
    UnitName{"international foot", foot},
    UnitName{"international feet", foot},
    UnitName{"us-ft", us_survey_foot},
    UnitName{"us_ft", us_survey_foot},
    UnitName{"us ft", us_survey_foot},
    UnitName{"ftus", us_survey_foot},
    UnitName{"sftus", us_survey_foot},
    UnitName{"foot_us", us_survey_foot},
    UnitName{"us foot", us_survey_foot},
    UnitName{"us feet", us_survey_foot},
    UnitName{"us survey foot", us_survey_foot},
    UnitName{"us survey feet", us_survey_foot},
    UnitName{"us_survey_foot", us_survey_foot},
    UnitName{"mm", 0.001},
    UnitName{"millimetre", 0.001},
    UnitName{"millimeter", 0.001},
    UnitName{"cm", 0.01},
    UnitName{"centimetre", 0.01},
    UnitName{"centimeter", 0.01},
    UnitName{"dm", 0.1},
    UnitName{"decimetre", 0.1},
    UnitName{"decimeter", 0.1},
    UnitName{"km", 1000},
    UnitName{"kilometre", 1000},
    UnitName{"kilometer", 1000},
};

/// Affine position of a raster, as GDAL gives it: always of the corner of the first cell, whether the file says that
/// its pixels are areas or points.
struct Position {
    std::array<double, 6> g{};

    [[nodiscard]] PlanPoint at(double column, double line) const {
        return {g[0] + column * g[1] + line * g[2], g[3] + column * g[4] + line * g[5]};
    }
};

std::string warp_command(const std::string& file, const std::string& arguments, const std::string& suffix) {
    return fmt::format("gdalwarp {} -r bilinear -ot Float32 -dstnodata -9999 {} {}", arguments, shell_quoted(file),
                       mended_name(file, suffix, ".tif"));
}

Status check_crs(const std::string& file, const std::string& driver, const OGRSpatialReference& reference,
                 const PlanPoint& centre) {
    if (reference.IsEmpty()) {
        const std::string command = driver == "GTiff"
                                        ? fmt::format("gdal_edit.py -a_srs EPSG:nnnn {}", shell_quoted(file))
                                        : fmt::format("gdal_translate -a_srs EPSG:nnnn {} {}", shell_quoted(file),
                                                      mended_name(file, "_crs", ".tif"));
        return Error{
            fmt::format("{}: states no coordinate reference system; give it the code of the one it is in: {} "
                        "(or, for metres of its own as those of a flume, set terrain.crs = \"local\": talus "
                        "scene new --crs local)",
                        file, command)};
    }
    const auto place = to_longitude_latitude(reference, centre);
    const std::string metric = metric_crs_for(place);
    // With a system of heights, gdalwarp would convert them to metres but leave the name of their unit as it was.
    const std::string target = (reference.IsVertical() != 0 ? "-novshift -t_srs " : "-t_srs ") + metric;
    const Crs crs = to_crs(reference);
    if (reference.IsGeographic() != 0) {
        return Error{fmt::format("{}: {} is geographic (degrees), a projected CRS in metres is needed: {}", file,
                                 crs.label(), warp_command(file, target, "_metric"))};
    }
    if (reference.IsProjected() == 0 && reference.IsLocal() == 0) {
        return Error{fmt::format("{}: {} is not a projected CRS in metres: {}", file, crs.label(),
                                 warp_command(file, target, "_metric"))};
    }
    const char* unit = nullptr;
    const double metres = reference.GetLinearUnits(&unit);
    if (std::abs(metres - 1) > 1e-9) {
        return Error{fmt::format("{}: {} is in {} of {:.6g} m, a CRS in metres is needed: {}", file, crs.label(),
                                 unit != nullptr ? unit : "a unit", metres, warp_command(file, target, "_metric"))};
    }
    // Web Mercator and similar systems are nominally metric, but their metre is not a metre on the ground.
    const auto scale = scale_factor(reference, centre);
    if (scale && std::abs(*scale - 1) > largest_scale_error) {
        return Error{fmt::format("{}: a metre of {} is {:.3f} m on the ground here, a CRS true to scale is needed: {}",
                                 file, crs.label(), 1 / *scale, warp_command(file, target, "_metric"))};
    }
    return {};
}

Status check_cells(const std::string& file, const Position& position, int columns, int rows) {
    const auto& g = position.g;
    const double width = std::hypot(g[1], g[4]), height = std::hypot(g[2], g[5]);
    if (!(width > 0) || !(height > 0) || !std::isfinite(width + height + g[0] + g[3])) {
        return Error{fmt::format("{}: its cells have no size (geotransform {}, {}, {}, {}, {}, {})", file, g[0], g[1],
                                 g[2], g[3], g[4], g[5])};
    }
    // Tolerances are in cells over the whole raster: that is the error of a reader that ignores them.
    const int longest = std::max(columns, rows);
    if ((std::abs(g[2]) / height + std::abs(g[4]) / width) * longest > 0.05) {
        const double cell = std::min(width, height);
        const double degrees = std::atan2(g[4], g[1]) * 180 / M_PI;
        return Error{
            fmt::format("{}: the raster is rotated by {:.3g} degrees, cells aligned with the CRS are needed: {}", file,
                        degrees, warp_command(file, fmt::format("-tr {0:.10g} {0:.10g}", cell), "_north"))};
    }
    if (std::abs(width - height) / width * longest > 0.05) {
        const double cell = std::min(width, height);
        return Error{fmt::format("{}: cells are {:.10g} m x {:.10g} m, square ones are needed: {}", file, width, height,
                                 warp_command(file, fmt::format("-tr {0:.10g} {0:.10g}", cell), "_square"))};
    }
    return {};
}

struct Scaling {
    double scale = 1, offset = 0;
};

Scaling scaling_of(GDALRasterBand& band) {
    Scaling scaling;
    int given = 0;
    if (const double scale = band.GetScale(&given); given != 0) scaling.scale = scale;
    if (const double offset = band.GetOffset(&given); given != 0) scaling.offset = offset;
    return scaling;
}

/// "m", the unit as stated if it is unknown, or "not stated". Refuses other known units.
Result<std::string> value_unit_of(const std::string& file, int band_number, GDALRasterBand& band,
                                  const OGRSpatialReference& reference, const Crs& crs) {
    std::string stated;
    std::optional<double> metres;
    if (const char* unit = band.GetUnitType(); unit != nullptr && *unit != '\0') {
        stated = unit;
        metres = metres_per(stated);
    } else if (reference.IsVertical() != 0) {
        const char* vertical = nullptr;
        metres = reference.GetTargetLinearUnits("VERT_CS", &vertical);
        stated = vertical != nullptr ? vertical : "m";
    }
    if (stated.empty()) return std::string("not stated");
    if (!metres) return stated;
    if (std::abs(*metres - 1) < 1e-9) return std::string("m");
    const std::string mended = mended_name(file, "_m", ".tif");
    // gdal_calc.py works on the stored numbers, before scale and offset.
    const Scaling scaling = scaling_of(band);
    const std::string offset = scaling.offset != 0 ? fmt::format("{:+.10g}", scaling.offset * *metres) : "";
    const std::string crs_option = crs.epsg != 0 ? fmt::format(" -a_srs EPSG:{}", crs.epsg) : "";
    return Error{fmt::format(
        "{}: values are in {} of {:.8g} m, metres are needed: gdal_calc.py -A {} --A_band={} --calc='A*{:.10g}{}' "
        "--type=Float32 --NoDataValue=-9999 --outfile={} && gdal_edit.py -units m{} {}",
        file, stated, *metres, shell_quoted(file), band_number, scaling.scale * *metres, offset, mended, crs_option,
        mended)};
}

Error no_bands(const std::string& file, GDALDataset& data) {
    std::string names;
    for (const Subdataset& one : subdatasets(data)) names += (names.empty() ? "" : ", ") + one.layer;
    if (names.empty()) return {fmt::format("{}: holds no raster band", file)};
    return {fmt::format("{}: holds several rasters; name one of them as {}|layername=NAME: {}", file, file, names)};
}

}  // namespace

std::optional<double> metres_per(std::string name) {
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
    for (const UnitName& unit : unit_names) {
        if (unit.name == name) return unit.metres;
    }
    return std::nullopt;
}

Status check_raw_size(const std::string& file, GDALDataset& data) {
    const std::string driver = data.GetDriver() != nullptr ? data.GetDriver()->GetDescription() : "";
    constexpr std::array raw_drivers = {"ENVI", "EHdr", "GenBin", "ISCE", "ROI_PAC", "RRASTER"};
    if (std::find(raw_drivers.begin(), raw_drivers.end(), driver) == raw_drivers.end()) return {};
    VSIStatBufL stat;
    // Of the file that GDAL opened: `file` can be an archive.
    if (VSIStatL(data.GetDescription(), &stat) != 0) return {};
    double expected = 0;
    for (int b = 1; b <= data.GetRasterCount(); ++b) {
        expected += static_cast<double>(data.GetRasterXSize()) * data.GetRasterYSize() *
                    GDALGetDataTypeSizeBytes(data.GetRasterBand(b)->GetRasterDataType());
    }
    if (static_cast<double>(stat.st_size) >= expected) return {};
    return Error{fmt::format("{}: the file is damaged or cut short: {:.0f} bytes of cells expected, {} there", file,
                             expected, stat.st_size)};
}

std::string declare_nodata_command(const std::string& file, const std::string& driver, double value) {
    if (driver == "GTiff") return fmt::format("gdal_edit.py -a_nodata {:.10g} {}", value, shell_quoted(file));
    return fmt::format("gdal_translate -a_nodata {:.10g} {} {}", value, shell_quoted(file),
                       mended_name(file, "_nodata", ".tif"));
}

Result<RasterSource> open_raster(const std::string& file, int band, const Crs* otherwise) {
    RasterSource source;
    TALUS_ASSIGN(source.data, open_dataset(file, GDAL_OF_RASTER, "raster"));
    const GdalMessages messages;
    GDALDataset& data = *source.data;
    const std::string driver = data.GetDriver() != nullptr ? data.GetDriver()->GetDescription() : "";

    const int bands = data.GetRasterCount();
    if (bands == 0) return no_bands(file, data);
    if (band < 1 || band > bands) {
        return Error{bands == 1
                         ? fmt::format("{}: band = {} does not exist, the file has 1 band", file, band)
                         : fmt::format("{}: band = {} does not exist, the file has bands 1 to {}", file, band, bands)};
    }
    source.band = data.GetRasterBand(band);
    source.columns = data.GetRasterXSize();
    source.rows = data.GetRasterYSize();
    if (source.columns < 2 || source.rows < 2) {
        return Error{
            fmt::format("{}: has {} x {} cells, at least 2 x 2 are needed", file, source.columns, source.rows)};
    }
    if (GDALDataTypeIsComplex(source.band->GetRasterDataType()) != 0) {
        return Error{fmt::format("{}: band {} holds complex numbers", file, band)};
    }

    TALUS_TRY(check_raw_size(file, data));

    OGRSpatialReference reference;
    if (const OGRSpatialReference* stated = data.GetSpatialRef()) reference = *stated;
    if (reference.IsEmpty() && otherwise != nullptr) {
        reference = to_spatial_reference(*otherwise);
        source.crs_assumed = true;
    }
    Position position;
    if (data.GetGeoTransform(position.g.data()) != CE_None) {
        if (data.GetGCPCount() > 0) {
            return Error{
                fmt::format("{}: is placed by control points only: {}", file, warp_command(file, "", "_north"))};
        }
        return Error{
            fmt::format("{}: states no position; give it its west, north, east and south edges and its CRS: "
                        "gdal_translate -a_ullr WEST NORTH EAST SOUTH -a_srs EPSG:nnnn {} {}",
                        file, shell_quoted(file), mended_name(file, "_placed", ".tif"))};
    }
    const PlanPoint centre = position.at(source.columns / 2.0, source.rows / 2.0);
    TALUS_TRY(check_crs(file, driver, reference, centre));
    TALUS_TRY(check_cells(file, position, source.columns, source.rows));

    source.crs = to_crs(reference);
    TALUS_ASSIGN(source.value_unit, value_unit_of(file, band, *source.band, reference, source.crs));

    const auto& g = position.g;
    source.cell = std::abs(g[1]);
    source.first_column_west = g[1] > 0;
    source.first_row_north = g[5] < 0;
    source.x_min = source.first_column_west ? g[0] : g[0] + source.columns * g[1];
    source.y_min = source.first_row_north ? g[3] + source.rows * g[5] : g[3];

    const Scaling scaling = scaling_of(*source.band);
    source.scale = scaling.scale;
    source.offset = scaling.offset;
    int given = 0;
    const double nodata = source.band->GetNoDataValue(&given);
    if (given != 0) source.nodata = nodata;
    return Result<RasterSource>(std::move(source));
}

}  // namespace talus::geo
