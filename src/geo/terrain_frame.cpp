#include "geo/terrain_frame.hpp"

#include <fmt/format.h>

#include "core/try.hpp"
#include "geo/file_name.hpp"
#include "geo/gdal.hpp"
#include "geo/raster_source.hpp"

namespace talus::geo {
namespace {

/// The name by which GDAL's programs open the file.
std::string name_for_programs(const std::string& file) {
    const Result<LayerOfFile> split = split_layer(file);
    if (!split || !split->layer.empty()) return file;
    const Result<std::string> name = name_for_gdal(split->file, GDAL_OF_RASTER, "raster");
    return name ? *name : file;
}

/// `result`: of the stored numbers A.
std::string calc_command(const std::string& file, int band, const std::string& result, const char* suffix) {
    return fmt::format("gdal_calc.py -A {} --A_band={} --calc='{}' --type=Float32 --NoDataValue=-9999 --outfile={}",
                       shell_quoted(name_for_programs(file)), band, result, mended_name(file, suffix, ".tif"));
}

double stored(const RasterSource& source, double value) {
    return (value - source.offset) / source.scale;
}

}  // namespace

Result<TerrainFrame> read_terrain_frame(const std::string& file, int band, bool local) {
    TALUS_ASSIGN(const RasterSource source, open_terrain(file, band, local));
    TerrainFrame frame;
    frame.crs = source.crs;
    frame.geometry = {.x_min = source.x_min,
                      .y_min = source.y_min,
                      .cell = source.cell,
                      .columns = source.columns,
                      .rows = source.rows};
    frame.eight_bit = GDALGetDataTypeSizeBytes(source.band->GetRasterDataType()) == 1;
    if (!source.nodata) {
        const int coverage = source.band->GetDataCoverageStatus(0, 0, source.columns, source.rows, 0, nullptr);
        frame.holes_read_0 = (coverage & GDAL_DATA_COVERAGE_STATUS_EMPTY) != 0;
    }
    return frame;
}

std::string declare_nodata_command(const std::string& file, int band, double value) {
    const Result<RasterSource> source = open_raster(file, band);
    const double number = source ? stored(*source, value) : value;
    // The value that is declared already would count as elevations with another one.
    if (source && source->nodata)
        return calc_command(file, band, fmt::format("where(A=={:.10g},-9999,A)", number), "_nodata");
    return fmt::format("gdal_translate -a_nodata {:.10g} {} {}", number, shell_quoted(name_for_programs(file)),
                       mended_name(file, "_nodata", ".tif"));
}

std::string cut_below_command(const std::string& file, int band, double value) {
    const Result<RasterSource> source = open_raster(file, band);
    const double number = source ? stored(*source, value) : value;
    return calc_command(file, band, fmt::format("where(A<{:.6g},-9999,A)", number), "_nodata");
}

std::string scale_command(const std::string& file, int band, double factor) {
    const Result<RasterSource> source = open_raster(file, band);
    const double scale = source ? source->scale : 1, offset = source ? source->offset : 0;
    const std::string added = offset != 0 ? fmt::format("{:+.10g}", offset * factor) : "";
    return calc_command(file, band, fmt::format("A*{:.10g}{}", scale * factor, added), "_m");
}

}  // namespace talus::geo
