#include "geo/contours.hpp"

#include <memory>

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

}  // namespace

std::vector<Contour> contours(const Grid<float>& elevation, double interval) {
    const GridGeometry& g = elevation.geometry;
    if (!(interval > 0) || g.columns < 1 || g.rows < 1) return {};
    Found found{g, {}};
    std::unique_ptr<void, decltype(&GDAL_CG_Destroy)> generator(
        GDAL_CG_Create(g.columns, g.rows, FALSE, 0, interval, 0, keep_line, &found), GDAL_CG_Destroy);
    std::vector<double> line(static_cast<std::size_t>(g.columns));
    for (int r = g.rows; r-- > 0;) {  // GDAL's rows run from north to south; NaN is not a value to it either
        for (int c = 0; c < g.columns; ++c) line[static_cast<std::size_t>(c)] = elevation.at(c, r);
        if (GDAL_CG_FeedLine(generator.get(), line.data()) != CE_None) return {};
    }
    generator.reset();  // lines that are still open are reported now
    return std::move(found.contours);
}

}  // namespace talus::geo
