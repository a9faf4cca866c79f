#include "report/relief.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>

#include "report/rows.hpp"

namespace talus::report {
namespace {

constexpr float no_data = std::numeric_limits<float>::quiet_NaN();

/// Mean of the cells of a block that have a value.
float block_mean(const Grid<float>& grid, int column, int row, int size) {
    double sum = 0;
    int count = 0;
    for (int r = row; r < std::min(row + size, grid.geometry.rows); ++r) {
        for (int c = column; c < std::min(column + size, grid.geometry.columns); ++c) {
            if (const float v = grid.at(c, r); !std::isnan(v)) {
                sum += v;
                ++count;
            }
        }
    }
    return count > 0 ? static_cast<float>(sum / count) : no_data;
}

/// Light on a cell, 0 to 1; NaN without elevation. Neighbours without one count as level with the cell.
float shade(const Grid<float>& elevation, int column, int row) {
    const float centre = elevation.at(column, row);
    if (std::isnan(centre)) return no_data;
    const auto z = [&](int dc, int dr) {
        const int c = std::clamp(column + dc, 0, elevation.geometry.columns - 1);
        const int r = std::clamp(row + dr, 0, elevation.geometry.rows - 1);
        const float v = elevation.at(c, r);
        return double{std::isnan(v) ? centre : v};
    };
    const double reach = 8 * elevation.geometry.cell;
    const double east = (z(1, 1) + 2 * z(1, 0) + z(1, -1) - z(-1, 1) - 2 * z(-1, 0) - z(-1, -1)) / reach;
    const double north = (z(-1, 1) + 2 * z(0, 1) + z(1, 1) - z(-1, -1) - 2 * z(0, -1) - z(1, -1)) / reach;
    const double flat = 1 / std::sqrt(1 + east * east + north * north);
    // Several lights keep slopes readable that face away from the main one.
    double light = 0;
    for (const auto& [azimuth_deg, weight] : {std::pair{315.0, 0.6}, {270.0, 0.2}, {0.0, 0.2}}) {
        const double azimuth = azimuth_deg * std::numbers::pi / 180, altitude = std::numbers::pi / 4;
        const double towards_light = -east * std::sin(azimuth) - north * std::cos(azimuth);
        const double cosine = flat * (std::cos(altitude) * towards_light + std::sin(altitude));
        light += weight * std::max(0.0, cosine);
    }
    return static_cast<float>(light);
}

}  // namespace

Grid<float> crop(const Grid<float>& grid, const Extent& extent, int longest_side) {
    const GridGeometry& g = grid.geometry;
    const auto first = [&](double edge, double origin, int count) {
        return std::clamp(static_cast<int>(std::floor((edge - origin) / g.cell)) - 1, 0, count - 1);
    };
    const auto last = [&](double edge, double origin, int count) {
        return std::clamp(static_cast<int>(std::ceil((edge - origin) / g.cell)) + 1, 1, count);
    };
    const int c0 = first(extent.x_min, g.x_min, g.columns), c1 = last(extent.x_max, g.x_min, g.columns);
    const int r0 = first(extent.y_min, g.y_min, g.rows), r1 = last(extent.y_max, g.y_min, g.rows);
    const int widest = std::max(c1 - c0, r1 - r0);
    const int step = std::max(1, (widest + longest_side - 1) / longest_side);
    const GridGeometry part{g.x_min + c0 * g.cell, g.y_min + r0 * g.cell, g.cell * step,
                            std::max(1, (c1 - c0 + step - 1) / step), std::max(1, (r1 - r0 + step - 1) / step)};
    Grid<float> out(part, no_data);
    for_rows(part.rows, [&](int r) {
        for (int c = 0; c < part.columns; ++c) out.at(c, r) = block_mean(grid, c0 + c * step, r0 + r * step, step);
    });
    return out;
}

double interpolate(const Grid<float>& grid, const PlanPoint& p) {
    const GridGeometry& g = grid.geometry;
    const double u = (p.x - g.x_min) / g.cell - 0.5, v = (p.y - g.y_min) / g.cell - 0.5;
    const int c = static_cast<int>(std::floor(u)), r = static_cast<int>(std::floor(v));
    const double fu = u - c, fv = v - r;
    if (c >= 0 && r >= 0 && c + 1 < g.columns && r + 1 < g.rows) {
        const float *low = &grid.at(c, r), *high = &grid.at(c, r + 1);
        // Most of a map has no debris.
        const bool none = std::isnan(low[0]) && std::isnan(low[1]) && std::isnan(high[0]) && std::isnan(high[1]);
        if (none) return std::numeric_limits<double>::quiet_NaN();
    }
    double sum = 0, weight = 0;
    for (const auto& [dc, dr, w] :
         {std::tuple{0, 0, (1 - fu) * (1 - fv)}, {1, 0, fu * (1 - fv)}, {0, 1, (1 - fu) * fv}, {1, 1, fu * fv}}) {
        if (c + dc < 0 || c + dc >= g.columns || r + dr < 0 || r + dr >= g.rows) continue;
        if (const float value = grid.at(c + dc, r + dr); !std::isnan(value)) {
            sum += w * value;
            weight += w;
        }
    }
    return weight >= 0.5 ? sum / weight : std::numeric_limits<double>::quiet_NaN();
}

GreyImage hillshade(const Grid<float>& elevation, const Extent& extent, double pixels_per_metre) {
    Grid<float> light(elevation.geometry);
    for_rows(light.geometry.rows, [&](int r) {
        for (int c = 0; c < light.geometry.columns; ++c) light.at(c, r) = shade(elevation, c, r);
    });
    GreyImage image{std::max(1, static_cast<int>(std::lround(extent.width() * pixels_per_metre))),
                    std::max(1, static_cast<int>(std::lround(extent.height() * pixels_per_metre))),
                    {}};
    image.pixels.resize(2 * static_cast<std::size_t>(image.width) * image.height);
    for_rows(image.height, [&](int y) {
        std::uint8_t* pixel = &image.pixels[2 * static_cast<std::size_t>(image.width) * y];
        for (int x = 0; x < image.width; ++x) {
            const PlanPoint p{extent.x_min + (x + 0.5) / image.width * extent.width(),
                              extent.y_max - (y + 0.5) / image.height * extent.height()};
            const double l = interpolate(light, p);
            // Kept light, so that debris, lines and text stand out on it; 64 greys are sufficient and compress well.
            const double grey = std::isnan(l) ? 255 : 136 + 116 * std::clamp((l - 0.10) / 0.90, 0.0, 1.0);
            *pixel++ = static_cast<std::uint8_t>(std::min(255L, std::lround(grey / 2) * 2));
            *pixel++ = std::isnan(l) ? 0 : 255;
        }
    });
    return image;
}

}  // namespace talus::report
