#include "geo/contours.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <gdal_alg.h>

namespace talus::geo {
namespace {

struct Found {
    const GridGeometry& geometry;
    std::vector<Contour> contours;
};

/// Called by GDAL with every line, in columns and rows from the upper left corner.
CPLErr keep_line(double level, int count, double* columns, double* rows, void* data) {
    auto& found = *static_cast<Found*>(data);
    const GridGeometry& g = found.geometry;
    Contour contour{level, {}};
    for (int i = 0; i < count; ++i) {
        contour.points.push_back({g.x_min + columns[i] * g.cell, g.y_min + (g.rows - rows[i]) * g.cell});
    }
    if (count > 1) found.contours.push_back(std::move(contour));
    return CE_None;
}

/// Lines at `base` and whole multiples of `interval` from it.
std::vector<Contour> lines_at(const Grid<float>& values, double base, double interval) {
    const GridGeometry& g = values.geometry;
    if (!(interval > 0) || g.columns < 1 || g.rows < 1) return {};
    Found found{g, {}};
    std::unique_ptr<void, decltype(&GDAL_CG_Destroy)> generator(
        GDAL_CG_Create(g.columns, g.rows, FALSE, 0, interval, base, keep_line, &found), GDAL_CG_Destroy);
    std::vector<double> line(static_cast<std::size_t>(g.columns));
    for (int r = g.rows; r-- > 0;) {  // GDAL's rows run from north to south; NaN is not a value to it either
        for (int c = 0; c < g.columns; ++c) line[static_cast<std::size_t>(c)] = values.at(c, r);
        if (GDAL_CG_FeedLine(generator.get(), line.data()) != CE_None) return {};
    }
    generator.reset();  // lines that are still open are reported now
    return std::move(found.contours);
}

}  // namespace

std::vector<Contour> contours(const Grid<float>& elevation, double interval) {
    return lines_at(elevation, 0, interval);
}

std::vector<Contour> contours(const Grid<float>& values, const std::vector<double>& levels) {
    double largest = 0;
    for (const float value : values.values) {
        if (std::isfinite(value)) largest = std::max(largest, std::abs(static_cast<double>(value)));
    }
    std::vector<Contour> all;
    for (const double level : levels) {
        // An interval so wide that no other level lies within the values.
        for (Contour& line : lines_at(values, level, 10 * (largest + std::abs(level)) + 1)) {
            line.elevation = level;
            all.push_back(std::move(line));
        }
    }
    return all;
}

}  // namespace talus::geo
