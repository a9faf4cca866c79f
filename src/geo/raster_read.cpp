#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/try.hpp"
#include "geo/gdal.hpp"
#include "geo/raster.hpp"
#include "geo/raster_source.hpp"
#include "geo/spatial_reference.hpp"
#include "geo/terrain_frame.hpp"

namespace talus::geo {

namespace {

constexpr double lowest_elevation = -12000, highest_elevation = 9000;  // m: the deepest trench, the highest summit
constexpr double most_cells = 2e8;                                     // 0.8 GB as floats

/// The cells to read, counted from the south-west.
struct Window {
    int column = 0, row = 0, columns = 0, rows = 0;
};

/// `factor`: cells of the raster along an edge of one that is kept.
Result<Window> window_of(const std::string& file, const RasterSource& source, const std::optional<Extent>& extent,
                         int factor) {
    Window window{0, 0, source.columns, source.rows};
    if (extent) {
        // A cell that the extent only touches by rounding is not wanted.
        constexpr double tolerance = 1e-6;
        const auto first = [&](double position, double origin, int count) {
            return std::clamp(std::floor((position - origin) / source.cell + tolerance), 0.0, double(count));
        };
        const auto last = [&](double position, double origin, int count) {
            return std::clamp(std::ceil((position - origin) / source.cell - tolerance), 0.0, double(count));
        };
        const double west = first(extent->x_min, source.x_min, source.columns);
        const double east = last(extent->x_max, source.x_min, source.columns);
        const double south = first(extent->y_min, source.y_min, source.rows);
        const double north = last(extent->y_max, source.y_min, source.rows);
        if (!(east - west >= 2) || !(north - south >= 2)) {
            const double x_max = source.x_min + source.columns * source.cell;
            const double y_max = source.y_min + source.rows * source.cell;
            return Error{
                fmt::format("{}: extent {} to {} east, {} to {} north covers fewer than 2 x 2 cells; the raster "
                            "lies at {} to {} east, {} to {} north ({})",
                            file, extent->x_min, extent->x_max, extent->y_min, extent->y_max, source.x_min, x_max,
                            source.y_min, y_max, source.crs.label())};
        }
        window = {static_cast<int>(west), static_cast<int>(south), static_cast<int>(east - west),
                  static_cast<int>(north - south)};
    }
    if (factor > 1) {
        const auto whole = [&](int& first, int& count, int all) {
            const int last = std::min(first + count + factor - 1, all) / factor;
            first /= factor;
            count = (last - first) * factor;
            first *= factor;
        };
        whole(window.column, window.columns, source.columns);
        whole(window.row, window.rows, source.rows);
        if (window.columns < 2 * factor || window.rows < 2 * factor) {
            return Error{fmt::format("{}: fewer than 2 x 2 cells of {:.6g} m lie in it; choose smaller ones", file,
                                     source.cell * factor)};
        }
    }
    const int columns = window.columns / factor, rows = window.rows / factor;
    if (static_cast<double>(columns) * rows > most_cells) {
        return Error{
            fmt::format("{}: {} x {} cells are to be read, at most {:.0f} million can be; name the part that "
                        "matters (terrain.extent_m in a scene; --extent, or --cell for larger cells, of talus "
                        "scene new)",
                        file, columns, rows, most_cells / 1e6)};
    }
    return window;
}

/// Statistics of the stored numbers, before scale and offset.
struct StoredRange {
    double smallest = std::numeric_limits<double>::infinity();
    double second_smallest = std::numeric_limits<double>::infinity();  ///< the next distinct value
    double largest = -std::numeric_limits<double>::infinity();
    std::size_t smallest_count = 0, largest_count = 0, valid = 0;

    void add(double value) {
        ++valid;
        if (value < smallest) {
            second_smallest = smallest;
            smallest = value;
            smallest_count = 1;
        } else if (value == smallest) {
            ++smallest_count;
        } else if (value < second_smallest) {
            second_smallest = value;
        }
        if (value > largest) {
            largest = value;
            largest_count = 1;
        } else if (value == largest) {
            ++largest_count;
        }
    }
};

/// Calls `put(column, row, elevation)` for every cell of the window that holds data, counted from its south-west.
template <class Put>
Result<StoredRange> read_window(const std::string& file, const RasterSource& source, const Window& window,
                                const Put& put) {
    GdalMessages messages;
    GDALRasterBand& band = *source.band;
    const int first_column = source.first_column_west ? window.column : source.columns - window.column - window.columns;
    const int first_line = source.first_row_north ? source.rows - window.row - window.rows : window.row;

    GDALRasterBand* mask = (band.GetMaskFlags() & GMF_ALL_VALID) != 0 ? nullptr : band.GetMaskBand();
    int block_width = 1, block_height = 1;
    band.GetBlockSize(&block_width, &block_height);
    const int chunk = std::clamp(block_height, 1, std::max(1, (1 << 22) / window.columns));
    std::vector<double> stored(static_cast<std::size_t>(window.columns) * chunk);
    std::vector<GByte> valid(mask != nullptr ? stored.size() : 0);
    StoredRange range;
    for (int line = 0; line < window.rows; line += chunk) {
        const int lines = std::min(chunk, window.rows - line);
        CPLErr status = band.RasterIO(GF_Read, first_column, first_line + line, window.columns, lines, stored.data(),
                                      window.columns, lines, GDT_Float64, 0, 0, nullptr);
        if (status == CE_None && mask != nullptr) {
            status = mask->RasterIO(GF_Read, first_column, first_line + line, window.columns, lines, valid.data(),
                                    window.columns, lines, GDT_Byte, 0, 0, nullptr);
        }
        if (status != CE_None || messages.has_failure()) {
            return Error{fmt::format("{}: the file is damaged or cut short: {}", file,
                                     messages.failure_or("GDAL cannot read all cells"))};
        }
        for (int l = 0; l < lines; ++l) {
            const int row = source.first_row_north ? window.rows - 1 - (line + l) : line + l;
            for (int c = 0; c < window.columns; ++c) {
                const std::size_t i = static_cast<std::size_t>(l) * window.columns + c;
                if ((mask != nullptr && valid[i] == 0) || !std::isfinite(stored[i])) continue;
                range.add(stored[i]);
                const int column = source.first_column_west ? c : window.columns - 1 - c;
                put(column, row, stored[i] * source.scale + source.offset);
            }
        }
    }
    return range;
}

/// Numbers that cannot be elevations are undeclared nodata.
Status check_elevations(const std::string& file, const RasterSource& source, const StoredRange& range) {
    const auto refuse = [&](double stored, std::size_t count) {
        const double value = stored * source.scale + source.offset;
        const std::string declared = source.nodata ? fmt::format("{:.10g}", *source.nodata) : "none";
        return Error{
            fmt::format("{}: {} cells hold {:.10g}, which is no elevation in m; if it marks missing data "
                        "(declared nodata value: {}): {}",
                        file, count, value, declared,
                        declare_nodata_command(file, source.data->GetDriver()->GetDescription(), stored))};
    };
    const auto outside = [&](double stored) {
        const double value = stored * source.scale + source.offset;
        return !(value >= lowest_elevation && value <= highest_elevation);
    };
    if (outside(range.smallest)) return refuse(range.smallest, range.smallest_count);
    if (outside(range.largest)) return refuse(range.largest, range.largest_count);
    // These two lie within the range of elevations, but are far from all others when they mean "no data".
    constexpr double apart = 500;  // m
    for (const double customary : {-9999.0, -999.0}) {
        if (range.smallest == customary && (range.second_smallest - range.smallest) * std::abs(source.scale) > apart) {
            return refuse(range.smallest, range.smallest_count);
        }
    }
    return {};
}

enum class Kind { elevations, values, map };

/// Puts the means of `factor` x `factor` cells into the grid, NaN where fewer than half of them hold data.
Result<StoredRange> read_means(const std::string& file, const RasterSource& source, const Window& window, int factor,
                               Grid<float>& grid) {
    Grid<double> sum(grid.geometry, 0);
    Grid<int> count(grid.geometry, 0);
    TALUS_ASSIGN(auto range, read_window(file, source, window, [&](int column, int row, double value) {
                     const std::size_t k = grid.geometry.index(column / factor, row / factor);
                     sum.values[k] += value;
                     ++count.values[k];
                 }));
    for (std::size_t k = 0; k < grid.values.size(); ++k) {
        const int cells = count.values[k];
        if (2 * cells >= factor * factor) grid.values[k] = static_cast<float>(sum.values[k] / cells);
    }
    return range;
}

Result<Raster> read_cells(const std::string& file, const RasterSource& source, const std::optional<Extent>& extent,
                          Kind kind, int factor = 1) {
    TALUS_ASSIGN(auto window, window_of(file, source, extent, factor));
    Raster raster;
    raster.crs = source.crs;
    raster.crs_assumed = source.crs_assumed;
    raster.vertical_unit = source.value_unit;
    raster.nodata_value = source.nodata;
    raster.grid = Grid<float>({.x_min = source.x_min + window.column * source.cell,
                               .y_min = source.y_min + window.row * source.cell,
                               .cell = source.cell * factor,
                               .columns = window.columns / factor,
                               .rows = window.rows / factor},
                              std::numeric_limits<float>::quiet_NaN());
    const auto keep = [&](int column, int row, double value) {
        raster.grid.at(column, row) = static_cast<float>(value);
    };
    TALUS_ASSIGN(auto range, factor > 1 ? read_means(file, source, window, factor, raster.grid)
                                        : read_window(file, source, window, keep));
    if (range.valid == 0 && kind != Kind::map) {
        return Error{fmt::format("{}: {} no cell holds data, all {} x {} are nodata", file,
                                 extent ? "within the extent" : "in the whole raster", window.columns, window.rows)};
    }
    if (kind == Kind::elevations) {
        TALUS_TRY(check_elevations(file, source, range));
    }
    const double cells = static_cast<double>(window.columns) * window.rows;
    raster.nodata_share = 1 - static_cast<double>(range.valid) / cells;
    return Result<Raster>(std::move(raster));
}

/// A raster that has to be in the CRS of the terrain.
Result<Raster> read_over_terrain(const std::string& file, const Crs& terrain_crs, Kind kind) {
    TALUS_ASSIGN(auto source, open_raster(file, 1, &terrain_crs));
    if (!same_crs(to_spatial_reference(source.crs), to_spatial_reference(terrain_crs))) {
        if (terrain_crs.local) {
            return Error{fmt::format("{}: is in {}, the terrain in local coordinates; give the raster in those", file,
                                     source.crs.label())};
        }
        const std::string target = terrain_crs.epsg != 0 ? fmt::format("EPSG:{}", terrain_crs.epsg) : "EPSG:nnnn";
        return Error{
            fmt::format("{}: is in {}, the terrain in {}: gdalwarp -t_srs {} -r bilinear -ot Float32 "
                        "-dstnodata -9999 {} {}",
                        file, source.crs.label(), terrain_crs.label(), target, shell_quoted(file),
                        mended_name(file, "_terrain_crs", ".tif"))};
    }
    return read_cells(file, source, std::nullopt, kind);
}

}  // namespace

Result<RasterSource> open_terrain(const std::string& file, int band, bool local) {
    const Crs own = local ? Crs::own_metres() : Crs();
    TALUS_ASSIGN(auto source, open_raster(file, band, local ? &own : nullptr));
    if (local && !source.crs.local) {
        return Error{
            fmt::format("{}: is in {}; crs = \"local\" is for a terrain that states no coordinate reference system",
                        file, source.crs.label())};
    }
    return source;
}

Result<Raster> read_terrain_raster(const std::string& file, int band, const std::optional<Extent>& extent, bool local) {
    TALUS_ASSIGN(const auto source, open_terrain(file, band, local));
    return read_cells(file, source, extent, Kind::elevations);
}

Result<Raster> read_coarse_terrain(const std::string& file, int band, const std::optional<Extent>& extent, int factor,
                                   bool local) {
    TALUS_ASSIGN(const auto source, open_terrain(file, band, local));
    return read_cells(file, source, extent, Kind::elevations, factor);
}

Result<Raster> read_value_raster(const std::string& file, const Crs& terrain_crs) {
    return read_over_terrain(file, terrain_crs, Kind::values);
}

Result<Raster> read_map_raster(const std::string& file, const Crs& terrain_crs) {
    return read_over_terrain(file, terrain_crs, Kind::map);
}

}  // namespace talus::geo
